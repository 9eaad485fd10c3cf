#include "continuation/special_points.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <memory>

#include "continuation/augmented.hpp"
#include "continuation/multiple_point.hpp"
#include "continuation/period_doubling.hpp"
#include "continuation/switching.hpp"
#include "continuation/torus.hpp"
#include "core/newton.hpp"

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

std::unique_ptr<AugmentedSystem> torus_system(const Curve& curve, int group, const Sample& near) {
  const OrbitProblem& orbit = *curve.orbit();
  const double kappa = torus_frequency(orbit, near.u, group);
  if (!(kappa > 0.0)) return nullptr;
  return std::make_unique<TorusSystem>(orbit, curve.blocks().indices[0], unknowns_of_group(orbit, near.u, group), near.u, kappa);
}

// Do several eigenvalues vanish at this very point?
bool is_multiple(const Problem& f, const Vector& u) {
  constexpr double same = 1e-7;
  if (f.size() > always_asked) return false;
  const auto point = multiple_point_near(f, u);
  return point && (point->u - u).norm() <= same * (1.0 + u.norm());
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
      if (kind.block > 0) system = std::make_unique<SingularSystem>(f, state, block, near.u);
      else if (blocks.indices.size() == 1) system = std::make_unique<BranchPointSystem>(f, near.u);
      else return false;
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
  NewtonResult r = newton(*system, start, {.tolerance = 1e-13, .max_iterations = 12});
  if (!r.settled()) return false;
  if (kind.type == EventType::hopf && !(static_cast<HopfSystem&>(*system).kappa(r.x) > 0.0)) return false;
  if (kind.type == EventType::torus && !(static_cast<TorusSystem&>(*system).kappa(r.x) > 0.0)) return false;
  if (auto* point = dynamic_cast<BranchPointSystem*>(system.get()); point && !point->persists(r.x)) return false;
  if (kind.type == EventType::branch_point && kind.block == 0 && is_multiple(f, system->base_point(r.x))) return false;
  out = {};
  out.type = kind.type;
  out.block = kind.block;
  out.u = system->base_point(r.x);
  out.tangent = near.tangent;
  out.residual = r.residual;
  out.subtype = kind.type == EventType::branch_point ? blocks.subtype[static_cast<std::size_t>(kind.block)] : "";
  if (auto* singular = dynamic_cast<SingularSystem*>(system.get())) out.null_vector = singular->null_vector(r.x);
  if (kind.type == EventType::branch_point && kind.block == 0) name_branch_point(f, out);
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
    const NewtonResult result = newton(system, system.unknowns(guess), {.tolerance = 1e-13, .max_iterations = 15});
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

bool turns_upright(const Curve& curve, const SpecialPoint& point) {
  const Problem& f = curve.problem();
  Matrix j(f.size(), f.size() + f.parameters());
  f.jacobian(point.u, j);
  // Is r_p in the range of r_x, hence orthogonal to all its left null vectors?
  const Indices& state = curve.blocks().indices[0];
  const Matrix a = j(state, state);
  const Vector rp = j(state, f.size());
  const Eigen::JacobiSVD<Matrix> svd(a, Eigen::ComputeFullU);
  const double small = 1e-6 * j.norm();
  for (Eigen::Index k = 0; k < a.rows(); ++k)
    if (svd.singularValues()[k] <= small && std::abs(svd.matrixU().col(k).dot(rp)) > small) return false;
  return true;
}

}  // namespace whirl::continuation
