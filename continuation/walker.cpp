#include "continuation/walker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "continuation/natural_size.hpp"
#include "continuation/turning.hpp"
#include "core/problem_in_units.hpp"

namespace whirl::continuation {

namespace {
constexpr double rounding = 1e-11;      // |x| below that times its unit is zero: what Newton leaves of a coordinate that is zero
constexpr int most_neutral_points = 4;  // beside a branch point; more are neutral by nature, as without damping
constexpr int most_unexplained = 20;    // steps of a branch: beyond them what changes is rounding, and no step is shortened for it
constexpr double upright = 1e8;         // slope of x against p, in units, above which a start says nothing of the size of x
constexpr double at_a_stand = 1e-3;     // slope of the parameter, in the metric, below which a state that grows does so without bound

// How a walk leaves a branch point: what lies nearer to it than the first point beside it is not seen.
struct DepartureLimits {
  double first = 0.05, first_of_orbit = 0.25;     // first distance tried, in parts of the first step; of orbits multipliers are less exact
  double shrink = 0.1;                            // the next one, in parts of the one before
  double nearest = 1e-8;                          // in the metric: nearer, what the branch does is rounding
  double aside = 0.1;                             // of the distance: largest correction away from the direction
  double bend = 0.5;                              // of the slope of the parameter at the branch point: largest change of it
  double upright = 1e-6;                          // smaller slopes are zero: a pitchfork, where the slope doubles with the distance
  double least_ratio = 1.6, largest_ratio = 2.4;  // of the slopes at the distance and at half of it
  double visible = 1e-13;                         // error of a slope times the distance: smaller ones are those of an upright line
};
constexpr DepartureLimits leaving;

// Size of x where x itself, at rest, does not tell it.
double unit_at(const Problem& f, In u0, const WalkOptions& o) {
  const auto* orbit = dynamic_cast<const OrbitProblem*>(&f);
  const bool has_period = orbit && orbit->group_of_unknown(u0, 0) < 0;  // of a limit cycle: its unknowns are never all at rest
  if (f.is_flow() || (orbit && !has_period)) return natural_size(f, u0, o.lower, o.upper);
  return 1.0;  // the unknowns of a defining system are never all at rest
}
// Where the cubic between two samples, along which the parameter is monotone, has this value of it.
Vector guess_at_value(const Curve& curve, const Sample& a, const Sample& b, int n, double value) {
  Sample at;
  double lo = 0.0, hi = 1.0;
  const bool rises = b.u[n] > a.u[n];
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (lo + hi);
    curve.guess(a, b, middle, at);
    ((at.u[n] < value) == rises ? lo : hi) = middle;
  }
  at.u[n] = value;
  return at.u;
}

// Where the parameter turns within the step; false if it does not.
bool find_turn(Curve& curve, const Sample& now, const Sample& next, int n, Sample& at) {
  double f = now.tangent[n], g = next.tangent[n], lo = 0.0, hi = 1.0;
  if (!(f * g < 0.0)) return false;
  at = next;
  for (int i = 0; i < 40 && hi - lo > 1e-9; ++i) {
    const double sigma = i % 3 == 2 ? 0.5 * (lo + hi) : std::clamp(lo + (hi - lo) * f / (f - g), lo + 0.02 * (hi - lo), hi - 0.02 * (hi - lo));
    if (!curve.between(now, next, sigma, at)) return false;
    const double slope = at.tangent[n];
    (slope * f > 0.0 ? lo : hi) = sigma;
    (slope * f > 0.0 ? f : g) = slope;
  }
  return true;
}

}  // namespace

void WalkOptions::validate() const {
  if (!(lower < upper) || !std::isfinite(lower) || !std::isfinite(upper))
    throw std::invalid_argument(fmt::format("the parameter range must be increasing and finite, got [{}, {}]", lower, upper));
  if (!(min_step > 0.0 && min_step <= initial_step && initial_step <= max_step))
    throw std::invalid_argument(
        fmt::format("steps must satisfy 0 < min_step <= initial_step <= max_step, got {}, {}, {}", min_step, initial_step, max_step));
  if (!(max_angle_deg > 0.0 && max_angle_deg < 90.0))
    throw std::invalid_argument(fmt::format("max_angle_deg must be in (0, 90), got {}", max_angle_deg));
  if (max_points < 2) throw std::invalid_argument(fmt::format("max_points must be >= 2, got {}", max_points));
}

namespace {
// Next to the branch point that it leaves, a motion's critical multiplier stands on the unit circle but for rounding: it counts on neither side.
bool neutral_multiplier(const Curve& curve, const Sample& s) {
  constexpr double rounding_of_multipliers = 1e-9;
  if (!curve.orbit()) return false;
  for (int k = 0; k < curve.parts(); ++k) {
    const GrowthRates& rates = s.rates[static_cast<std::size_t>(k)];
    if (std::min(std::abs(rates.ranked(rates.positive())), std::abs(rates.ranked(rates.positive() + 1))) < rounding_of_multipliers) return true;
  }
  return false;
}
}  // namespace

