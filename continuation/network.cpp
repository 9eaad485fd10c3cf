#include "continuation/network.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "continuation/natural_size.hpp"
#include "continuation/normal_form.hpp"
#include "continuation/null_vectors.hpp"
#include "continuation/switching.hpp"
#include "core/problem_in_units.hpp"

namespace whirl::continuation {

Network::Network(const Problem& problem, NetworkOptions options)
    : problem_(problem), options_(std::move(options)), mirrors_(reflection_products(problem)) {
  options_.walk.validate();
}

bool Network::same_up_to_mirror(In a, In b) const {
  const int n = problem_.size();
  if (std::abs(a[n] - b[n]) > options_.same * (options_.walk.upper - options_.walk.lower)) return false;
  const double limit = options_.same * std::max({size_, a.head(n).norm(), b.head(n).norm()});
  return std::any_of(mirrors_.begin(), mirrors_.end(),
                     [&](const Vector& signs) { return (a.head(n) - signs.cwiseProduct(b.head(n))).norm() <= limit; });
}

// A value next to an end of the range but for its last digits is that end.
Vector Network::inside(Vector u) const {
  double& p = u[problem_.size()];
  const auto& w = options_.walk;
  const double digits = 1e-9 * (w.upper - w.lower);
  for (const double end : {w.lower, w.upper})
    if (std::abs(p - end) < digits) p = end;
  return u;
}

// Newton with x in units of its size.
NewtonResult Network::solve(const Vector& start, const NewtonOptions& options) const {
  return newton_in_units(problem_, start, Vector::Constant(problem_.size(), unit_at(start)), options);
}

// The size of x near u: of the state or, at rest, the problem's own.
double Network::unit_at(const Vector& u) const {
  const double known = u.head(problem_.size()).norm();
  if (!problem_.is_flow()) return known > 0.0 ? known : 1.0;
  return std::max(known, natural_size(problem_, u, options_.walk.lower, options_.walk.upper));
}

std::vector<std::pair<int, Vector>> Network::solutions_at(double p) const {
  constexpr double same_digits = 1e-9;
  const int n = problem_.size();
  p = inside(Vector::Constant(n + 1, p))[n];
  std::vector<std::pair<int, Vector>> all;
  for (int b = 0; b < static_cast<int>(branches_.size()); ++b) {
    const Branch& branch = branches_[static_cast<std::size_t>(b)];
    // Points and special points in order: a fold between two points must not hide what lies beyond them.
    struct Knot {
      double s;
      Vector u;
    };
    std::vector<Knot> knots;
    std::size_t next = 0;
    for (int i = 0; i < branch.points(); ++i) {
      for (; next < branch.special.size() && branch.special[next].arclength < branch.arclength(i); ++next)
        knots.push_back({branch.special[next].arclength, branch.special[next].u});
      knots.push_back({branch.arclength(i), branch.u(i)});
    }
    const std::size_t first = all.size();
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      const double p0 = knots[i].u[n], p1 = knots[i + 1].u[n];
      if ((p0 - p) * (p1 - p) > 0.0 || p0 == p1) continue;
      Vector guess = knots[i].u + (p - p0) / (p1 - p0) * (knots[i + 1].u - knots[i].u);
      guess[n] = p;
      const NewtonResult r = solve(guess, {.tolerance = 1e-11, .max_iterations = 15});
      const double chord = std::hypot((knots[i + 1].u - knots[i].u).head(n).norm(), size_ * (p1 - p0) / (options_.walk.upper - options_.walk.lower));
      if (!r.ok() || (r.x - guess).head(n).norm() > chord + same_digits * size_) continue;
      const bool repeated = std::any_of(all.begin() + static_cast<std::ptrdiff_t>(first), all.end(), [&](const auto& known) {
        return (known.second - r.x).head(n).norm() <= same_digits * std::max(size_, r.x.head(n).norm());
      });
      if (!repeated) all.emplace_back(b, r.x);
    }
  }
  return all;
}

MembershipOptions Network::membership(double accuracy) const {
  return {.range = options_.walk.upper - options_.walk.lower, .least_size = options_.same * size_, .accuracy = accuracy, .same = options_.same};
}

void Network::note(const std::string& text) {
  if (std::find(notes_.begin(), notes_.end(), text) == notes_.end()) notes_.push_back(text);
}

bool Network::contains(In u) const {
  const int n = problem_.size();
  const MembershipOptions options = membership(branches_.empty() ? 0.0 : newton_error(problem_, u));
  for (const Vector& signs : mirrors_) {
    Vector image = u;
    image.head(n).array() *= signs.array();
    for (std::size_t b = 0; b < branches_.size(); ++b)
      if (lies_on(problem_, branches_[b], shapes_[b], image, options)) return true;
  }
  return false;
}

