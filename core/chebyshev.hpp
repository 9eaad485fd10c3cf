#pragma once
/// Chebyshev collocation on [a, b]: the extreme points and the matrix that differentiates a function given there.
///
/// nodes x_j = (a + b)/2 - (b - a)/2 cos(j pi / n), j = 0 ... n, increasing; rows of D sum to zero exactly. Throws std::invalid_argument for n < 1.
///
///     const ChebyshevGrid grid(48, 0.0, length);
///     Vector slope = grid.derivative * values;

#include <Eigen/Core>

namespace whirl {

struct ChebyshevGrid {
  ChebyshevGrid(int n, double a, double b);
  Eigen::VectorXd nodes;       ///< n + 1
  Eigen::MatrixXd derivative;  ///< (n + 1) x (n + 1)
};

}  // namespace whirl
