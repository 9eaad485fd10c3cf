#include "continuation/special_points.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <memory>

#include "continuation/augmented.hpp"
#include "continuation/multiple_point.hpp"
#include "continuation/period_doubling.hpp"
#include "continuation/state_problem.hpp"
#include "continuation/switching.hpp"
#include "continuation/torus.hpp"
#include "core/problem_in_units.hpp"

namespace whirl::continuation {
namespace {

Indices block_or_empty(const Blocks& blocks, int k) { return blocks.indices[static_cast<std::size_t>(k)]; }

bool period_doubling(const Curve& curve, int group, const Sample& near, SpecialPoint& out) {
  const auto at = period_doubling_near(*curve.orbit(), near.u, group);
  if (!at) return false;
  out = {};
  out.type = EventType::period_doubling;
  out.block = group;
  out.u = curve.orbit()->from_doubled(at->u);
  out.tangent = near.tangent;
  out.residual = at->residual;
  return true;
}

// A part of its range: smaller values of the parameter are located to a part of that.
constexpr double least_part = 1e-6;

// Sizes of the unknowns (x, p, what else) of a defining system near its start.
Vector sizes(const Curve& curve, const AugmentedSystem& system, In start, In u, int extra) {
  const Problem& f = curve.problem();
  const Eigen::Index states = system.size() - 1 - extra;
  Vector all = Vector::Constant(system.size(), curve.x_scale());
  all[states] = std::clamp(std::abs(u[f.size()]), least_part * curve.p_scale(), curve.p_scale());
  for (Eigen::Index i = states + 1; i < all.size(); ++i) all[i] = start[i] != 0.0 ? std::abs(start[i]) : 1.0;
  if (dynamic_cast<const BranchPointSystem*>(&system)) {  // beta stands in the equations: the size of their terms
    Matrix j(f.size(), f.size() + f.parameters());
    f.jacobian(u, j);
    all[states + 1] = std::max(curve.x_scale() * j.leftCols(f.size()).norm(), curve.p_scale() * j.col(f.size()).norm());
    if (!(all[states + 1] > 0.0)) all[states + 1] = 1.0;
  }
  return all;
}

// Is the last unknown, beta of a branch point, zero up to rounding of the terms at hand? Then two curves cross and do not just come near.
bool persists(const Curve& curve, In y, const Vector& units, In u) {
  constexpr double rounding = 1e-8, least_terms = 1e-3;  // all terms may vanish at the very point
  const Problem& f = curve.problem();
  const Eigen::Index n = f.size(), beta = units.size() - 1;
  Matrix j(n, n + f.parameters());
  f.jacobian(u, j);
  const double terms = std::max((j.leftCols(n).cwiseAbs() * u.head(n).cwiseAbs()).maxCoeff(), curve.p_scale() * j.col(n).lpNorm<Eigen::Infinity>());
  return std::abs(y[beta]) <= rounding * std::clamp(terms, least_terms * units[beta], units[beta]);
}

std::unique_ptr<AugmentedSystem> torus_system(const Curve& curve, int group, const Sample& near) {
  const OrbitProblem& orbit = *curve.orbit();
  const double kappa = torus_frequency(orbit, near.u, group);
  if (!(kappa > 0.0)) return nullptr;
  return std::make_unique<TorusSystem>(orbit, curve.blocks().indices[0], unknowns_of_group(orbit, near.u, group), near.u, kappa);
}

// Do several eigenvalues vanish at this very point?
bool is_multiple(const Curve& curve, const Vector& u) {
  constexpr double same = 1e-7;
  if (curve.problem().size() > always_asked) return false;
  const auto point = multiple_point_near(curve.problem(), u, curve.x_scale(), curve.p_scale());
  return point && curve.length(point->u - u) <= same * (1.0 + curve.length(u));
}

// Where another branch with all the symmetries of this one crosses it.
bool branch_point_of_state(const Curve& curve, const Sample& near, SpecialPoint& out) {
  const Problem& f = curve.problem();
  const StateProblem own(f, block_or_empty(curve.blocks(), 0));
  const bool whole = own.size() == f.size();
  const Vector at = whole ? near.u : own.restricted(near.u);
  const BranchPointSystem system(whole ? f : static_cast<const Problem&>(own), at);
  const Vector start = system.unknowns(at);
  if (!start.allFinite()) return false;
  const Vector units = sizes(curve, system, start, near.u, 1);
  const NewtonResult r = newton_in_units(system, start, units, {.tolerance = 1e-13, .max_iterations = 12});
  if (!r.settled()) return false;
  const Vector found = system.base_point(r.x), u = whole ? found : own.lifted(found);
  if (!persists(curve, r.x, units, u)) return false;
  if (is_multiple(curve, u)) return false;
  out = {};
  out.type = EventType::branch_point;
  out.u = u;
  out.tangent = near.tangent;
  out.residual = r.residual;
  name_branch_point(f, out, {.range = curve.p_scale(), .size = curve.x_scale()});
  return true;
}

}  // namespace

bool special_point_near(const Curve& curve, const EventKind& kind, const Sample& near, SpecialPoint& out, double frequency) {
  const Problem& f = curve.problem();
  if (f.derivatives() < 2) return false;
  if (kind.type == EventType::period_doubling) return period_doubling(curve, kind.block, near, out);
  const Blocks& blocks = curve.blocks();
  const bool of_group = kind.type == EventType::torus;  // then kind.block is no symmetry block
  const Indices state = block_or_empty(blocks, 0), block = block_or_empty(blocks, of_group ? 0 : kind.block);
  std::unique_ptr<AugmentedSystem> system;
  switch (kind.type) {
    case EventType::fold:
      system = std::make_unique<SingularSystem>(f, state, state, near.u);
      break;
    case EventType::branch_point:
      if (kind.block == 0) return branch_point_of_state(curve, near, out);
      system = std::make_unique<SingularSystem>(f, state, block, near.u);
      break;
    case EventType::hopf:
      if (!(frequency > 0.0) && !(near.kappa[static_cast<std::size_t>(kind.block)] > 0.0)) return false;  // no pair here
      system = std::make_unique<HopfSystem>(f, state, block, near.u,
                                            frequency > 0.0 ? frequency * frequency : near.kappa[static_cast<std::size_t>(kind.block)]);
      break;
    case EventType::torus:
      system = torus_system(curve, kind.block, near);
      if (!system) return false;
      break;
    case EventType::period_doubling:
    case EventType::end:
    case EventType::gave_up:
    case EventType::user_value:
    case EventType::peak:
    case EventType::unresolved:
      return false;
  }
  const Vector start = system->unknowns(near.u);
  if (!start.allFinite()) return false;
  const bool has_extra = kind.type == EventType::hopf || kind.type == EventType::torus;
  const Vector units = sizes(curve, *system, start, near.u, has_extra ? 1 : 0);
  NewtonResult r = newton_in_units(*system, start, units, {.tolerance = 1e-13, .max_iterations = 12});
  if (!r.settled()) return false;
  if (kind.type == EventType::hopf && !(static_cast<HopfSystem&>(*system).kappa(r.x) > 0.0)) return false;
  if (kind.type == EventType::torus && !(static_cast<TorusSystem&>(*system).kappa(r.x) > 0.0)) return false;
  out = {};
  out.type = kind.type;
  out.block = kind.block;
  out.u = system->base_point(r.x);
  out.tangent = near.tangent;
  out.residual = r.residual;
  out.subtype = kind.type == EventType::branch_point ? blocks.subtype[static_cast<std::size_t>(kind.block)] : "";
  if (auto* singular = dynamic_cast<SingularSystem*>(system.get())) out.null_vector = singular->null_vector(r.x);
  if (kind.type == EventType::hopf) out.frequency = std::sqrt(static_cast<HopfSystem&>(*system).kappa(r.x));
  if (kind.type == EventType::torus) {
    const auto& torus = static_cast<TorusSystem&>(*system);
    const Eigen::VectorXcd v = torus.null_vector(r.x);
    out.frequency = torus.kappa(r.x);
    out.null_vector = v.real();
    out.null_vector_im = v.imag();
  }
  return true;
}

bool branch_point_at(const Curve& curve, const Sample& near, SpecialPoint& out) {
  if (curve.orbit() || !special_point_near(curve, {EventType::branch_point, 0}, near, out) || curve.length(out.u - near.u) > 1e-6) return false;
  const double p = out.u[out.u.size() - 1], q = near.u[near.u.size() - 1];
  out.bracket[0] = std::min(p, q);
  out.bracket[1] = std::max(p, q);
  out.unstable_before = out.unstable_after = near.signature.total_unstable();
  return true;
}

bool mirror_crossing(const Curve& curve, const Sample& a, const Sample& b, int r, SpecialPoint& out) {
  const Problem& f = curve.problem();
  const Vector& signs = f.reflections()[static_cast<std::size_t>(r)].signs;
  double product = 0.0;
  for (int i = 0; i < f.size(); ++i)
    if (signs[i] < 0.0) product += a.u[i] * b.u[i];
  if (!(product < 0.0)) return false;
  const Indices odd = odd_coordinates(f, r);
  // Where the odd part passes zero on the chord, made exactly symmetric.
  double na = 0.0, nb = 0.0;
  for (int i : odd) {
    na += a.u[i] * a.u[i];
    nb += b.u[i] * b.u[i];
  }
  const double sigma = std::sqrt(na) / (std::sqrt(na) + std::sqrt(nb));
  Vector guess = a.u + sigma * (b.u - a.u);
  for (int i : odd) guess[i] = 0.0;
  std::vector<int> active = curve.blocks().active;
  active.push_back(r);
  std::sort(active.begin(), active.end());
  const Blocks blocks = make_blocks(f, active);
  for (std::size_t k = 1; k < blocks.indices.size(); ++k) {
    if (blocks.indices[k].empty() || f.reflections()[static_cast<std::size_t>(r)].signs[blocks.indices[k].front()] > 0.0) continue;
    SingularSystem system(f, blocks.indices[0], blocks.indices[k], guess);
    const Vector start = system.unknowns(guess);
    const NewtonResult result = newton_in_units(system, start, sizes(curve, system, start, guess, 0), {.tolerance = 1e-13, .max_iterations = 15});
    if (!result.settled()) continue;
    const Vector u = system.base_point(result.x);
    const double chord = curve.length(b.u - a.u);
    if (curve.length(u - guess) > chord) continue;
    out = {};
    out.type = EventType::branch_point;
    out.subtype = blocks.subtype[k];
    out.block = static_cast<int>(k);
    out.u = u;
    for (int i : odd) out.u[i] = 0.0;
    out.tangent = (b.u - a.u) / chord;
    out.null_vector = system.null_vector(result.x);
    out.residual = result.residual;
    out.unstable_before = out.unstable_after = a.signature.total_unstable();
    out.bracket[0] = std::min({u[f.size()], a.u[f.size()], b.u[f.size()]});
    out.bracket[1] = std::max({u[f.size()], a.u[f.size()], b.u[f.size()]});
    return true;
  }
  return false;
}

namespace {

// Size of [r_x r_p] in the metric around u: the largest at points a tenth of the scales away, since at u itself all of it may vanish.
double usual_size(const Curve& curve, In u) {
  constexpr double away = 0.1;
  const Problem& f = curve.problem();
  Vector scales = Vector::Constant(f.size() + 1, curve.x_scale());
  scales[f.size()] = curve.p_scale();
  Matrix j(f.size(), f.size() + 1);
  double size = 0.0;
  for (int i = 0; i <= f.size(); ++i) {
    Vector beside = u;
    beside[i] += away * scales[i];
    f.jacobian(beside, j);
    if (j.allFinite()) size = std::max(size, (j * scales.asDiagonal()).norm());
  }
  return size;
}

}  // namespace

bool turns_upright(const Curve& curve, const SpecialPoint& point) {
  const Problem& f = curve.problem();
  Matrix j(f.size(), f.size() + f.parameters());
  f.jacobian(point.u, j);
  // Is r_p in the range of r_x, hence orthogonal to all its left null vectors?
  const Indices& state = curve.blocks().indices[0];
  const Matrix a = curve.x_scale() * j(state, state);
  const Vector rp = curve.p_scale() * j(state, f.size());
  const Eigen::JacobiSVD<Matrix> svd(a, Eigen::ComputeFullU);
  const double small = 1e-6 * usual_size(curve, point.u);
  for (Eigen::Index k = 0; k < a.rows(); ++k)
    if (svd.singularValues()[k] <= small && std::abs(svd.matrixU().col(k).dot(rp)) > small) return false;
  return true;
}

}  // namespace whirl::continuation
