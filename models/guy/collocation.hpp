#pragma once
/// The full linear problem by Chebyshev collocation of the equations of motion, one dense complex solve a frequency: slow, and independent of
/// LinearGuy's Galerkin form, whose errors it measures. n + 1 points; same equations, units and refusals as models/guy/linear_guy.hpp.
///
///     const StiffnessMatrix k = collocated_stiffness(rest, 3.14, 0.009, 48);
///     const std::vector<double> w = collocated_frequencies(rest, Plane::in_plane, 48);

#include <vector>

#include "models/guy/linear_guy.hpp"

namespace whirl::models::guy {

[[nodiscard]] StiffnessMatrix collocated_stiffness(const Statics& exact, double p, double damping_rate, int n);

/// Increasing; the lower half is meaningful. Throws std::runtime_error if an eigenvalue is not real and positive among those.
[[nodiscard]] std::vector<double> collocated_frequencies(const Statics& exact, Plane plane, int n);

}  // namespace whirl::models::guy