int Network::unstable_at(int branch, In u) const {
  const Branch& b = branches_[static_cast<std::size_t>(branch)];
  Matrix j(problem_.size(), problem_.size() + 1);
  problem_.jacobian(u, j);
  const Blocks blocks = make_blocks(problem_, b.active_reflections);
  Spectrum spectrum(blocks);
  return spectrum.compute(j) ? spectrum.unstable() : -1;
}

// A solution where r_x is singular has a fold or branch point on it, where a walk cannot begin: it begins beside it, at another value of the
// parameter or, at a fold, along the null vector.
Vector Network::regular_start(const Vector& u0) const {
  const int n = problem_.size();
  const NewtonOptions exact{.tolerance = 1e-12, .max_iterations = 30};
  Matrix j(n, n + 1);
  const NewtonResult polished = solve(u0, exact);
  const Vector at = polished.ok() ? polished.x : u0;
  double usual = 0.0;  // size of r_x around
  for (const double part : {-1e-2, 1e-2}) {
    Vector beside = at;
    beside[n] += part * (options_.walk.upper - options_.walk.lower);
    problem_.jacobian(beside, j);
    if (j.allFinite()) usual = std::max(usual, j.leftCols(n).norm());
  }
  const auto condition = [&](const Vector& u) {
    problem_.jacobian(u, j);
    const auto lu = j.leftCols(n).partialPivLu();
    if (!(lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 0.0)) return 0.0;  // an exact zero among the pivots, of which rcond makes anything
    const double reciprocal = lu.rcond();
    if (!std::isfinite(reciprocal)) return 0.0;
    return usual > 0.0 ? reciprocal * std::min(1.0, j.leftCols(n).norm() / usual) : reciprocal;
  };
  const double reciprocal_at = condition(at);
  if (reciprocal_at > 1e-5) return u0;
  const auto within = [&](const Vector& u) {  // the same branch may go on where the walk may not
    return std::all_of(options_.walk.bounds.begin(), options_.walk.bounds.end(),
                       [&](const CoordinateBound& b) { return u[b.index] >= b.lower && u[b.index] <= b.upper; });
  };
  const auto better = [&](const Vector& u) { return within(u) && condition(u) > 30.0 * reciprocal_at; };
  for (const double part : {1e-4, -1e-4, 1e-3, -1e-3, 1e-2, -1e-2}) {
    Vector beside = at;
    beside[n] += part * (options_.walk.upper - options_.walk.lower);
    if (beside[n] < options_.walk.lower || beside[n] > options_.walk.upper) continue;
    const NewtonResult there = solve(beside, exact);
    if (there.ok() && better(there.x)) return there.x;
  }
  problem_.jacobian(at, j);
  Vector v, w, normal = Vector::Zero(n + 1);
  null_vectors(j.leftCols(n), v, w);
  normal.head(n) = v;
  Curve curve(problem_, make_blocks(problem_, {}), options_.walk.corrector);
  const double size = unit_at(at);
  curve.set_scales(size, options_.walk.upper - options_.walk.lower);
  for (const double part : {1e-3, -1e-3, 1e-2, -1e-2}) {
    Sample there;
    const Vector beside = at + part * size * normal;
    if (!curve.sample(beside, normal, there) || there.u[n] < options_.walk.lower || there.u[n] > options_.walk.upper) continue;
    if (better(there.u)) return there.u;
  }
  return u0;
}

// Points spread over its inside lie on branches known before.
bool Network::repeats(const Branch& branch) const {
  const int last = branch.points() - 1;
  if (last < 1) return branch.stop_reason == StopReason::parameter_bound;  // begins on the end of the range and leaves it
  for (const int part : {1, 2, 3})
    if (!contains(branch.u(std::clamp(last * part / 4, 1, last)))) return false;
  return true;
}

bool Network::add_seed(const Vector& u0, const std::string& origin) {
  const Seed outcome = walk_seed(u0, origin, 0);
  if (outcome == Seed::no_solution) note(origin + ": no solution near this start, Newton does not settle");
  return outcome == Seed::walked;
}

