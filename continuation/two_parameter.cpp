#include "continuation/two_parameter.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>

#include "continuation/chart_units.hpp"
#include "continuation/codimension_two.hpp"
#include "continuation/exchanged_problem.hpp"
#include "continuation/period_doubling.hpp"

namespace whirl::continuation {
namespace {

/// Walks one curve both ways and describes it.
class Follower {
 public:
  Follower(const Problem& f, const SpecialPoint& point, double p2, const TwoParameterOptions& options)
      : curve_(f, point, p2, options), options_(options), n_(f.size()), start_(curve_.start()) {}

  /// False if the branch point it follows dissolves as the second parameter changes, or if the first one does not move it.
  bool walk(const Observer& observer);
  bool unmoved_by_first() const { return unmoved_by_first_; }
  DefiningCurve describe();

 private:
  WalkOptions walk_options() const;
  bool settle_start();
  Vector direction();
  Vector scales() const;
  bool mirrored(const Vector& a, const Vector& b) const;
  StopReason must_stop(const Branch& b, int i) const;

  SpecialCurve curve_;
  const TwoParameterOptions& options_;
  int n_;
  Vector start_;
  Branch walked_;
  bool unmoved_by_first_ = false;
};

WalkOptions Follower::walk_options() const {
  WalkOptions walk = options_.walk;
  walk.lower = options_.range2[0];
  walk.upper = options_.range2[1];
  walk.locate_events = true;
  walk.explain_changes = false;
  walk.peaks.clear();
  walk.bounds = options_.bounds;
  walk.bounds.push_back({static_cast<int>(curve_.states()), options_.range1[0], options_.range1[1]});  // of p1
  return walk;
}

// Units of the system's unknowns: the size of x, both ranges, the size of what is between.
Vector Follower::scales() const {
  const auto states = curve_.states(), last = start_.size() - 1;
  Vector units = start_.cwiseAbs();
  const double x = start_.head(states).norm();
  units.head(states).setConstant(x > 0.0 && !curve_.problem().is_flow() ? x : 1.0);  // a flow is in units of its own
  units[states] = options_.range1[1] - options_.range1[0];
  units[last] = options_.range2[1] - options_.range2[0];
  for (Eigen::Index i = states + 1; i < last; ++i)
    if (units[i] == 0.0) units[i] = 1.0;
  return units;
}

// Onto the curve by the shortest way, p2 and all. With p2 held there may be no solution near, or one off the curve: where p2 stands still along it,
// and where a pitchfork dissolves beside it.
bool Follower::settle_start() {
  constexpr double near = 1e-4, rounding = 1e-13, stalled = 1e-10;  // in units: it is a point of the curve but for 1e-6 of it
  constexpr int most_steps = 20;
  const Vector units = scales();
  const int m = curve_.system().size();
  Vector y = start_, r(m);
  Matrix j(m, m + 1);
  double previous = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most_steps; ++i) {
    curve_.system().linearise(y, r, j);
    if (!r.allFinite() || !j.allFinite()) return false;
    const Vector step = Matrix(j * units.asDiagonal()).completeOrthogonalDecomposition().solve(r);
    y -= units.cwiseProduct(step);
    const double size = step.norm();
    if (!std::isfinite(size) || !((y - start_).cwiseQuotient(units).norm() < near)) return false;
    if (size < rounding || (size < stalled && size > 0.5 * previous)) {
      start_ = y;
      return true;
    }
    previous = size;
  }
  return false;
}

// Of the curve at its start, p2 increasing: the kernel of the system's Jacobian.
Vector Follower::direction() {
  const Vector units = scales();
  const AugmentedSystem& system = curve_.system();
  Matrix j(system.size(), system.size() + 1);
  system.jacobian(start_, j);
  const Matrix rows = (j * units.asDiagonal()).transpose();
  const Eigen::ColPivHouseholderQR<Matrix> qr(rows);
  Vector t = units.cwiseProduct(Vector(qr.householderQ() * Vector::Unit(rows.rows(), rows.rows() - 1)));
  if (t[t.size() - 1] < 0.0) t = -t;
  return t;
}

// Did the part that breaks a symmetry pass zero between a and b?
bool Follower::mirrored(const Vector& a, const Vector& b) const {
  const Problem& f = curve_.problem();
  const auto& active = curve_.blocks().active;
  for (int r = 0; r < static_cast<int>(f.reflections().size()); ++r) {
    if (std::find(active.begin(), active.end(), r) != active.end()) continue;
    double product = 0.0;
    for (const int i : odd_coordinates(f, r)) product += a[i] * b[i];
    if (product < 0.0) return true;
  }
  return false;
}

StopReason Follower::must_stop(const Branch& b, int i) const {
  if (i > 0 && mirrored(curve_.base(b.u(i - 1)), curve_.base(b.u(i)))) return StopReason::symmetric_branch;
  if (curve_.past_strong_resonance(b.u(i))) return StopReason::strong_resonance;
  if (curve_.kappa(b.u(i)) < 0.0) return StopReason::bogdanov_takens;  // beyond: neutral saddles
  return StopReason::none;
}

bool Follower::walk(const Observer& observer) {
  constexpr int keep_borders = 10;  // points: the null vectors turn slowly
  const bool branch_point = curve_.point().type == EventType::branch_point && curve_.point().block == 0;
  if (!settle_start()) {
    if (branch_point) return false;
    throw std::invalid_argument("the special point does not satisfy its system");
  }
  curve_.update_borders(start_);
  unmoved_by_first_ = curve_.problem().is_flow() && curve_.unmoved_by_first(start_);
  if (unmoved_by_first_) return false;
  int fresh = 0;
  bool dissolves = false;
  StopReason why = StopReason::none;
  const Observer watch = [&](const Branch& b, int i) {
    if (++fresh % keep_borders == 0) curve_.system().update_borders(b.u(i));
    why = must_stop(b, i);
    dissolves = curve_.dissolved(b.u(i));
    if (why == StopReason::none && observer && !observer(b, i)) why = StopReason::observer;
    return why == StopReason::none && !dissolves;
  };
  Walker walker(curve_.system(), walk_options());
  const auto half = [&](const Vector& towards) {
    why = StopReason::none;
    Branch b = walker.walk_from(start_, towards, false, watch);
    if (b.stop_reason == StopReason::observer) b.stop_reason = why;
    return b;
  };
  const Vector up = direction();
  Branch forward = half(up);
  if (dissolves) return false;
  if (forward.stop_reason != StopReason::closed_loop) {
    curve_.system().update_borders(start_);
    Branch backward = half(-up);
    if (dissolves) return false;
    forward = forward.points() == 0 ? backward.reversed() : backward.points() == 0 ? forward : Branch::joined(backward, std::move(forward));
  }
  if (forward.points() == 0) throw std::invalid_argument("no curve could be followed from the special point");
  walked_ = std::move(forward);
  return true;
}

DefiningCurve Follower::describe() {
  const SpecialPoint& point = curve_.point();
  DefiningCurve curve;
  curve.type = point.type;
  curve.subtype = point.subtype;
  curve.block = point.block;
  curve.start_reason = walked_.start_reason;
  curve.stop_reason = walked_.stop_reason;
  const int count = walked_.points();
  curve.u.resize(n_ + 2, count);
  curve.coefficient.resize(count);
  curve.frequency.resize(count);
  curve.residual.resize(count);
  // The sign of a fold's coefficient goes with its null vector: as the point itself has it.
  double orientation = 1.0, nearest = std::numeric_limits<double>::infinity();
  const Vector from = curve_.base(start_);
  curve.special = codimension_two_points(curve_, walked_, options_, [&](int i) {
    const SpecialPoint s = curve_.at(walked_.u(i));
    curve.u.col(i) = curve_.base(walked_.u(i));
    curve.coefficient[i] = s.coefficient;
    curve.frequency[i] = s.frequency;
    curve.residual[i] = walked_.residual(i);
    const double apart = (curve.u.col(i) - from).norm();
    if (apart < nearest && s.null_vector.size() == point.null_vector.size() && s.null_vector.size() > 0) {
      nearest = apart;
      orientation = s.null_vector.dot(point.null_vector) < 0.0 ? -1.0 : 1.0;
    }
  });
  if (point.type == EventType::fold) curve.coefficient *= orientation;
  return curve;
}

// A period doubling is a branch point of the doubled problem: its curve is followed there.
DefiningCurve follow_doubling(const OrbitProblem& orbit, const SpecialPoint& point, double p2, const TwoParameterOptions& options,
                              const Observer& observer) {
  Vector u(point.u.size() + 1);
  u << point.u, p2;
  auto at = period_doubling_near(orbit, u, point.block);
  if (!at) throw std::invalid_argument("the period doubling does not satisfy its system");
  at->u.conservativeResize(at->u.size() - 1);
  DefiningCurve curve = follow(orbit.doubled(), *at, p2, options, observer);
  if (curve.type == EventType::branch_point) {
    curve.type = EventType::period_doubling;
    curve.subtype = "";
  }
  return curve;
}

// With the parameters in the other order: what is asked of the second one is asked of the first there, and dropped.
bool follow_exchanged(const Problem& problem2, const SpecialPoint& point, double p2, const TwoParameterOptions& options, const Observer& observer,
                      DefiningCurve& curve) {
  const int n = problem2.size();
  const ExchangedProblem other(problem2);
  TwoParameterOptions exchanged = options;
  std::swap(exchanged.range1, exchanged.range2);
  exchanged.walk.user_values.clear();
  SpecialPoint at = point;
  at.u[n] = p2;
  at.tangent.resize(0);
  Follower follower(other, at, point.u[n], exchanged);
  if (!follower.walk(observer)) return false;
  curve = follower.describe();
  curve.u.row(n).swap(curve.u.row(n + 1));
  std::erase_if(curve.special, [](const CodimensionTwo& z) { return z.type == "MIN" || z.type == "MAX"; });
  for (auto& z : curve.special) z.u = ExchangedProblem::exchanged(z.u);
  return true;
}

DefiningCurve follow_as_it_stands(const Problem& problem2, const SpecialPoint& point, double p2, const TwoParameterOptions& options,
                                  const Observer& observer) {
  Follower follower(problem2, point, p2, options);
  if (follower.walk(observer)) return follower.describe();
  if (DefiningCurve curve; follower.unmoved_by_first() && follow_exchanged(problem2, point, p2, options, observer, curve)) return curve;
  SpecialPoint fold = point;  // of which the dissolved branch point is a point
  fold.type = EventType::fold;
  fold.subtype = "";
  fold.null_vector.resize(0);
  Follower on_folds(problem2, fold, p2, options);
  (void)on_folds.walk(observer);
  return on_folds.describe();
}

}  // namespace

DefiningCurve follow(const Problem& problem2, const SpecialPoint& point, double p2, const TwoParameterOptions& options, const Observer& observer) {
  if (problem2.parameters() != 2) throw std::invalid_argument("following a special point needs a problem with two free parameters");
  if (problem2.derivatives() < 2) throw std::invalid_argument("following a special point needs second derivatives");
  const auto* orbit = dynamic_cast<const OrbitProblem*>(&problem2);
  if (orbit && point.type == EventType::period_doubling) return follow_doubling(*orbit, point, p2, options, observer);
  if (!problem2.is_flow()) return follow_as_it_stands(problem2, point, p2, options, observer);
  Vector u(point.u.size() + 1);
  u << point.u, p2;
  const ChartUnits units(problem2, u, point.frequency, options);
  DefiningCurve curve = follow_as_it_stands(units.problem(), units.inwards(point), units.inwards_second(p2), units.options(), observer);
  units.outwards(curve);
  return curve;
}

}  // namespace whirl::continuation