// Everything the loop touches, allocated once per walk.
struct Walker::State {
  State(const Problem& f, Blocks blocks, const WalkOptions& o)
      : curve(f, std::move(blocks), o.corrector),
        finder(curve, o.events),
        branch(f.size(), Curve::spectrum_size(f), o.max_points),
        step(o.initial_step),
        max_turn(2.0 * std::sin(o.max_angle_deg * (std::numbers::pi / 360.0))) {
    for (auto& p : samples) {
      p.u = Vector::Zero(f.size() + 1);
      p.tangent = Vector::Zero(f.size() + 1);
    }
    eigenvalues = Eigen::VectorXcd::Zero(Curve::spectrum_size(f));
    predicted = bend = start_u = start_tangent = Vector::Zero(f.size() + 1);
  }
  Curve curve;
  EventFinder finder;
  std::vector<int> broken;  // reflections that the branch does not keep
  Branch branch;
  std::array<Sample, 3> samples;
  Sample *before = &samples[0], *now = &samples[1], *next = &samples[2];  // change places
  SpecialPoint crossing;                                                  // the branch point on a symmetric branch that a step meets
  Vector predicted, bend, start_u, start_tangent;
  Eigen::VectorXcd eigenvalues;  // of `next`, kept while events are looked for
  Curve::Report report;
  double step, step_taken = 0.0, arclength = 0.0, largest_x = 0.0;
  double upright_from = 0.0;  // arclength since which the parameter has stood still
  double unbounded = 0.0;     // a state of this size
  double factor = 1.0;        // by which the next step may change
  double max_turn;            // between successive tangents of unit length
  int accepted = 0;
  int upright_points = 0;
  int unstable = 0;     // directions, of `next`
  int refinements = 0;  // of the step at hand, for the sake of events
  int unexplained = 0;  // points of the branch at which a change stayed unresolved
  double unit = 1.0;    // of x
  bool scale_from_slope = false;
  bool departed = false;       // from a branch point, to a first point beside it
  bool has_signature = false;  // of `now`; not at a branch point, where it is undefined
  bool has_before = false;     // `before` is a point of its own
  StopReason stop = StopReason::none;
  const Observer* observer = nullptr;

  void measure(const WalkOptions& o);
  void begin_at_branch_point(const Vector& direction, const WalkOptions& o);
  int unstable_at_branch_point();
  void leave_branch_point(const WalkOptions& o);
  bool beside_branch_point(double distance, const WalkOptions& o, Sample& out);
  bool goes_on_alike(double slope, double distance, const Sample& near, const Sample& far) const;
  bool is_unbounded() const;
  bool stands_upright(const WalkOptions& options);
  bool turns_too_far(double least_step);
};

// Does the state go on while the parameter stays? There r_x is singular all along, and what changes its sign is rounding: no event.
bool Walker::State::stands_upright(const WalkOptions& options) {
  constexpr double still = 1e-11;              // scaled slope of the parameter along the curve; x^4 leaves it within 2e-4
  constexpr double length = 1e-3;              // over which it must stand still,
  constexpr int points = 8;                    // and at so many points in a row
  if (!options.explain_changes) return false;  // a curve of special points may well keep to one value
  if (std::abs(now->tangent[now->tangent.size() - 1]) > still * curve.p_scale()) {
    upright_from = arclength;
    upright_points = 0;
    return false;
  }
  if (++upright_points < points || arclength - upright_from < length) return false;
  std::erase_if(branch.special, [this](const SpecialPoint& e) { return e.arclength > upright_from; });
  return true;
}

// Do multipliers turn so far in the step that lines of resonance may be passed unseen? The next step is chosen by it as well.
bool Walker::State::turns_too_far(double least_step) {
  constexpr TurningLimits limits;
  const double turn = curve.orbit() && has_before ? largest_turn(*next) / limits.most : 0.0;
  factor = std::max(factor, std::min(turn / 0.6, 2.0));
  return turn > 1.0 && step > least_step;
}

Walker::Walker(const Problem& problem, WalkOptions options) : problem_(problem), options_(std::move(options)) { options_.validate(); }
Walker::~Walker() = default;

Branch Walker::walk(const Vector& u0, const Observer& observer) {
  const int n = problem_.size();
  const Vector units = Vector::Constant(n, unit_at(problem_, u0, options_));
  NewtonResult polished = newton_in_units(problem_, u0, units, {.tolerance = 1e-12, .max_iterations = 30});
  if (!polished.ok())
    throw std::invalid_argument(
        fmt::format("no solution near the start of the branch: Newton {}, residual {:.3g}", to_string(polished.outcome), polished.residual));
  const Vector up = Vector::Unit(n + 1, n);
  Branch forward = walk_from(polished.x, up, false, observer);
  if (forward.stop_reason == StopReason::closed_loop || forward.stop_reason == StopReason::observer || forward.points() == 0) return forward;
  const Vector down = -forward.tangent(0);
  if (leaves_range(polished.x, down)) {  // nothing on the other side
    forward.start_reason = StopReason::parameter_bound;
    return forward;
  }
  const Branch backward = walk_from(polished.x, down, false, observer);
  return Branch::joined(backward, std::move(forward));
}

