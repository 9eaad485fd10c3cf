#include "continuation/two_parameter.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "continuation/augmented.hpp"
#include "continuation/normal_form.hpp"
#include "continuation/period_doubling.hpp"
#include "continuation/torus.hpp"
#include "core/newton.hpp"

namespace whirl::continuation {
namespace {

// A base with k = 2 seen at one value of the second parameter: normal forms and spectra of the point itself.
class Held : public Problem {
 public:
  Held(const Problem& f, double p2) : Problem(f.size(), 1, f.is_flow()), f_(f), p2_(p2), u_(f.size() + 2), wide_(f.size(), f.size() + 2) {
    offer_derivatives(f.derivatives());
    for (const auto& r : f.reflections()) add_reflection(r);
  }
  void hold(double p2) { p2_ = p2; }

 private:
  const Vector& widen(In u, double last) const {
    u_.head(u.size()) = u;
    u_[u.size()] = last;
    return u_;
  }
  void do_residual(In u, Out r) const override { f_.residual(widen(u, p2_), r); }
  void do_jacobian(In u, MatrixOut j) const override {
    f_.jacobian(widen(u, p2_), wide_);
    j = wide_.leftCols(j.cols());
  }
  void do_second(In u, In v, MatrixOut h) const override {
    Vector w(v.size() + 1);
    w << v, 0.0;
    f_.second(widen(u, p2_), w, wide_);
    h = wide_.leftCols(h.cols());
  }
  void do_third(In u, In a, In b, In c, Out t) const override {
    Vector A(a.size() + 1), B(a.size() + 1), C(a.size() + 1);
    A << a, 0.0;
    B << b, 0.0;
    C << c, 0.0;
    f_.third(widen(u, p2_), A, B, C, t);
  }
  const Problem& f_;
  double p2_;
  mutable Vector u_;
  mutable Matrix wide_;
};

std::unique_ptr<AugmentedSystem> make_system(const Problem& f, const SpecialPoint& point, const Blocks& blocks, const std::vector<Observable>& peaks,
                                             In u) {
  const Indices& state = blocks.indices[0];
  const auto of_block = [&]() -> const Indices& { return blocks.indices[static_cast<std::size_t>(point.block)]; };
  switch (point.type) {
    case EventType::fold:
      return std::make_unique<SingularSystem>(f, state, state, u);
    case EventType::branch_point:
      if (point.block > 0) return std::make_unique<SingularSystem>(f, state, of_block(), u);
      return std::make_unique<BranchPointSystem>(f, u);
    case EventType::hopf:
      return std::make_unique<HopfSystem>(f, state, of_block(), u);
    case EventType::peak:
      for (const auto& peak : peaks)
        if (peak.name == point.subtype && peak.form) return std::make_unique<PeakSystem>(f, state, *peak.form, u);
      throw std::invalid_argument(fmt::format("no form is known of the quantity '{}' that has its peak here", point.subtype));
    case EventType::torus:
      if (const auto* orbit = dynamic_cast<const OrbitProblem*>(&f))
        return std::make_unique<TorusSystem>(*orbit, state, unknowns_of_group(*orbit, u, point.block), u, point.frequency);
      break;
    case EventType::period_doubling:  // `follow` hands it on as a branch point of the doubled problem
    case EventType::end:
    case EventType::gave_up:
    case EventType::user_value:
    case EventType::unresolved:
      break;
  }
  throw std::invalid_argument(fmt::format("no two-parameter curve of {} points", to_string(point.type)));
}

// Test functions along a curve; each vanishes at its codimension-2 point.
struct Test {
  std::string type;
  std::function<double(In y)> value;
};

class Follower {
 public:
  Follower(const Problem& f, const SpecialPoint& point, const TwoParameterOptions& options)
      : f_(f), point_(point), options_(options), held_(f, 0.0), blocks_(make_blocks(f, active_reflections(f, point.u.head(f.size())))) {}

  DefiningCurve run(double p2, const Observer& observer);

