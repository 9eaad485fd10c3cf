#pragma once
/// Further solutions at fixed parameters: Newton on the residual divided by the distances to all solutions known, [FarrellBirkissonFunke2015].
///
///     m(x) r(x) = 0,   m(x) = prod over known x_k of (s^2 / |x - x_k|^2 + 1),   s a size of the unknowns
///
///     auto all = deflated_solutions(problem, {x0}, starts);     // x0 and what else the starts lead to

#include "core/newton.hpp"

namespace whirl::continuation {

struct DeflationOptions {
  NewtonOptions newton{.tolerance = 1e-11, .max_iterations = 60};
  double same = 1e-7;  ///< solutions nearer than this, relative to s + |x|, are one
  double scale = 1.0;  ///< s
  int max_solutions = 32;
};

/// All points are (x, p) of size n + k with the same p; the known ones come first in the result. Mirror images under the problem's
/// reflections count as known.
std::vector<Vector> deflated_solutions(const Problem& f, std::vector<Vector> known, const std::vector<Vector>& starts,
                                       const DeflationOptions& options = {});

}  // namespace whirl::continuation