Branch Walker::walk_from(const Vector& u0, const Vector& direction, bool from_branch_point, const Observer& observer) {
  if (!begin(u0, direction, from_branch_point)) {
    s_->branch.stop_reason = StopReason::min_step;
    return std::move(s_->branch);
  }
  s_->observer = &observer;
  if (leaves_range(u0, s_->now->tangent)) s_->stop = StopReason::parameter_bound;
  while (can_continue()) {
    predict();
    if (!correct()) {
      shorten_step();
      continue;
    }
    if (!locate_events()) {
      shorten_step();
      continue;
    }
    accept();
    lengthen_step();
  }
  s_->branch.stop_reason = s_->stop;
  s_->finder.drop_turns_at_branch_points(s_->branch.special);
  s_->branch.sort_special();
  return std::move(s_->branch);
}

// Does a walk along `direction` leave a bound on which it stands?
bool Walker::leaves_range(In u, In direction) const {
  const auto leaves = [&](int i, double lower, double upper) {
    return (u[i] >= upper && direction[i] > 0.0) || (u[i] <= lower && direction[i] < 0.0);
  };
  bool any = leaves(problem_.size(), options_.lower, options_.upper);
  for (const auto& b : options_.bounds) any = any || leaves(b.index, b.lower, b.upper);
  return any;
}

bool Walker::begin(const Vector& u0, const Vector& direction, bool from_branch_point) {
  const int n = problem_.size();
  // A departing branch keeps only the symmetries that its direction keeps.
  std::vector<int> active = active_reflections(problem_, u0.head(n));
  std::erase_if(active, [&](int r) {
    for (int i : odd_coordinates(problem_, r))
      if (direction[i] != 0.0) return true;
    return false;
  });
  s_ = std::make_unique<State>(problem_, make_blocks(problem_, active), options_);
  State& s = *s_;
  s.branch.active_reflections = active;
  for (int r = 0; r < static_cast<int>(problem_.reflections().size()); ++r)
    if (std::find(active.begin(), active.end(), r) == active.end()) s.broken.push_back(r);
  const double range = options_.upper - options_.lower;
  s.now->u = s.start_u = u0;
  s.measure(options_);
  if (from_branch_point) {
    s.begin_at_branch_point(direction, options_);
  } else {
    const Vector normal = direction;
    if (!s.curve.sample(u0, normal, *s.now)) return false;
    const double slope = s.now->tangent.head(n).norm() / std::abs(s.now->tangent[n]);
    if (s.largest_x == 0.0 && slope * range > rounding * s.unit && slope * range < upright * s.unit) {  // at rest: the slope tells the size of x
      s.curve.set_scales(slope * range, range);
      s.scale_from_slope = true;
      s.step = std::max(options_.min_step, 0.05 * options_.initial_step);
      if (!s.curve.sample(u0, normal, *s.now)) return false;
    }
    s.step = std::max(options_.min_step, first_step_of_orbit(s.curve, u0, s.now->tangent, s.step));
    s.has_signature = true;
    s.branch.append(s.now->u, s.now->tangent, 0.0, s.now->residual, 0.0, s.now->iterations, s.curve.unstable(s.now->signature),
                    &s.curve.eigenvalues());
    *s.before = *s.now;
    s.start_tangent = s.now->tangent;
  }
  s.unbounded = 1e6 * std::max(s.unit, s.curve.x_scale());
  return true;
}

// The metric at the start: x in units of its own size, at rest of the problem's.
void Walker::State::measure(const WalkOptions& o) {
  unit = unit_at(curve.problem(), start_u, o);
  largest_x = start_u.head(curve.problem().size()).norm();
  if (largest_x < rounding * unit) largest_x = 0.0;  // Newton's remainder tells nothing of the size of x
  curve.set_scales(largest_x > 0.0 ? largest_x : unit, o.upper - o.lower);
}

void Walker::State::begin_at_branch_point(const Vector& direction, const WalkOptions& o) {
  Vector r(curve.problem().size());
  curve.problem().residual(start_u, r);
  now->residual = r.lpNorm<Eigen::Infinity>();
  start_tangent = now->tangent = direction / curve.length(direction);
  const int count = unstable_at_branch_point();
  branch.append(start_u, start_tangent, 0.0, now->residual, 0.0, 0, count, &eigenvalues);
  branch.start_reason = StopReason::known_branch_point;
  *before = *now;
  leave_branch_point(o);
}

// The critical one is neutral there up to rounding: it is not counted.
int Walker::State::unstable_at_branch_point() {
  const Problem& f = curve.problem();
  constexpr double neutral = 1e-8, nothing = 1e-10;  // next to its own size, or to that of the largest eigenvalue
  int count = 0;
  if (f.is_flow()) {
    Matrix j(f.size(), f.size() + 1);
    f.jacobian(start_u, j);
    Spectrum eigen(curve.blocks());
    if (eigen.compute(j)) eigenvalues = eigen.eigenvalues();
    const Eigen::ArrayXd size = eigenvalues.array().abs();
    const double critical = std::max(size.minCoeff(), nothing * size.maxCoeff());
    for (const auto& z : eigenvalues) count += z.real() > neutral * std::abs(z) && std::abs(z) > critical ? 1 : 0;
  } else if (curve.orbit()) {
    Eigen::VectorXi group(eigenvalues.size());
    if (curve.orbit()->multipliers(start_u, eigenvalues, group))
      for (const auto& mu : eigenvalues) count += std::abs(mu) > 1.0 + neutral ? 1 : 0;
  }
  return count;
}

