#pragma once
/// Some eigenvectors of a symmetric tridiagonal matrix whose eigenvalues are known, by inverse iteration.
///
///     (T - mu_j) y = z,  z = y / |y|,     orthogonal to the vectors before it whose eigenvalues stand within 1e-3 |T|   (as in LAPACK)
///
/// Equal eigenvalues are told apart by a few roundings. A vector is accepted if its residual is of the size of rounding.
///
///     Matrix z;
///     bool done = tridiagonal_vectors(diagonal, off_diagonal, mu, z);      // one column for each mu

#include "core/problem.hpp"

namespace whirl {

/// `mu` in decreasing order. False, and z of no use, if some vector does not converge.
[[nodiscard]] bool tridiagonal_vectors(In diagonal, In off_diagonal, In mu, Matrix& z);

}  // namespace whirl
