#pragma once
/// The hierarchical basis on [-1, 1] whose slopes are orthonormal, free at x = 1: core/legendre.hpp's functions that vanish at both ends, and a line.
///
///     phi_0(x) = (1 + x)/2,   phi_j(x) = (P_{j+1} - P_{j-1}) / sqrt(2 (2j + 1)),  j = 1 ... degree - 1,
///
/// so that phi_j(-1) = 0 for all, phi_j(1) = 0 but for j = 0, and phi_j' is the normalised P_j: with constant coefficients the stiffness is a unit
/// matrix, and its condition number is the contrast of the coefficients, whatever the degree. Throws std::invalid_argument for a number below 1.
///
///     const GaussRule rule = gauss_legendre(64);
///     const LegendreBasis basis(48, rule.nodes);            // values and slopes at the nodes
///     Matrix k = basis.slope.transpose() * (rule.weights.array() * stiffness.array()).matrix().asDiagonal() * basis.slope;

#include "core/legendre.hpp"

namespace whirl::models::guy {

struct LegendreBasis {
  LegendreBasis(int degree, const Eigen::VectorXd& x);
  Eigen::MatrixXd value, slope;  ///< row: point, column: function j = 0 ... degree - 1
};

}  // namespace whirl::models::guy