// Where the branch goes on beyond a point beside the branch point as it begins before it, nothing lies between them: from there on steps are searched
// as everywhere. If it nowhere does, as at a degenerate pitchfork, the first regular point is taken.
void Walker::State::leave_branch_point(const WalkOptions& o) {
  const double slope = now->tangent[curve.problem().size()] / curve.p_scale();
  const double part = curve.orbit() ? leaving.first_of_orbit : leaving.first, finest = leaving.nearest / leaving.shrink;
  const double first = std::max(finest, part * o.initial_step * std::min(1.0, unit / curve.x_scale()));
  Sample far, near, best_far, best_near;
  double best = 0.0;
  bool alike = false;
  for (double distance = first; distance > leaving.nearest && !alike; distance *= leaving.shrink) {
    if (!beside_branch_point(distance, o, far) || !beside_branch_point(0.5 * distance, o, near)) continue;
    if (neutral_multiplier(curve, near) || neutral_multiplier(curve, far)) continue;
    // Where several eigenvalues vanish one may stay zero to higher order along the branch: its sign is rounding, and nearer it is only worse.
    alike = far.signature == near.signature && goes_on_alike(slope, distance, near, far);
    if (best > 0.0 && !alike) continue;
    best = distance;
    best_far = far;
    best_near = near;
  }
  if (best == 0.0) return;
  *before = std::move(best_near);
  *now = std::move(best_far);
  arclength = curve.length(now->u - start_u);
  step = std::clamp(best / part, o.min_step, o.initial_step);
  has_signature = departed = true;
}

// Near the branch point, in its direction, and within the range.
bool Walker::State::beside_branch_point(double distance, const WalkOptions& o, Sample& out) {
  const Vector guess = start_u + distance * start_tangent;
  if (!curve.sample(guess, start_tangent, out) || curve.length(out.u - guess) > leaving.aside * distance) return false;
  const double p = out.u[curve.problem().size()];
  return p >= o.lower && p <= o.upper;
}

bool Walker::State::goes_on_alike(double slope, double distance, const Sample& near, const Sample& far) const {
  const int n = curve.problem().size();
  const double half = near.tangent[n] / curve.p_scale(), whole = far.tangent[n] / curve.p_scale(), ratio = whole / half;
  if (std::abs(slope) > leaving.upright) return std::abs(whole - slope) < leaving.bend * std::abs(slope);
  return std::abs(whole) * distance < leaving.visible || (ratio > leaving.least_ratio && ratio < leaving.largest_ratio);
}

// Beyond any size, while the parameter hardly moves any more.
bool Walker::State::is_unbounded() const {
  return largest_x > unbounded && std::abs(now->tangent[curve.problem().size()]) < at_a_stand * curve.p_scale();
}

bool Walker::can_continue() const { return s_->stop == StopReason::none; }

// The cubic through the last two points and their tangents; one point alone: along its tangent.
void Walker::predict() {
  State& s = *s_;
  const double chord = s.step_taken;
  if (s.accepted == 0 || chord <= 0.0 || !s.has_signature || !s.has_before) {
    s.predicted = s.now->u + s.step * s.now->tangent;
    return;
  }
  // Arc over chord of a circle that turns so much.
  s.bend = s.now->tangent - s.before->tangent;
  const double arc = chord * (1.0 + s.curve.dot(s.bend, s.bend) / 24.0), sigma = s.step / arc, sigma2 = sigma * sigma;
  // u = now + sigma m1 + sigma^2 (2 m1 + m0 - 3 d) + sigma^3 (m1 + m0 - 2 d), d the chord, m the tangents times the arc
  const double on_now = arc * (sigma + sigma2 * (2.0 + sigma)), on_before = arc * sigma2 * (1.0 + sigma), on_chord = -sigma2 * (3.0 + 2.0 * sigma);
  s.predicted = (1.0 + on_chord) * s.now->u - on_chord * s.before->u + on_now * s.now->tangent + on_before * s.before->tangent;
}