Network::Seed Network::walk_seed(const Vector& u0, const std::string& origin, int generation) {
  if (stopped_ || full()) return Seed::known;
  const NewtonOptions exact{.tolerance = 1e-12, .max_iterations = 30};
  Vector start = inside(u0);
  if (const NewtonResult polished = solve(start, exact); polished.ok()) start = polished.x;
  if (contains(start)) return Seed::known;
  const NewtonResult polished = solve(inside(regular_start(start)), exact);
  if (!polished.ok()) return Seed::no_solution;
  start = polished.x;
  const double unit = unit_at(start);
  for (int r = 0; r < static_cast<int>(problem_.reflections().size()); ++r) {  // symmetric up to rounding is symmetric
    const Indices odd = odd_coordinates(problem_, r);
    if (start(odd).lpNorm<Eigen::Infinity>() < 1e-11 * unit) start(odd).setZero();
  }
  if (contains(start)) return Seed::known;
  Walker walker(problem_, options_.walk);
  Branch branch = walker.walk(start, observer_);
  if (branch.points() == 0) return Seed::no_solution;
  if (repeats(branch)) return Seed::known;
  branch.born_at = origin;
  adopt(std::move(branch), generation);
  return Seed::walked;
}

void Network::name(Branch& branch) const {
  const std::string prefix = namer_ ? namer_(branch) : "B";
  int number = 1;
  for (const auto& b : branches_)
    if (b.name.starts_with(prefix) && b.name.find_first_not_of("0123456789", prefix.size()) == std::string::npos) ++number;
  branch.name = fmt::format("{}{}", prefix, number);
}

void Network::publish(Branch branch) {
  shapes_.emplace_back(branch);
  size_ = std::max(size_, shapes_.back().size);
  branches_.push_back(std::move(branch));
  if (on_branch_) on_branch_(branches_.back());
}

void Network::adopt(Branch branch, int generation) {
  if (branch.stop_reason == StopReason::observer || branch.start_reason == StopReason::observer) stopped_ = true;
  name(branch);
  for (auto& s : branch.special) set_normal_form(problem_, s);
  const int index = static_cast<int>(branches_.size());
  size_ = std::max(size_, BranchShape(branch).size);
  branch.mirror_image = branch.active_reflections.size() < problem_.reflections().size();
  branch.isola = generation == 0 && branch.stop_reason == StopReason::closed_loop;
  // Does the branch end at s on a more symmetric one?
  const auto lands = [&branch](const SpecialPoint& s) {
    const auto is = [&](int i) { return (s.u - branch.u(i)).norm() == 0.0; };
    return (branch.stop_reason == StopReason::symmetric_branch && is(branch.points() - 1)) ||
           (branch.start_reason == StopReason::symmetric_branch && is(0));
  };
  int count = 0;
  for (auto& s : branch.special) {
    if (s.type != EventType::branch_point) continue;
    ++count;
    // Two symmetries may break at one point of a branch: two junctions.
    const auto known = std::find_if(junctions_.begin(), junctions_.end(), [&](const Junction& j) {
      return same_up_to_mirror(j.point.u, s.u) && (j.branch != index || j.point.block == s.block);
    });
    if (known != junctions_.end()) {
      branch.isola = false;
      if (!known->landing) known->done = true;  // this branch ends at a point where another would have been switched to it
      continue;
    }
    junctions_.push_back({s, index, fmt::format("{}:BP{}", branch.name, count), generation, false, lands(s)});
  }
  publish(std::move(branch));
  if (!stopped_) add_images(Branch(branches_.back()));
}

// Their branch points are images of those of the original, where what leaves is followed: its images will come in turn.
void Network::add_images(const Branch& original) {
  if (!problem_.is_flow() || shapes_.back().size == 0.0) return;
  for (const SignedPermutation& g : group()) {
    Branch moved = image(g, original);
    if (repeats(moved) || !is_solution(moved)) continue;
    if (images_ >= options_.max_images) {
      note(fmt::format("more than {} branches are images of others under a symmetry: the rest is not listed", options_.max_images));
      return;
    }
    moved.active_reflections = active_reflections(problem_, moved.u(moved.points() / 2).head(problem_.size()));
    moved.born_at = original.name + " by symmetry";
    name(moved);
    const int index = static_cast<int>(branches_.size());
    for (const auto& s : moved.special)
      if (s.type == EventType::branch_point &&
          std::none_of(junctions_.begin(), junctions_.end(), [&](const Junction& j) { return same_up_to_mirror(j.point.u, s.u); }))
        junctions_.push_back({s, index, moved.name, 0, true, false});
    ++images_;
    publish(std::move(moved));
  }
}

