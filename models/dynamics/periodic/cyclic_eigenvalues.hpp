#pragma once
/// Eigenvalues of the product A_m .. A_2 A_1 of square matrices of one size, sorted by falling modulus.
///
/// Where the product is badly scaled its small eigenvalues drown in the rounding of the large ones. Then they are taken from the cyclic matrix
///
///     [ 0              A_m ]
///     [ A_1  0             ]        whose eigenvalues are all m-th roots of those of the product: their range is only the m-th root of it.
///     [      A_2  0        ]
///
///     Eigen::VectorXcd mu = cyclic_eigenvalues({a1, a2, a3});

#include <vector>

#include "core/problem.hpp"

namespace whirl::models {

Eigen::VectorXcd cyclic_eigenvalues(const std::vector<Matrix>& factors);

}  // namespace whirl::models