bool Walker::correct() {
  State& s = *s_;
  const int n = problem_.size();
  s.next->u = s.predicted;
  s.report = s.curve.correct(s.next->u, s.now->tangent, s.predicted);
  if (!s.report.ok) return false;
  int index = n;
  double bound = 0.0;
  if (!within_bounds(index, bound)) {
    if (!reach_bound(index, bound)) return false;
  } else if (!s.curve.tangent(s.next->tangent)) {
    return false;
  }
  // A jump into a symmetric branch is no step along this one.
  for (const int r : s.broken) {
    const auto& signs = problem_.reflections()[static_cast<std::size_t>(r)].signs;
    double odd = 0.0, was_odd = 0.0;
    for (int i = 0; i < n; ++i)
      if (signs[i] < 0.0) {
        odd = std::max(odd, std::abs(s.next->u[i]));
        was_odd = std::max({was_odd, std::abs(s.now->u[i]), s.step * std::abs(s.now->tangent[i])});
      }
    if (odd < 1e-9 * was_odd) return false;
  }
  const double cosine = std::min(s.curve.dot(s.now->tangent, s.next->tangent), 1.0);
  const double angle = std::sqrt(2.0 - 2.0 * cosine), limit = s.max_turn;  // as chords
  const bool first_off_branch_point = s.accepted == 0 && !s.has_signature;
  const double by_angle = angle / (0.6 * limit);
  // The first correction, also against the step: a curve more crooked than the step is long is far from where the cubic leads.
  const double by_contraction = std::sqrt(s.report.contraction / 0.05), by_distance = std::sqrt(s.report.first_step / std::min(5e-3, 0.05 * s.step));
  if (s.report.first_step > 0.2 * s.step && !first_off_branch_point && s.step > 4.0 * options_.min_step) return false;
  s.factor = std::clamp(std::max({by_angle, by_contraction, by_distance}), 0.5, 2.0);
  if (angle > limit && !first_off_branch_point && s.step > 4.0 * options_.min_step) return false;
  s.step_taken = s.curve.length(s.next->u - s.now->u);
  // Newton has gone sideways by half the step or more: to another part of the curve, though it may run the same way there.
  if (s.step_taken > 1.12 * s.step && !first_off_branch_point && s.step > 4.0 * options_.min_step) return false;
  if (!s.curve.classify(s.next->u, s.next->tangent, s.next->signature)) return false;  // last: eigenvalues cost most
  s.curve.copy_spectrum(*s.next);
  s.eigenvalues = s.curve.eigenvalues();
  s.unstable = s.curve.unstable(s.next->signature);
  s.next->residual = s.report.residual;
  s.next->iterations = s.report.iterations;
  return true;
}

// The first range that the step leaves.
bool Walker::within_bounds(int& index, double& bound) const {
  const int n = problem_.size();
  double first = 2.0;  // fraction of the step
  const auto check = [&](int i, double lower, double upper) {
    const double to = s_->next->u[i], from = s_->now->u[i], end = to < lower ? lower : upper;
    if (to >= lower && to <= upper) return;
    const double part = std::clamp((end - from) / (to - from), 0.0, 1.0);
    if (part >= first) return;
    first = part;
    index = i;
    bound = end;
  };
  check(n, options_.lower, options_.upper);
  for (const auto& b : options_.bounds) check(b.index, b.lower, b.upper);
  return first > 1.0;
}

// The step crosses a bound of coordinate `index` of u: end on it exactly.
bool Walker::reach_bound(int index, double bound) {
  State& s = *s_;
  const double part = std::clamp((bound - s.now->u[index]) / (s.next->u[index] - s.now->u[index]), 0.0, 1.0);
  s.next->u = s.now->u + part * (s.next->u - s.now->u);
  s.next->u[index] = bound;
  s.bend = Vector::Unit(problem_.size() + 1, index) * (s.next->u[index] > s.now->u[index] ? 1.0 : -1.0);
  s.predicted = s.next->u;
  s.report = s.curve.correct(s.next->u, s.bend, s.predicted);
  if (!s.report.ok || s.curve.length(s.next->u - s.now->u) > 2.0 * s.step) return false;
  s.next->u[index] = bound;
  if (!s.curve.tangent(s.next->tangent)) return false;
  s.stop = StopReason::parameter_bound;
  return true;
}

void Walker::shorten_step() {
  State& s = *s_;
  s.stop = StopReason::none;
  s.step *= 0.5;
  if (s.step >= options_.min_step) return;
  // A branch point on the end of the range has no tangent to end on.
  const int n = problem_.size();
  const double p = s.now->u[n], near = 1e-8 * (options_.upper - options_.lower);
  const bool at_end = s.now->tangent[n] > 0.0 ? p > options_.upper - near : p < options_.lower + near;
  s.stop = at_end ? StopReason::parameter_bound : StopReason::min_step;
  SpecialPoint last;
  if (!at_end || !options_.locate_events || !s.has_signature || !branch_point_at(s.curve, *s.now, last)) return;
  last.arclength = s.arclength + s.curve.length(last.u - s.now->u);
  s.branch.special.push_back(std::move(last));
}

void Walker::lengthen_step() {
  State& s = *s_;
  s.step = std::clamp(s.step / s.factor, options_.min_step, options_.max_step);
}

