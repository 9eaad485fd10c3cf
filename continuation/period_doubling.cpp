#include "continuation/period_doubling.hpp"

#include "continuation/augmented.hpp"
#include "core/newton.hpp"

namespace whirl::continuation {

std::vector<int> period_doubling_blocks(const OrbitProblem& doubled, const Blocks& blocks, In u2, int group) {
  std::vector<int> found;
  for (const int r : blocks.active) {
    const Reflection& shift = doubled.reflections()[static_cast<std::size_t>(r)];
    if (shift.subtype != period_doubling_subtype) continue;
    for (std::size_t k = 1; k < blocks.indices.size(); ++k) {
      const Indices& block = blocks.indices[k];
      if (!block.empty() && shift.signs[block.front()] < 0.0 && doubled.group_of_unknown(u2, block.front()) == group)
        found.push_back(static_cast<int>(k));
    }
  }
  return found;
}

std::optional<SpecialPoint> period_doubling_near(const OrbitProblem& f, In u, int group) {
  const OrbitProblem& doubled = f.doubled();
  const Vector guess = f.in_doubled(u);
  const Blocks blocks = make_blocks(doubled, active_reflections(doubled, guess.head(doubled.size())));
  std::optional<SpecialPoint> nearest;
  for (const int k : period_doubling_blocks(doubled, blocks, guess, group)) {
    SingularSystem system(doubled, blocks.indices[0], blocks.indices[static_cast<std::size_t>(k)], guess);
    const NewtonResult at = newton(system, system.unknowns(guess), {.tolerance = 1e-13, .max_iterations = 12});
    if (!at.settled(1e-11)) continue;
    SpecialPoint point;
    point.type = EventType::branch_point;
    point.subtype = period_doubling_subtype;
    point.block = k;
    point.u = system.base_point(at.x);
    point.null_vector = system.null_vector(at.x);
    point.residual = at.residual;
    if (!nearest || (point.u - guess).norm() < (nearest->u - guess).norm()) nearest = std::move(point);
  }
  return nearest;
}

}  // namespace whirl::continuation
