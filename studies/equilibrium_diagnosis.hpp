#pragma once
/// What a branch of equilibria of a system given as text may meet that continuation has no event for: solutions that are not isolated, and corners.

#include "continuation/branch.hpp"
#include "models/equilibrium_symmetry.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

/// One line if the solution u = (x, p) of f lies on a curve of solutions at the same p: along which direction, and which key makes solutions
/// isolated; "" if it does not.
std::string why_not_isolated(const Problem& f, In u, const std::vector<std::string>& variables, const std::vector<models::Symmetry>& symmetries);

/// Unresolved changes at a corner (a zero in abs, two equal values in max or min, a jump of sign) become MX with the subtype "corner", one at each
/// place, and are warned of. So are ends there, and walks that ended because the parameter stood still while the state went on.
std::vector<continuation::Branch> with_corners_marked(const models::EquilibriumModel& model, const std::string& parameter,
                                                      const std::vector<continuation::Branch>& branches, RunContext& context);

}  // namespace whirl::studies
