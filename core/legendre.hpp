#pragma once
/// Legendre polynomials, Gauss-Legendre rules of any size, and the two polynomial families that Galerkin methods on [-1, 1] want:
///
///     P_k                                             orthogonal on [-1, 1]
///     phi_k = (P_k - P_{k+2}) / sqrt(4 k + 6)         zero at both ends, slopes orthonormal: int phi_i' phi_j' = delta_ij
///     int_{-1}^t P_k = (P_{k+1} - P_{k-1}) / (2 k + 1)   zero at both ends for k >= 1
///
/// Tables have one row per point and one column per k. Throws std::invalid_argument for a rule or table without entries.
///
///     auto rule = gauss_legendre(40);
///     Matrix p = legendre_values(rule.nodes, 12);             // P_0 ... P_11
///     Matrix mass = p.transpose() * rule.weights.asDiagonal() * p;

#include "core/problem.hpp"

namespace whirl {

struct GaussRule {
  Vector nodes, weights;  ///< on [-1, 1], nodes increasing
};

/// n points, exact for polynomials of degree 2 n - 1. Rules are kept: the second call with one n is a copy. Thread-safe.
GaussRule gauss_legendre(int n);

/// P_0 ... P_{count-1} at the points t.
Matrix legendre_values(In t, int count);
/// phi_0 ... phi_{count-1} from a table of at least count + 2 Legendre polynomials.
Matrix dirichlet_values(const Matrix& legendre, int count);
/// Their slopes, -sqrt((2 k + 3) / 2) P_{k+1}.
Matrix dirichlet_slopes(const Matrix& legendre, int count);
/// int_{-1}^t P_k for k = 0 ... count-1, from a table of at least count + 1.
Matrix legendre_integrals(const Matrix& legendre, int count);
/// int_{-1}^t phi_k, from a table of at least count + 3.
Matrix dirichlet_integrals(const Matrix& legendre, int count);

}  // namespace whirl