// False if the step must be refined.
bool Walker::locate_events() {
  State& s = *s_;
  if (!options_.locate_events || !s.has_signature) return true;
  s.finder.follow(*s.before, *s.now, *s.next);
  if (s.turns_too_far(options_.least_step_on_suspicion * options_.max_step)) return false;
  for (const int r : s.broken) {
    if (!mirror_crossing(s.curve, *s.now, *s.next, r, s.crossing)) continue;
    // Stop on the branch point; what lies between is still looked at. Not nearer than 1e-3 of the step: the critical eigenvalue and the
    // slope of the parameter vanish with the square of the distance.
    const Vector chord = s.next->u - s.now->u;
    Sample last;
    if (s.curve.sample(s.crossing.u - 1e-3 * s.step_taken * s.crossing.tangent, chord, last)) {
      s.finder.follow(*s.before, *s.now, last);
      for (auto& e : s.finder.find(*s.before, *s.now, last)) {
        e.arclength = s.arclength + s.curve.length(e.u - s.now->u);
        s.branch.special.push_back(std::move(e));
      }
      std::swap(*s.next, last);
      for (const auto& peak : options_.peaks) find_peak(peak);
    }
    s.next->u = s.crossing.u;
    s.step_taken = s.curve.length(s.next->u - s.now->u);
    if (!options_.user_values.empty()) find_user_values();
    s.crossing.arclength = s.arclength + s.step_taken;
    s.branch.special.push_back(std::move(s.crossing));
    s.stop = StopReason::symmetric_branch;
    return true;
  }
  // At either end of the walk there is no point beyond that would show a turn.
  const int first = s.branch.start_reason == StopReason::known_branch_point && !s.departed ? 1 : 0;
  const bool last = s.stop != StopReason::none || (s.accepted == first && !s.departed);
  if (last || !(s.now->signature == s.next->signature) || !(s.before->signature == s.now->signature) ||
      s.finder.turns_at(*s.before, *s.now, *s.next) || s.finder.suspects(*s.before, *s.now, *s.next, last)) {
    const int undecided = s.finder.collisions().undecided();
    auto& found = s.finder.find(*s.before, *s.now, *s.next, last);
    const bool may_refine = s.unexplained < most_unexplained, open = s.finder.passed_over() || s.finder.collisions().undecided() > undecided;
    if (may_refine && open && s.step > options_.least_step_on_suspicion * options_.max_step) return false;
    if (std::any_of(found.begin(), found.end(), [this](const auto& e) { return asks_for_shorter_step(e); })) return false;
    s.refinements = 0;
    s.unexplained += std::any_of(found.begin(), found.end(), [](const auto& e) { return e.type == EventType::unresolved; }) ? 1 : 0;
    for (auto& e : found) {
      if (is_known(e)) continue;
      const Vector from_now = e.u - s.now->u;
      const bool behind = s.curve.dot(from_now, s.next->u - s.now->u) < 0.0;
      e.arclength = s.arclength + (behind ? -1.0 : 1.0) * s.curve.length(from_now);
      s.branch.special.push_back(std::move(e));
    }
  }
  find_peaks_and_values();
  return true;
}

// A change that nothing explains may be a jump to another curve; a fold out of range means that the curve was out of range for a while.
bool Walker::asks_for_shorter_step(const SpecialPoint& e) {
  State& s = *s_;
  if (e.type == EventType::unresolved)
    return options_.explain_changes && s.unexplained < most_unexplained && ++s.refinements <= 5 && s.step > 1e-4 * options_.max_step;
  const double margin = 1e-9 * (options_.upper - options_.lower), p = e.u[problem_.size()];
  return e.type == EventType::fold && (p > options_.upper + margin || p < options_.lower - margin) && s.step > 1e-5 * options_.max_step;
}

// A step may be searched twice, as the one behind and as the one ahead of a turn.
bool Walker::is_known(const SpecialPoint& e) const {
  const auto& known = s_->branch.special;
  return std::any_of(known.rbegin(), known.rend(), [&](const SpecialPoint& k) {
    return k.type == e.type && k.block == e.block && std::abs(k.frequency - e.frequency) <= 1e-6 * k.frequency &&
           std::abs(k.arclength - s_->arclength) < 3.0 * options_.max_step && s_->curve.length(k.u - e.u) < 1e-9;
  });
}

void Walker::find_peaks_and_values() {
  if (!options_.user_values.empty()) find_user_values();
  for (const auto& peak : options_.peaks) find_peak(peak);
}

void Walker::find_user_values() {
  State& s = *s_;
  const int n = problem_.size();
  const auto add = [&](EventType type, const std::string& subtype, const Sample& at) {
    SpecialPoint p;
    p.type = type;
    p.subtype = subtype;
    p.u = at.u;
    p.tangent = at.tangent;
    p.residual = at.residual;
    p.bracket[0] = s.now->u[n];
    p.bracket[1] = s.next->u[n];
    p.arclength = s.arclength + s.curve.length(at.u - s.now->u);
    p.unstable_before = p.unstable_after = at.signature.total_unstable();
    s.branch.special.push_back(std::move(p));
  };
  const auto within_step = [&](const SpecialPoint& e) {
    return e.type == EventType::fold && e.arclength > s.arclength && e.arclength < s.arclength + s.step_taken;
  };
  const auto enclosed = [&](double value) { return (s.now->u[n] - value) * (s.next->u[n] - value) <= 0.0; };
  if (!(s.now->tangent[n] * s.next->tangent[n] < 0.0) && std::none_of(s.branch.special.begin(), s.branch.special.end(), within_step) &&
      std::none_of(options_.user_values.begin(), options_.user_values.end(), enclosed))
    return;
  // A turn of the parameter within the step parts it in two, each of which may meet a value that the ends do not enclose.
  std::vector<Sample> knots = {*s.now};
  for (const auto& e : s.branch.special)
    if (within_step(e)) {
      knots.push_back({.u = e.u, .tangent = e.tangent, .signature = {}});
      if (s.curve.dot(e.tangent, s.next->u - s.now->u) < 0.0) knots.back().tangent *= -1.0;
    }
  Sample turn, at;
  if (knots.size() == 1 && find_turn(s.curve, *s.now, *s.next, n, turn)) knots.push_back(turn);  // its folds are not events of this walk
  knots.push_back(*s.next);
  std::vector<Sample> met;
  for (const double value : options_.user_values)
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
      const Sample &a = knots[k], &b = knots[k + 1];
      if ((a.u[n] - value) * (b.u[n] - value) > 0.0 || a.u[n] == value) continue;
      Vector guess = guess_at_value(s.curve, a, b, n, value);
      const Vector normal = Vector::Unit(n + 1, n) * (b.u[n] > a.u[n] ? 1.0 : -1.0);
      if (s.curve.sample(guess, normal, at)) met.push_back(at);
    }
  for (const Sample& value : met) add(EventType::user_value, "", value);
}

