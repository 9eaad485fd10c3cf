#pragma once
/// Directions in which branches leave a branch point.

#include "continuation/branch.hpp"
#include "continuation/curve.hpp"
#include "continuation/symmetries.hpp"

namespace whirl::continuation {

struct Departure {
  Vector direction;  ///< size n + 1
  bool both_senses;  ///< +direction and -direction give different branches (else the other one is the mirror image)
};

struct Departures {
  std::vector<Departure> branches;
  int zeros = 1;          ///< eigenvalues that vanish at once
  int starts = 0;         ///< of the search where they are several; 0: there was none, as above five
  bool found_all = true;  ///< false where they are several: a search proves nothing about what it does not find
};

struct DepartureOptions {
  double range = 1.0;                              ///< of the parameter
  double size = 1.0;                               ///< of |x|, where the equations do not tell it
  std::vector<SignedPermutation> symmetries = {};  ///< of f: images of a direction are not listed beside it
};

/// Branches that leave `point` other than the one it was found on. Sets point.subtype to "PF" (pitchfork) or "TC" (transcritical) where no
/// reflection names it. Block 0 solves the algebraic branching equation
///     (w' D2r[phi_i, phi_j]) alpha_i alpha_j = 0,   phi_1, phi_2 spanning ker [r_x r_p], w' [r_x r_p] = 0.
/// Where several eigenvalues vanish at once: what meets a small sphere about the point, by Newton from many starts on it.
Departures departures(const Problem& f, SpecialPoint& point, const DepartureOptions& options);

/// Only that subtype, of a simple branch point without symmetry.
void name_branch_point(const Problem& f, SpecialPoint& point, const DepartureOptions& options = {});

}  // namespace whirl::continuation
