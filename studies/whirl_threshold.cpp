#include "studies/whirl_threshold.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "continuation/walker.hpp"

namespace whirl::studies {
namespace {

using namespace models;

HarmonicBalance balance_of(const CableModel& model, const std::vector<Lens>& lenses, int harmonics) {
  HarmonicBalanceOptions o;
  o.harmonics = harmonics;
  return HarmonicBalance(cable_system(model, lenses), o);
}

/// Planar motion at (omega, U), and whether it is about to whirl.
class PlanarMotion {
 public:
  PlanarMotion(const CableModel& model, int harmonics)
      : balance_(balance_of(model, {Lens("omega"), Lens("support_amplitude")}, harmonics)),
        out_(static_cast<Eigen::Index>(model.out_of_plane.size()) * (2 * harmonics + 1)),
        in_(balance_.size() - out_),
        u_(Vector::Zero(balance_.size() + 2)),
        r_(balance_.size()),
        j_(balance_.size(), balance_.size() + 2) {}

  void start(In planar, double omega, double amplitude) {
    u_.segment(out_, in_) = planar;
    u_[out_ + in_] = omega;
    u_[out_ + in_ + 1] = amplitude;
  }
  /// Newton in the plane; leaves the Jacobian of the solution behind.
  bool solve(double omega, double amplitude) {
    u_[out_ + in_] = omega;
    u_[out_ + in_ + 1] = amplitude;
    for (int i = 0; i < 15; ++i) {
      balance_.linearise(u_, r_, j_);
      const Vector step = j_.block(out_, out_, in_, in_).partialPivLu().solve(r_.segment(out_, in_));
      if (!step.allFinite()) return false;
      u_.segment(out_, in_) -= step;
      if (step.lpNorm<Eigen::Infinity>() < 1e-12 * (1.0 + u_.segment(out_, in_).lpNorm<Eigen::Infinity>())) {
        balance_.linearise(u_, r_, j_);
        return true;
      }
    }
    return false;
  }
  /// +1 or -1: sign of det J_oo.
  double sign() const {
    const Eigen::PartialPivLU<Matrix> lu(j_.topLeftCorner(out_, out_));
    double sign = static_cast<double>(lu.permutationP().determinant());
    for (Eigen::Index i = 0; i < out_; ++i) sign *= lu.matrixLU()(i, i) < 0.0 ? -1.0 : 1.0;
    return sign;
  }
  /// Borders from the vectors nearest to the kernels, by inverse iteration.
  void renew_borders() {
    const Eigen::PartialPivLU<Matrix> lu(j_.topLeftCorner(out_, out_)), transposed(j_.topLeftCorner(out_, out_).transpose());
    c_ = Vector::LinSpaced(out_, 1.0, 2.0);
    b_ = c_;
    for (int i = 0; i < 3; ++i) {
      c_ = lu.solve(c_).normalized();
      b_ = transposed.solve(b_).normalized();
    }
  }
  double test() const {
    Matrix m(out_ + 1, out_ + 1);
    m << j_.topLeftCorner(out_, out_), b_, c_.transpose(), 0.0;
    return m.partialPivLu().solve(Vector::Unit(out_ + 1, out_))[out_];
  }
  /// G(omega, U); NaN if there is no motion nearby. The motion found is where the next search starts.
  double at(double omega, double amplitude) { return solve(omega, amplitude) ? test() : std::nan(""); }
  const Vector& u() const { return u_; }
  void restore(const Vector& u) { u_ = u; }

 private:
  HarmonicBalance balance_;
  Eigen::Index out_, in_;
  Vector u_, r_;
  Matrix j_;
  Vector b_, c_;
};

/// The curve G = 0 in the plane of (omega, U), each in units of its range.
class Curve {
 public:
  using Place = Eigen::Vector2d;

  Curve(PlanarMotion& motion, const WhirlThresholdOptions& o)
      : motion_(motion), low_(o.omega[0], o.amplitude[0]), width_(o.omega[1] - o.omega[0], o.amplitude[1] - o.amplitude[0]) {}

  Place place(double omega, double amplitude) const { return (Place(omega, amplitude) - low_).cwiseQuotient(width_); }
  double omega(const Place& p) const { return low_[0] + width_[0] * p[0]; }
  double amplitude(const Place& p) const { return low_[1] + width_[1] * p[1]; }

  /// The point of the curve met from p along `normal`, by secants, and the gradient of G there; the motion goes along. False leaves all as it was.
  bool meet(Place& p, const Place& normal, Place& gradient) {
    const Vector before = motion_.u();
    Place at = p;
    if (find(at, normal)) {
      gradient = gradient_at(at);
      if (gradient.allFinite() && gradient.norm() > 0.0 && motion_.solve(omega(at), amplitude(at))) {
        p = at;
        return true;
      }
    }
    motion_.restore(before);
    return false;
  }
  Place gradient_at(const Place& p) {
    constexpr double h = 1e-5;
    const auto central = [&](const Place& d) { return (g(p + h * d) - g(p - h * d)) / (2.0 * h); };
    return {central(Place::UnitX()), central(Place::UnitY())};
  }