// An extremum of the observable within the step: its slope along the tangent changes sign.
void Walker::find_peak(const Observable& peak) {
  State& s = *s_;
  const int n = problem_.size();
  const auto slope = [&](const Sample& at) {
    if (peak.form) return peak.form->gradient(at.u.head(n)).dot(at.tangent.head(n));
    constexpr double h = 1e-5;  // in the metric
    return (peak.value(at.u + h * at.tangent) - peak.value(at.u - h * at.tangent)) / (2.0 * h);
  };
  double f = slope(*s.now), g = slope(*s.next);
  if (!(f * g < 0.0)) return;
  SpecialPoint p;
  p.type = EventType::peak;
  p.subtype = peak.name;
  for (int k = 0; k < 2; ++k) p.bracket[k] = k == 0 ? std::min(s.now->u[n], s.next->u[n]) : std::max(s.now->u[n], s.next->u[n]);
  Sample at = *s.next;
  double lo = 0.0, hi = 1.0;
  for (int i = 0; i < 60 && hi - lo > 1e-10; ++i) {
    const double sigma = i % 3 == 2 ? 0.5 * (lo + hi) : std::clamp(lo + (hi - lo) * f / (f - g), lo + 0.02 * (hi - lo), hi - 0.02 * (hi - lo));
    if (!s.curve.between(*s.now, *s.next, sigma, at)) break;
    if (peak.form && problem_.derivatives() >= 2) {  // its own system, from ever nearer
      PeakSystem system(problem_, s.curve.blocks().indices[0], *peak.form, at.u);
      Vector units = Vector::Constant(system.size(), s.curve.x_scale());
      units[system.size() - 1] = s.curve.p_scale();
      const NewtonResult r = newton_in_units(system, system.unknowns(at.u), units, {.tolerance = 1e-13, .max_iterations = 12});
      const bool solved = r.settled();
      const Vector chord = s.next->u - s.now->u;
      Vector u = at.u;
      if (solved) u = system.base_point(r.x);
      const double part = s.curve.dot(u - s.now->u, chord) / s.curve.dot(chord, chord);
      if (solved && part > -1e-6 && part < 1.0 + 1e-6 && s.curve.length(u - s.now->u - part * chord) < 0.5 * s.step_taken + 1e-12 &&
          s.curve.sample(u, chord, at)) {
        at.u = u;
        at.residual = r.residual;
        break;
      }
    }
    const double m = slope(at);
    if (m * f > 0.0) {
      lo = sigma;
      f = m;
    } else {
      hi = sigma;
      g = m;
    }
  }
  p.u = at.u;
  p.tangent = at.tangent;
  p.residual = at.residual;
  p.arclength = s.arclength + s.curve.length(at.u - s.now->u);
  for (int count : at.signature.unstable) p.unstable_after += count;
  p.unstable_before = p.unstable_after;
  s.branch.special.push_back(std::move(p));
}

void Walker::accept() {
  State& s = *s_;
  if (s.accepted > 2 && close_loop()) return;
  s.arclength += s.step_taken;
  s.branch.append(s.next->u, s.next->tangent, s.arclength, s.next->residual, s.step, s.next->iterations, s.unstable, &s.eigenvalues);
  std::swap(s.before, s.now);
  std::swap(s.now, s.next);
  s.has_before = s.has_signature;
  if (!s.has_signature) *s.before = *s.now;
  s.has_signature = s.has_signature || s.accepted >= most_neutral_points || !neutral_multiplier(s.curve, *s.now);
  ++s.accepted;
  keep_scale();
  if (s.stop == StopReason::none && s.is_unbounded()) s.stop = StopReason::unbounded;
  if (s.stop == StopReason::none && creeps_to_bound()) s.stop = StopReason::parameter_bound;
  if (s.stop == StopReason::none && s.stands_upright(options_)) s.stop = StopReason::unbounded;  // no step leads off this parameter value
  if (s.stop == StopReason::none && s.branch.points() == s.branch.capacity()) s.stop = StopReason::max_points;
  if (s.stop == StopReason::none && s.observer && *s.observer && !(*s.observer)(s.branch, s.branch.points() - 1)) s.stop = StopReason::observer;
}

