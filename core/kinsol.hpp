#pragma once
/// Globalised Newton (KINSOL, line search) for a first point far from any known solution.

#include "core/newton.hpp"

namespace whirl {

/// Solves r(x, p) = 0 for x, the last k entries of `start` held, by KINSOL's line search with the exact Jacobian, then polishes with Newton.
[[nodiscard]] NewtonResult line_search_solve(const Problem& f, const Vector& start, const NewtonOptions& options = {});

/// Version text of the SUNDIALS library in use, "6.4.1".
std::string sundials_version();

}  // namespace whirl