 private:
  double g(const Place& p) { return motion_.at(omega(p), amplitude(p)); }
  bool find(Place& p, const Place& normal) {
    if (!motion_.solve(omega(p), amplitude(p))) return false;
    motion_.renew_borders();
    double last = motion_.test(), step = 1e-5;
    const Place start = p;
    for (int i = 0; i < 20; ++i) {
      p += step * normal;
      const double now = g(p);
      if (!std::isfinite(now) || (p - start).norm() > 0.2) return false;
      const double next = -step * now / (now - last);
      if (std::abs(step) < 1e-12 || !std::isfinite(next)) return true;  // two equal values: no closer
      step = next;
      last = now;
    }
    return false;
  }

  PlanarMotion& motion_;
  Place low_, width_;
};

// First change of sign of det J_oo along the planar branch: the points before and after.
bool first_whirling_point(const CableModel& model, const WhirlThresholdOptions& o, PlanarMotion& motion, WhirlThreshold& t) {
  CableModel planar = model;
  planar.out_of_plane.clear();
  const HarmonicBalance balance = balance_of(planar, {Lens("omega")}, o.harmonics);
  const auto start = newton(balance, balance.linear_response(Vector::Constant(1, o.omega[0])), {.max_iterations = 30});
  if (!start.ok()) {
    t.why = "no periodic motion at the lower end of the frequencies";
    return false;
  }
  const double U = model.stay.support_amplitude;
  double sign = 0.0;
  bool met = false;
  continuation::WalkOptions walk;
  walk.lower = o.omega[0];
  walk.upper = o.omega[1];
  walk.locate_events = false;
  walk.max_step = 0.02;
  Vector before;
  const auto observer = [&](const continuation::Branch& b, int i) {
    const Vector u = b.u(i);
    motion.start(u.head(balance.size()), u[balance.size()], U);
    if (!motion.solve(u[balance.size()], U)) return !o.interrupted();  // at a fold
    const double now = motion.sign();
    met = sign * now < 0.0;
    if (!met) {
      before = motion.u();
      sign = now;
    }
    return !met && !o.interrupted();
  };
  (void)continuation::Walker(balance, walk).walk_from(start.x, Vector::Unit(balance.size() + 1, balance.size()), false, observer);
  if (!met) {
    t.why = "no whirling point at this amplitude";
    return false;
  }
  double low = before[before.size() - 2], high = motion.u()[before.size() - 2];
  motion.restore(before);
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    if (!motion.solve(middle, U)) break;
    (motion.sign() == sign ? low : high) = middle;
  }
  t.first_omega = 0.5 * (low + high);
  return true;
}

}  // namespace

WhirlThreshold whirl_threshold(const CableModel& model, const WhirlThresholdOptions& o) {
  using Place = Curve::Place;
  WhirlThreshold t;
  PlanarMotion motion(model, o.harmonics);
  if (!first_whirling_point(model, o, motion, t)) return t;
  Curve curve(motion, o);
  motion.renew_borders();
  Place p = curve.place(t.first_omega, model.stay.support_amplitude), gradient = curve.gradient_at(p);
  // Along the curve, amplitude falling, until its tangent is level; then between the last two points.
  const auto tangent = [](const Place& g) { return Place(Place(-g[1], g[0]).normalized()); };
  Place along = tangent(gradient);
  if (along[1] > 0.0) along = -along;
  double step = 0.01;
  const auto lost = [&](const char* why) {
    t.why = why;
    return t;
  };
  if (!gradient.allFinite()) return lost("the curve of whirling points is lost at its start");
  for (;;) {
    Place next = p + step * along, g;
    const bool inside = next.minCoeff() > 0.0 && next.maxCoeff() < 1.0;
    if (o.interrupted() || !inside || step < 1e-7) return lost("the curve of whirling points has no least amplitude within the ranges");
    const bool good = curve.meet(next, Place(-along[1], along[0]), g);
    Place ahead = good ? tangent(g) : along;
    if (ahead.dot(along) < 0.0) ahead = -ahead;
    if (!good || ahead.dot(along) < 0.9) {
      step *= 0.5;
      continue;
    }
    if (ahead[1] >= 0.0) break;  // past the lowest point
    p = next;
    along = ahead;
    step = std::min(1.5 * step, 0.03);
  }
  // Level tangent between s = 0 and s = step, measured along the tangent at p; [low, high] brackets.
  double low = 0.0, high = step, low_value = along[1], high_value = 1.0;
  Place found = p;
  for (int i = 0; i < 60 && high - low > 1e-9; ++i) {
    double s = i == 0 || i % 3 == 2 ? 0.5 * (low + high) : low - low_value * (high - low) / (high_value - low_value);
    if (!(s > low && s < high)) s = 0.5 * (low + high);
    Place next = p + s * along, g;
    if (o.interrupted() || !curve.meet(next, Place(-along[1], along[0]), g))
      return lost("the curve of whirling points is lost near its least amplitude");
    Place ahead = tangent(g);
    if (ahead.dot(along) < 0.0) ahead = -ahead;
    found = next;
    (ahead[1] < 0.0 ? low : high) = s;
    (ahead[1] < 0.0 ? low_value : high_value) = ahead[1];
    if (std::abs(ahead[1]) < 1e-8) break;  // level: what is left is of second order
  }
  t.ok = true;
  t.omega = curve.omega(found);
  t.amplitude = curve.amplitude(found);
  return t;
}

}  // namespace whirl::studies