 private:
  SpecialPoint at(In y) const;  // the special point behind the system's unknowns, with its normal form
  std::vector<Test> tests() const;
  void add_other_blocks(std::vector<Test>& all) const;
  Test double_root() const;
  Vector base(In y) const { return system_->base_point(y); }
  Eigen::VectorXcd others(In y) const;  // eigenvalues but for the critical one, or the critical pair
  double crossing_pair(In y) const;     // zero where a pair of them is on the axis
  double crossing_real(In y) const;     // zero where one of them is
  bool is_crossing(In y, const std::string& type) const;
  bool mirrored(const Vector& a, const Vector& b) const;  // did the part that breaks a symmetry pass zero between a and b?
  bool past_strong_resonance(In y) const;
  bool dissolved(In y) const;             // a branch point of r + beta b0 = 0 only
  bool symmetric(const Vector& u) const;  // is that part zero next to the largest on the curve?
  void locate(const Branch& b, int i, const Test& test, double from, double to, DefiningCurve& curve);

  const Problem& f_;
  SpecialPoint point_;
  TwoParameterOptions options_;
  mutable Held held_;
  mutable Vector sense_;
  Blocks blocks_;
  std::unique_ptr<AugmentedSystem> system_;
  mutable std::vector<std::unique_ptr<SingularSystem>> others_;  // the same states, singular in another block
  std::vector<double> largest_odd_;                              // on the curve, for each reflection
  Vector start_;                                                 // (x, p1, p2)
};

SpecialPoint Follower::at(In y) const {
  const Vector u = base(y);
  const int n = f_.size();
  SpecialPoint s = point_;
  s.u = u.head(n + 1);
  s.has_coefficient = false;
  s.coefficient = std::nan("");
  held_.hold(u[n + 1]);
  if (const auto* hopf = dynamic_cast<const HopfSystem*>(system_.get())) {
    const double kappa = hopf->kappa(y);
    s.frequency = kappa > 0.0 ? std::sqrt(kappa) : 0.0;
    if (!(kappa > 0.0)) return s;
  }
  // Along the curve the null vector turns, it does not jump: neither does the sign of a fold's coefficient.
  if (const auto* torus = dynamic_cast<const TorusSystem*>(system_.get())) {
    s.frequency = torus->kappa(y);
    return s;
  }
  set_normal_form(held_, s, sense_, [&](const Vector& v, const Vector& w) { return mass(f_, u, v, w); });
  if (!s.has_coefficient) s.coefficient = std::nan("");
  if (point_.type == EventType::fold && s.has_coefficient) sense_ = s.null_vector;
  return s;
}

Eigen::VectorXcd Follower::others(In y) const {
  Matrix j(f_.size(), f_.size() + 2);
  f_.jacobian(base(y), j);
  const Eigen::VectorXcd e = Eigen::EigenSolver<Matrix>(j.leftCols(f_.size()), false).eigenvalues();
  const auto* hopf = dynamic_cast<const HopfSystem*>(system_.get());
  const std::complex<double> critical(0.0, hopf ? std::sqrt(std::max(0.0, hopf->kappa(y))) : 0.0);
  std::vector<std::complex<double>> rest(e.begin(), e.end());
  for (const auto& z : {critical, std::conj(critical)}) {
    if (rest.empty() || (!hopf && rest.size() < static_cast<std::size_t>(e.size()))) break;
    rest.erase(std::min_element(rest.begin(), rest.end(), [&](const auto& p, const auto& q) { return std::abs(p - z) < std::abs(q - z); }));
  }
  return Eigen::Map<const Eigen::VectorXcd>(rest.data(), static_cast<Eigen::Index>(rest.size()));
}

// Products, not the eigenvalue nearest to zero: that may be born from a complex pair on the way. Each factor over its size, so that many of them stay
// in range.
double Follower::crossing_pair(In y) const {
  const Eigen::VectorXcd e = others(y);
  if (e.size() < 2) return std::nan("");
  std::complex<double> product = 1.0;
  for (Eigen::Index k = 0; k < e.size(); ++k)
    for (Eigen::Index l = 0; l < k; ++l) product *= (e[k] + e[l]) / (std::abs(e[k]) + std::abs(e[l]));
  return product.real();
}

double Follower::crossing_real(In y) const {
  const Eigen::VectorXcd e = others(y);
  if (e.size() < 1) return std::nan("");
  const double size = e.cwiseAbs().maxCoeff();
  std::complex<double> product = 1.0;
  for (const auto& z : e) product *= z / size;
  return product.real();
}

// At a zero of the test functions: are they on the axis indeed? Two real eigenvalues of opposite sign cancel as well, and at a Bogdanov-Takens point
// the curve's own pair is a double zero.
bool Follower::is_crossing(In y, const std::string& type) const {
  const Eigen::VectorXcd e = others(y);
  constexpr double near = 1e-4;
  const auto* hopf = dynamic_cast<const HopfSystem*>(system_.get());
  const double size = std::max(e.size() > 0 ? e.cwiseAbs().maxCoeff() : 0.0, hopf ? std::sqrt(std::abs(hopf->kappa(y))) : 0.0);
  if (hopf && !(hopf->kappa(y) > near * near * size * size)) return false;
  if (hopf && type == "ZH") return e.size() > 0 && e.cwiseAbs().minCoeff() < near * size;
  return std::any_of(e.begin(), e.end(), [&](const auto& z) { return z.imag() > near * size && std::abs(z.real()) < near * z.imag(); });
}

// A curve of torus points ends where its multipliers meet at 1 or -1; beyond, the same curve runs back with the frequency mirrored.
bool Follower::past_strong_resonance(In y) const {
  const auto* torus = dynamic_cast<const TorusSystem*>(system_.get());
  return torus && (torus->kappa(y) < 0.0 || torus->kappa(y) > 0.5 * dynamic_cast<const OrbitProblem&>(f_).base_frequency(base(y)));
}

bool Follower::dissolved(In y) const {
  const auto* point = dynamic_cast<const BranchPointSystem*>(system_.get());
  return point && !point->persists(y);
}

bool Follower::mirrored(const Vector& a, const Vector& b) const {
  for (int r = 0; r < static_cast<int>(f_.reflections().size()); ++r) {
    if (std::find(blocks_.active.begin(), blocks_.active.end(), r) != blocks_.active.end()) continue;
    double product = 0.0;
    for (int i : odd_coordinates(f_, r)) product += a[i] * b[i];
    if (product < 0.0) return true;
  }
  return false;
}

bool Follower::symmetric(const Vector& u) const {
  for (int r = 0; r < static_cast<int>(f_.reflections().size()); ++r) {
    if (std::find(blocks_.active.begin(), blocks_.active.end(), r) != blocks_.active.end()) continue;
    double odd = 0.0;
    for (int i : odd_coordinates(f_, r)) odd = std::max(odd, std::abs(u[i]));
    if (odd < 1e-2 * largest_odd_[static_cast<std::size_t>(r)]) return true;
  }
  return false;
}

// A second eigenvalue joins the first at zero; of a periodic motion a second multiplier at 1, or at -1 of a doubling.
Test Follower::double_root() const {
  const char* name = f_.is_flow() ? "BT" : !dynamic_cast<const OrbitProblem*>(&f_) ? "BT" : point_.subtype == period_doubling_subtype ? "R2" : "R1";
  const auto* singular = dynamic_cast<const SingularSystem*>(system_.get());
  return {name, [this, singular](In y) { return mass(f_, base(y), singular->null_vector(y), singular->left_null_vector(y)); }};
}

std::vector<Test> Follower::tests() const {
  const auto coefficient = [this](In y) { return at(y).coefficient; };
  std::vector<Test> all;
  const auto* singular = dynamic_cast<const SingularSystem*>(system_.get());
  if (point_.type == EventType::fold && singular) {
    // c w'v, not c: finite where w'v = 0
    all.push_back({"CP", [this, singular](In y) {
                     const Vector u = base(y), v = singular->null_vector(y), w = singular->left_null_vector(y);
                     Vector full = Vector::Zero(u.size());
                     full.head(f_.size()) = v;
                     Matrix h(f_.size(), u.size());
                     f_.second(u, full, h);
                     return w.dot(h.leftCols(f_.size()) * v);
                   }});
    all.push_back(double_root());
    if (f_.is_flow()) all.push_back({"ZH", [this](In y) { return crossing_pair(y); }});
  }
  if (point_.type == EventType::branch_point) {
    if (point_.block > 0 || point_.subtype == "PF") all.push_back({"DP", coefficient});
    if (singular) all.push_back(double_root());
    if (f_.is_flow()) all.push_back({"ZH", [this](In y) { return crossing_pair(y); }});
  }
  if (singular && point_.type != EventType::hopf) add_other_blocks(all);
  if (const auto* torus = dynamic_cast<const TorusSystem*>(system_.get())) {
    const auto& orbit = dynamic_cast<const OrbitProblem&>(f_);
    for (const int q : {3, 4})
      all.push_back({fmt::format("R{}", q), [this, torus, &orbit, q](In y) { return torus->kappa(y) / orbit.base_frequency(base(y)) - 1.0 / q; }});
  }
  if (const auto* hopf = dynamic_cast<const HopfSystem*>(system_.get())) {
    all.push_back({"BT", [hopf](In y) { return hopf->kappa(y); }});
    all.push_back({"GH", coefficient});
    all.push_back({"ZH", [this](In y) { return crossing_real(y); }});
    if (f_.size() >= 4) all.push_back({"HH", [this](In y) { return crossing_pair(y); }});
  }
  return all;
}

// Where r_x is singular in a second symmetry block as well, a curve of folds and one of pitchforks cross, or two of pitchforks.
void Follower::add_other_blocks(std::vector<Test>& all) const {
  const Indices& state = blocks_.indices[0];
  others_.clear();
  for (int k = 0; k < static_cast<int>(blocks_.indices.size()); ++k) {
    const Indices& block = blocks_.indices[static_cast<std::size_t>(k)];
    if (k == point_.block || block.empty()) continue;
    others_.push_back(std::make_unique<SingularSystem>(f_, state, block, start_));
    all.push_back({k == 0 || point_.block == 0 ? "FP" : "PP", [this, other = others_.back().get(), r = Vector(system_->size())](In y) mutable {
                     other->residual(y, r);
                     return r[r.size() - 1];
                   }});
  }
}

// Secant and bisection on the test function between points i and i + 1 of the walked system.
void Follower::locate(const Branch& b, int i, const Test& test, double from, double to, DefiningCurve& curve) {
  Curve c(*system_, make_blocks(*system_, {}), options_.walk.corrector);
  c.set_scales(std::max(1e-12, b.u(i).head(system_->size()).norm()), options_.range2[1] - options_.range2[0]);
  Sample a, d, m;
  if (!c.sample(b.u(i), b.tangent(i), a) || !c.sample(b.u(i + 1), b.tangent(i + 1), d)) return;
  double lo = 0.0, hi = 1.0, f = from, g = to;
  for (int k = 0; k < 80 && hi - lo > 1e-14; ++k) {
    const double sigma = k % 3 == 2 ? 0.5 * (lo + hi) : std::clamp(lo + (hi - lo) * f / (f - g), lo + 0.01 * (hi - lo), hi - 0.01 * (hi - lo));
    if (!c.between(a, d, sigma, m)) return;
    const double h = test.value(m.u);
    if (!std::isfinite(h)) return;
    if (h == 0.0) break;
    if ((h > 0.0) == (f > 0.0)) {
      lo = sigma;
      f = h;
    } else {
      hi = sigma;
      g = h;
    }
  }
  // A pole changes sign as well; at a zero the function is small next to what it was at the ends.
  if (std::abs(test.value(m.u)) > 1e-3 * std::max(std::abs(from), std::abs(to))) return;
  if ((test.type == "ZH" || test.type == "HH") && !is_crossing(m.u, test.type)) return;
  // At a Bogdanov-Takens point the first Lyapunov coefficient ends.
  if (const auto* hopf = dynamic_cast<const HopfSystem*>(system_.get());
      hopf && test.type == "GH" && hopf->kappa(m.u) < 1e-6 * std::max(std::abs(hopf->kappa(a.u)), std::abs(hopf->kappa(d.u))))
    return;
  CodimensionTwo s;
  s.type = test.type;
  s.u = base(m.u);
  s.residual = m.residual;
  s.arclength = b.arclength(i) + lo * (b.arclength(i + 1) - b.arclength(i));
  if (symmetric(s.u)) return;  // where the curve meets its mirror image its state is symmetric: the degenerate point of the branch-point curve
  curve.special.push_back(std::move(s));
}

DefiningCurve Follower::run(double p2, const Observer& observer) {
  const int n = f_.size();
  Vector u(n + 2);
  u << point_.u, p2;
  start_ = u;
  system_ = make_system(f_, point_, blocks_, options_.walk.peaks, u);
  TwoParameterOptions o = options_;
  o.walk.lower = o.range2[0];
  o.walk.upper = o.range2[1];
  o.walk.locate_events = true;
  o.walk.explain_changes = false;
  o.walk.peaks.clear();
  o.walk.user_values.clear();
  o.walk.bounds = {{static_cast<int>(blocks_.indices[0].size()), o.range1[0], o.range1[1]}};  // of p1
  int fresh = 0;
  StopReason why = StopReason::none;  // of a walk that the watch below stops
  const Observer watch = [&](const Branch& b, int i) {
    if (++fresh % 10 == 0) system_->update_borders(b.u(i));  // keeps the borders near the null vectors as they turn
    const auto* hopf = dynamic_cast<const HopfSystem*>(system_.get());
    if (i > 0 && mirrored(base(b.u(i - 1)), base(b.u(i)))) why = StopReason::symmetric_branch;
    else if (dissolved(b.u(i))) {
      throw std::invalid_argument(fmt::format("the branch point dissolves as {} changes: it is a point, no curve",
                                              f_.parameter_names().size() > 1 ? f_.parameter_names()[1] : "the second parameter"));
    } else if (past_strong_resonance(b.u(i))) why = StopReason::strong_resonance;
    else if (hopf && hopf->kappa(b.u(i)) < 0.0) why = StopReason::bogdanov_takens;  // beyond: neutral saddles
    else if (observer && !observer(b, i)) why = StopReason::observer;
    return why == StopReason::none;
  };
  Walker walker(*system_, o.walk);
  const Branch b = [&] {
    // Polished at its own p2 first; of several pairs the one meant.
    Vector near = system_->unknowns(u);
    if (point_.type == EventType::hopf && std::isfinite(point_.frequency)) {
      near[static_cast<int>(blocks_.indices[0].size()) + 1] = point_.frequency * point_.frequency;
      system_->update_borders(near);
    }
    const NewtonResult start = newton(*system_, near, {.tolerance = 1e-12, .max_iterations = 20});
    if (!start.ok()) throw std::invalid_argument(fmt::format("the special point does not satisfy its system: {}", to_string(start.outcome)));
    const Vector up = Vector::Unit(system_->size() + 1, system_->size());
    const auto walk = [&](const Vector& direction) {
      why = StopReason::none;
      Branch half = walker.walk_from(start.x, direction, false, watch);
      if (half.stop_reason == StopReason::observer) half.stop_reason = why;
      return half;
    };
    Branch forward = walk(up);
    if (forward.stop_reason == StopReason::closed_loop || forward.points() == 0) return forward;
    system_->update_borders(start.x);
    return Branch::joined(walk(-forward.tangent(0)), forward);
  }();
  DefiningCurve curve;
  curve.type = point_.type;
  curve.subtype = point_.subtype;
  curve.block = point_.block;
  curve.start_reason = b.start_reason;
  curve.stop_reason = b.stop_reason;
  const int count = b.points();
  curve.u.resize(n + 2, count);
  curve.coefficient.resize(count);
  curve.frequency.resize(count);
  curve.residual.resize(count);
  for (int r = 0; r < static_cast<int>(f_.reflections().size()); ++r) {
    double largest = 0.0;
    for (int i = 0; i < count; ++i)
      for (const int k : odd_coordinates(f_, r)) largest = std::max(largest, std::abs(base(b.u(i))[k]));
    largest_odd_.push_back(largest);
  }
  sense_ = Vector();
  double sense_at_point = 1.0, nearest = std::numeric_limits<double>::infinity();
  const auto all = tests();
  std::vector<double> last(all.size(), std::nan(""));
  for (int i = 0; i < count; ++i) {
    system_->update_borders(b.u(i));
    for (auto& other : others_) other->update_borders(b.u(i));
    const SpecialPoint s = at(b.u(i));
    curve.u.col(i) = base(b.u(i));
    if (const double apart = (curve.u.col(i) - u).norm();
        apart < nearest && s.null_vector.size() == point_.null_vector.size() && s.null_vector.size() > 0) {
      nearest = apart;
      sense_at_point = s.null_vector.dot(point_.null_vector) < 0.0 ? -1.0 : 1.0;
    }
    curve.coefficient[i] = s.coefficient;
    curve.frequency[i] = s.frequency;
    curve.residual[i] = b.residual(i);
    for (std::size_t t = 0; t < all.size(); ++t) {
      const double now = all[t].value(b.u(i));
      if (i > 0 && std::isfinite(last[t]) && std::isfinite(now) && last[t] * now < 0.0) locate(b, i - 1, all[t], last[t], now, curve);
      last[t] = now;
    }
  }
  if (point_.type == EventType::fold) curve.coefficient *= sense_at_point;  // as the point itself has it
  // Folds of the curve in the second parameter, found by the walker itself: thresholds.
  for (const auto& s : b.special) {
    if (s.type != EventType::fold) continue;
    if (const auto* hopf = dynamic_cast<const HopfSystem*>(system_.get()); hopf && !(hopf->kappa(s.u) > 0.0)) continue;  // of neutral saddles
    CodimensionTwo e;
    e.type = b.points() > 0 && s.u[s.u.size() - 1] <= s.bracket[0] + 0.0 ? "MIN" : "MAX";
    e.u = base(s.u);
    e.residual = s.residual;
    e.arclength = s.arclength;
    if (symmetric(e.u)) continue;
    // Where the curve crosses another of its kind its system is singular, and one turn may be met several times.
    const auto again = [&](const CodimensionTwo& known) {
      const double w1 = o.range1[1] - o.range1[0], w2 = o.range2[1] - o.range2[0];
      return known.type == e.type && std::abs(known.u[n] - e.u[n]) < 1e-6 * w1 && std::abs(known.u[n + 1] - e.u[n + 1]) < 1e-6 * w2;
    };
    if (std::any_of(curve.special.begin(), curve.special.end(), again)) continue;
    curve.special.push_back(std::move(e));
  }
  return curve;
}

}  // namespace

namespace {

// A period doubling is a branch point of the doubled problem: its curve is followed there.
DefiningCurve follow_doubling(const OrbitProblem& orbit, const SpecialPoint& point, double p2, const TwoParameterOptions& options,
                              const Observer& observer) {
  Vector u(point.u.size() + 1);
  u << point.u, p2;
  auto at = period_doubling_near(orbit, u, point.block);
  if (!at) throw std::invalid_argument("the period doubling does not satisfy its system");
  at->u.conservativeResize(at->u.size() - 1);
  DefiningCurve curve = Follower(orbit.doubled(), *at, options).run(p2, observer);
  curve.type = EventType::period_doubling;
  curve.subtype = "";
  return curve;
}

}  // namespace

DefiningCurve follow(const Problem& problem2, const SpecialPoint& point, double p2, const TwoParameterOptions& options, const Observer& observer) {
  if (problem2.parameters() != 2) throw std::invalid_argument("following a special point needs a problem with two free parameters");
  if (problem2.derivatives() < 2) throw std::invalid_argument("following a special point needs second derivatives");
  const auto* orbit = dynamic_cast<const OrbitProblem*>(&problem2);
  if (orbit && point.type == EventType::period_doubling) return follow_doubling(*orbit, point, p2, options, observer);
  return Follower(problem2, point, options).run(p2, observer);
}

std::vector<SpecialPoint> curves_through(const Problem& f, const DefiningCurve& curve, const CodimensionTwo& point) {
  const int n = f.size();
  std::vector<SpecialPoint> starts;
  SpecialPoint start;
  start.u = point.u.head(n + 1);
  const bool double_zero = point.type == "BT", pair_too = point.type == "ZH" || point.type == "HH";
  if (!f.is_flow() || !(double_zero || pair_too)) return starts;
  if (curve.type == EventType::hopf && point.type != "HH") {
    start.type = EventType::fold;
    starts.push_back(start);
    return starts;
  }
  // Of the pairs on the axis, those of the curve itself left out.
  start.type = EventType::hopf;
  start.block = curve.block;
  if (double_zero) {
    starts.push_back(start);
    return starts;
  }
  double own = std::nan("");  // frequency of the curve there
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < curve.u.cols() && curve.type == EventType::hopf; ++i)
    if (const double apart = (curve.u.col(i) - point.u).norm(); apart < nearest) {
      nearest = apart;
      own = curve.frequency[i];
    }
  const Blocks blocks = make_blocks(f, active_reflections(f, point.u.head(n)));
  Matrix j(n, n + f.parameters());
  f.jacobian(point.u, j);
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < static_cast<int>(blocks.indices.size()); ++k) {
    const Indices& block = blocks.indices[static_cast<std::size_t>(k)];
    if (block.empty()) continue;
    const Eigen::VectorXcd eigenvalues = Eigen::EigenSolver<Matrix>(Matrix(j(block, block)), false).eigenvalues();
    for (const auto& z : eigenvalues) {
      const bool known = k == curve.block && std::abs(z.imag() - own) < 0.02 * own;
      if (!(z.imag() > 0.0) || known || std::abs(z.real()) >= best) continue;
      best = std::abs(z.real());
      start.block = k;
      start.frequency = z.imag();
    }
  }
  if (best < 1e-4 * (1.0 + start.frequency)) starts.push_back(start);
  return starts;
}

}  // namespace whirl::continuation