// Is an image one of the exact equations, beyond the rounding that the symmetry was found to?
bool Network::is_solution(const Branch& branch) const {
  const int n = problem_.size(), last = branch.points() - 1;
  for (const int part : {1, 2, 3}) {
    const Vector u = branch.u(last * part / 4);
    const NewtonResult there = solve(u, {.tolerance = 1e-11, .max_iterations = 5});
    if (there.ok() && (there.x - u).head(n).norm() > options_.same * size_) return false;
  }
  return true;
}

const std::vector<SignedPermutation>& Network::group() {
  const auto& w = options_.walk;
  if (!group_) {
    const Vector at = branches_.empty() ? junctions_.front().point.u : branches_.front().u(0);  // none yet where a doubled family begins
    group_ = symmetries(problem_, {.size = size_ > 0.0 ? size_ : unit_at(at), .lower = w.lower, .upper = w.upper});
  }
  return *group_;
}

void Network::add_branch_point(const SpecialPoint& point, const std::string& origin) {
  const bool known = std::any_of(junctions_.begin(), junctions_.end(), [&](const Junction& j) { return same_up_to_mirror(j.point.u, point.u); });
  if (!known) junctions_.push_back({point, -1, origin, 0, false, false});
}

std::vector<std::string> Network::not_followed() const {
  std::vector<std::string> all;
  for (const auto& j : junctions_)
    if (!j.done) all.push_back(j.origin);
  return all;
}

void Network::switch_branches() {
  for (std::size_t i = 0; i < junctions_.size(); ++i) {
    if (stopped_) return;
    if (junctions_[i].done || (junctions_[i].generation >= options_.depth && !junctions_[i].landing)) continue;
    if (full()) return note(fmt::format("{} branches were walked: what leaves the other branch points is not followed", options_.max_branches));
    junctions_[i].done = true;
    const Junction junction = junctions_[i];
    if (junction.landing) follow_landing(junction);
    else leave(junction);
  }
}

// The branch that ends at the junction would have been found from the symmetric one, had that been known: its branch points are as old as those
// that the ending one was switched to at.
void Network::follow_landing(const Junction& junction) {
  const Vector& u = junction.point.u;
  if (on_landing_ && on_landing_(junction.point, junction.origin)) return;
  if (on_as_symmetric_branch(u)) return;
  (void)walk_seed(regular_start(u), junction.origin, std::max(0, junction.generation - 1));
  if (!stopped_ && !on_as_symmetric_branch(u)) note(fmt::format("the branch on which {} lies could not be followed", junction.origin));
}

// Does u lie on a branch that has all the symmetries of u?
bool Network::on_as_symmetric_branch(In u) const {
  const std::vector<int> symmetric = active_reflections(problem_, u.head(problem_.size()));
  const MembershipOptions options = membership(0.0);
  for (std::size_t b = 0; b < branches_.size(); ++b) {
    const auto& active = branches_[b].active_reflections;
    if (!std::includes(active.begin(), active.end(), symmetric.begin(), symmetric.end())) continue;
    for (const Vector& signs : mirrors_) {
      Vector image = u;
      image.head(problem_.size()).array() *= signs.array();
      if (lies_on(problem_, branches_[b], shapes_[b], image, options)) return true;
    }
  }
  return false;
}

void Network::leave(const Junction& junction) {
  SpecialPoint point = junction.point;
  const auto& w = options_.walk;
  const Departures found =
      departures(problem_, point, {.range = w.upper - w.lower, .size = size_ > 0.0 ? size_ : unit_at(point.u), .symmetries = group()});
  if (!found.found_all && found.starts > 0)
    note(
        fmt::format("at {} {} eigenvalues are zero at once: {} branches, and their images, were found by a search from {} starts, which "
                    "does not prove that no other leaves",
                    junction.origin, found.zeros, found.branches.size(), found.starts));
  else if (!found.found_all)
    note(fmt::format("at {} {} eigenvalues are zero at once, too many for a search: branches that leave there may be missing", junction.origin,
                     found.zeros));
  for (const Departure& d : found.branches) {
    if (full()) return;
    if (junction.branch >= 0)
      for (auto& s : branches_[static_cast<std::size_t>(junction.branch)].special)
        if (s.type == EventType::branch_point && s.subtype.empty() && (s.u - point.u).norm() == 0.0) s.subtype = point.subtype;
    Walker walker(problem_, options_.walk);
    Branch branch = walker.walk_from(point.u, d.direction, true, observer_);
    if (d.both_senses && branch.stop_reason != StopReason::closed_loop)
      branch = Branch::joined(walker.walk_from(point.u, -d.direction, true, observer_), branch);
    if (repeats(branch)) continue;
    branch.born_at = junction.origin;
    adopt(std::move(branch), junction.generation + 1);
  }
}

}  // namespace whirl::continuation
