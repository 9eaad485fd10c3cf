#include "continuation/network.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "continuation/normal_form.hpp"
#include "continuation/null_vectors.hpp"
#include "continuation/switching.hpp"
#include "core/newton.hpp"

namespace whirl::continuation {

Network::Network(const Problem& problem, NetworkOptions options) : problem_(problem), options_(std::move(options)) { options_.walk.validate(); }

bool Network::same_up_to_mirror(In a, In b) const {
  const int n = problem_.size();
  const double limit = options_.same * (1.0 + a.head(n).norm());
  if (std::abs(a[n] - b[n]) > options_.same * (options_.walk.upper - options_.walk.lower)) return false;
  // All products of the reflections: they commute, so each is a subset.
  const std::size_t count = problem_.reflections().size();
  for (std::size_t subset = 0; subset < (std::size_t{1} << count); ++subset) {
    Vector signs = Vector::Ones(n);
    for (std::size_t r = 0; r < count; ++r)
      if (subset >> r & 1) signs.array() *= problem_.reflections()[r].signs.array();
    if ((a.head(n) - signs.cwiseProduct(b.head(n))).norm() <= limit) return true;
  }
  return false;
}

std::vector<std::pair<int, Vector>> Network::solutions_at(double p) const {
  const int n = problem_.size();
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
      const NewtonResult r = newton(problem_, guess, {.tolerance = 1e-11, .max_iterations = 15});
      const double chord = (knots[i + 1].u - knots[i].u).norm();
      if (!r.ok() || (r.x - guess).norm() > chord + 1e-9) continue;
      const bool repeated = std::any_of(all.begin() + static_cast<std::ptrdiff_t>(first), all.end(),
                                        [&](const auto& known) { return (known.second - r.x).norm() < 1e-9 * (1.0 + r.x.norm()); });
      if (!repeated) all.emplace_back(b, r.x);
    }
  }
  return all;
}

bool Network::contains(In u) const {
  const int n = problem_.size();
  for (const auto& [branch, known] : solutions_at(u[n]))
    if (same_up_to_mirror(known, u)) return true;
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
  const NewtonResult polished = newton(problem_, u0, exact);
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
    const double reciprocal = j.leftCols(n).partialPivLu().rcond();
    if (!std::isfinite(reciprocal)) return 0.0;  // an exact zero among the pivots
    return usual > 0.0 ? reciprocal * std::min(1.0, j.leftCols(n).norm() / usual) : reciprocal;
  };
  const double reciprocal_at = condition(at);
  if (reciprocal_at > 1e-5) return u0;
  const auto better = [&](const Vector& u) { return condition(u) > 30.0 * reciprocal_at; };
  for (const double part : {1e-4, -1e-4, 1e-3, -1e-3, 1e-2, -1e-2}) {
    Vector beside = at;
    beside[n] += part * (options_.walk.upper - options_.walk.lower);
    if (beside[n] < options_.walk.lower || beside[n] > options_.walk.upper) continue;
    const NewtonResult there = newton(problem_, beside, exact);
    if (there.ok() && better(there.x)) return there.x;
  }
  problem_.jacobian(at, j);
  Vector v, w, normal = Vector::Zero(n + 1);
  null_vectors(j.leftCols(n), v, w);
  normal.head(n) = v;
  Curve curve(problem_, make_blocks(problem_, {}), options_.walk.corrector);
  for (const double part : {1e-3, -1e-3, 1e-2, -1e-2}) {
    Sample there;
    const Vector beside = at + part * (1.0 + at.head(n).norm()) * normal;
    if (!curve.sample(beside, normal, there) || there.u[n] < options_.walk.lower || there.u[n] > options_.walk.upper) continue;
    if (better(there.u)) return there.u;
  }
  return u0;
}

// Both of two points inside lie on branches known before.
bool Network::repeats(const Branch& branch) const {
  const int last = branch.points() - 1;
  return last >= 4 && contains(branch.u(last / 3)) && contains(branch.u(2 * last / 3));
}

