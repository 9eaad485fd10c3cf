#pragma once
/// Period doublings: a multiplier at -1 over nu T is a symmetry-breaking branch point of the same motion seen over 2 nu T, where the shift by nu T is
/// a reflection. So it has a fold-like regular system of its own (SingularSystem of augmented.hpp), a branch to switch to and a curve in two
/// parameters.
///
///     if (auto bp = period_doubling_near(orbit, u, group)) walker_of_doubled.walk_from(bp->u, direction along bp->null_vector, true);

#include <optional>

#include "continuation/blocks.hpp"
#include "continuation/branch.hpp"
#include "core/orbit_problem.hpp"

namespace whirl::continuation {

inline constexpr const char* period_doubling_subtype = "PD";  ///< of the reflection of a doubled problem that shifts by the undoubled period

/// Symmetry blocks of the doubled problem at u2 in which the shift is broken and whose unknowns belong to `group`: where a doubling of that group
/// lives.
std::vector<int> period_doubling_blocks(const OrbitProblem& doubled, const Blocks& blocks, In u2, int group);

/// The branch point of `f.doubled()` near the motion u, by Newton on its system; nothing if Newton does not converge.
std::optional<SpecialPoint> period_doubling_near(const OrbitProblem& f, In u, int group);

}  // namespace whirl::continuation