// Does the parameter tend to an end of its range without ever reaching it?
bool Walker::creeps_to_bound() const {
  const double p = s_->now->u[problem_.size()], towards = s_->now->tangent[problem_.size()], next_to = 1e-12 * (options_.upper - options_.lower);
  return (towards < 0.0 && p - options_.lower < next_to) || (towards > 0.0 && options_.upper - p < next_to);
}

// x is measured by the largest met so far; until the parameter has moved, a start at rest knows only the slope it had there.
void Walker::keep_scale() {
  State& s = *s_;
  const int n = problem_.size();
  const double range = options_.upper - options_.lower, size = s.now->u.head(n).norm(), moved = std::abs(s.now->u[n] - s.start_u[n]);
  double scale = s.curve.x_scale();
  if (size > 2.0 * s.largest_x || s.largest_x == 0.0) {
    s.largest_x = size;
    scale = std::max(scale, size);
  }
  if (s.scale_from_slope) {
    const double by_chord = std::max(s.largest_x, size * range / moved);
    if (by_chord < 0.5 * scale && by_chord > rounding * s.unit) scale = by_chord;
    s.scale_from_slope = moved < 0.05 * range;
  }
  if (scale == s.curve.x_scale()) return;
  s.curve.set_scales(scale, range);
  for (auto* p : {s.before, s.now}) p->tangent /= s.curve.length(p->tangent);
  s.start_tangent /= s.curve.length(s.start_tangent);  // close_loop measures in the new metric
  s.step_taken = s.curve.length(s.now->u - s.before->u);
}

// Does the step pass the first point in its sense? Then the curve is closed.
bool Walker::close_loop() {
  State& s = *s_;
  const int n = problem_.size();
  if (std::abs(s.next->u[n] - s.start_u[n]) > 2.5 * s.step_taken * s.curve.p_scale()) return false;  // far off, as most often
  const double d0 = s.curve.length(s.now->u - s.start_u), d1 = s.curve.length(s.next->u - s.start_u);
  if (std::min(d0, d1) > 1.5 * s.step_taken || s.curve.dot(s.now->tangent, s.start_tangent) < 0.5) return false;
  s.bend = s.start_u - s.now->u;
  const double ahead = s.curve.dot(s.bend, s.now->tangent);
  if (ahead < 0.0 || ahead > 1.2 * s.step_taken) return false;
  // Not before the step has passed it: what lies between is looked at in this step or in none.
  s.bend = s.next->u - s.start_u;
  constexpr double last_digits = 1e-6;
  if (s.curve.dot(s.bend, s.start_tangent) < -last_digits * s.step_taken) return false;
  s.predicted = s.start_u;
  Sample at;
  const Vector chord = s.next->u - s.now->u, before_start = s.now->u + (ahead / s.step_taken) * chord;
  const double apart = s.curve.length(before_start - s.start_u);
  if (s.branch.start_reason == StopReason::known_branch_point) {  // no plane to solve in: the curve passes it, in its direction
    if (apart > 0.05 * s.step_taken || s.curve.dot(s.now->tangent, s.start_tangent) < 0.95) return false;
    s.arclength += s.curve.length(s.start_u - s.now->u);
    s.branch.append(s.start_u, s.start_tangent, s.arclength, s.branch.residual(0), s.step, 0, s.branch.n_unstable(0), &s.eigenvalues);
    // A branch that left upright comes back upright: its turn there is no fold, and rounding may have found it beside the point.
    constexpr double beside = 1e-4;  // in the metric
    const bool upright_start = std::abs(s.start_tangent[n]) < leaving.upright * s.curve.p_scale();
    std::erase_if(s.branch.special, [&](const SpecialPoint& e) {
      const bool turn = upright_start && e.type == EventType::fold && e.arclength > s.arclength - s.step_taken;
      return e.arclength > s.arclength - 1e-6 || (turn && s.curve.length(e.u - s.start_u) < beside);
    });
    s.stop = StopReason::closed_loop;
    return true;
  }
  // Off the chord by the curvature only, and Newton from there in the start's plane must come to the start.
  if (apart > 0.3 * s.step_taken) return false;
  Vector guess = before_start;
  if (!s.curve.sample(guess, s.start_tangent, at)) return false;
  const double shift = s.curve.dot(s.start_u - at.u, s.start_tangent);
  if (!s.curve.sample(at.u + shift * s.start_tangent, s.start_tangent, at)) return false;
  if (s.curve.length(at.u - s.start_u) > 1e-7) return false;
  s.arclength += s.curve.length(s.start_u - s.now->u);
  s.branch.append(s.start_u, s.start_tangent, s.arclength, at.residual, s.step, at.iterations, at.signature.total_unstable(), &s.curve.eigenvalues());
  // What lies behind the first point was found by the first step.
  std::erase_if(s.branch.special, [&s](const SpecialPoint& e) { return e.arclength > s.arclength; });
  s.stop = StopReason::closed_loop;
  return true;
}

}  // namespace whirl::continuation