bool Network::add_seed(const Vector& u0, const std::string& origin) {
  if (stopped_ || static_cast<int>(branches_.size()) >= options_.max_branches || contains(u0)) return false;
  Vector start = regular_start(u0);
  if (const NewtonResult polished = newton(problem_, start, {.tolerance = 1e-12, .max_iterations = 30}); polished.ok()) start = polished.x;
  for (int r = 0; r < static_cast<int>(problem_.reflections().size()); ++r) {  // symmetric up to rounding is symmetric
    const Indices odd = odd_coordinates(problem_, r);
    if (start(odd).lpNorm<Eigen::Infinity>() < 1e-11 * (1.0 + start.head(problem_.size()).norm())) start(odd).setZero();
  }
  if (contains(start)) return false;
  Walker walker(problem_, options_.walk);
  Branch branch = walker.walk(start, observer_);
  branch.born_at = origin;
  adopt(std::move(branch), 0);
  return true;
}

void Network::adopt(Branch branch, int generation) {
  if (branch.stop_reason == StopReason::observer || branch.start_reason == StopReason::observer) stopped_ = true;
  const std::string prefix = namer_ ? namer_(branch) : "B";
  int number = 1;
  for (const auto& b : branches_)
    if (b.name.starts_with(prefix) && b.name.find_first_not_of("0123456789", prefix.size()) == std::string::npos) ++number;
  branch.name = fmt::format("{}{}", prefix, number);
  for (auto& s : branch.special) set_normal_form(problem_, s);
  const int index = static_cast<int>(branches_.size());
  branch.mirror_image = branch.active_reflections.size() < problem_.reflections().size();
  branch.isola = generation == 0 && branch.stop_reason == StopReason::closed_loop;
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
      known->done = true;  // this branch ends at a point where another would have been switched to it
      continue;
    }
    const bool arrives = branch.stop_reason == StopReason::symmetric_branch && &s == &branch.special.back();
    junctions_.push_back({s, index, fmt::format("{}:BP{}", branch.name, count), generation, arrives});
  }
  branches_.push_back(std::move(branch));
  if (on_branch_) on_branch_(branches_.back());
}

void Network::add_branch_point(const SpecialPoint& point, const std::string& origin) {
  const bool known = std::any_of(junctions_.begin(), junctions_.end(), [&](const Junction& j) { return same_up_to_mirror(j.point.u, point.u); });
  if (!known) junctions_.push_back({point, -1, origin, 0, false});
}

std::vector<std::string> Network::not_followed() const {
  std::vector<std::string> all;
  for (const auto& j : junctions_)
    if (!j.done) all.push_back(j.origin);
  return all;
}

void Network::switch_branches() {
  for (std::size_t i = 0; i < junctions_.size(); ++i) {
    if (stopped_ || static_cast<int>(branches_.size()) >= options_.max_branches) return;
    if (junctions_[i].done || junctions_[i].generation >= options_.depth) continue;
    junctions_[i].done = true;
    SpecialPoint point = junctions_[i].point;
    const std::string origin = junctions_[i].origin;
    const int generation = junctions_[i].generation + 1;
    for (const Departure& d : departures(problem_, point)) {
      if (junctions_[i].branch >= 0)
        for (auto& s : branches_[static_cast<std::size_t>(junctions_[i].branch)].special)
          if (s.type == EventType::branch_point && s.subtype.empty() && (s.u - point.u).norm() == 0.0) s.subtype = point.subtype;
      Walker walker(problem_, options_.walk);
      Branch branch = walker.walk_from(point.u, d.direction, true, observer_);
      if (d.both_senses && branch.stop_reason != StopReason::closed_loop)
        branch = Branch::joined(walker.walk_from(point.u, -d.direction, true, observer_), branch);
      if (repeats(branch)) continue;
      branch.born_at = origin;
      adopt(std::move(branch), generation);
    }
  }
}

}  // namespace whirl::continuation
