#pragma once
/// Directions in which branches leave a branch point.

#include "continuation/branch.hpp"
#include "continuation/curve.hpp"

namespace whirl::continuation {

struct Departure {
  Vector direction;  ///< size n + 1
  bool both_senses;  ///< +direction and -direction give different branches (else the other one is the mirror image)
};

/// Branches that leave `point` other than the one it was found on. Sets point.subtype to "PF" (pitchfork) or "TC" (transcritical) where no
/// reflection names it. Block 0 solves the algebraic branching equation
///     (w' D2r[phi_i, phi_j]) alpha_i alpha_j = 0,   phi_1, phi_2 spanning ker [r_x r_p], w' [r_x r_p] = 0.
std::vector<Departure> departures(const Problem& f, SpecialPoint& point);

}  // namespace whirl::continuation
