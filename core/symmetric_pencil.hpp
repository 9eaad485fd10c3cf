#pragma once
/// The symmetric definite eigenproblem of linear vibration, K q = w^2 M q with K positive definite, and the count that proves none is missing.
///
/// It is solved as M q = w^-2 K q: the lowest frequencies are the largest eigenvalues, which keep all their digits however stiff the rest is.
///
///     M q = mu K q,  K = L L',   C = L^-1 M L^-T,   C z = mu z,   q = w L^-T z   so that   q' M q = 1
///     number of frequencies below w = number of negative eigenvalues of K - w^2 M     (Sylvester's law of inertia)
///
/// C is brought to tridiagonal form T, all eigenvalues are taken from that, and only the wanted vectors by inverse iteration: a few vectors of a
/// small matrix cost half of what all cost. Where most are wanted, or inverse iteration fails, all are computed.
///
/// The count knows nothing of that: a leading block of K - w^2 M that is positive definite (Cholesky proves it) is condensed, and the Sturm sequence
/// of the rest in tridiagonal form is counted. Inertia adds up [Haynsworth1968]:
///
///     A = [ P  Q' ]        inertia A = inertia P + inertia (S - Q P^-1 Q')
///         [ Q  S  ]
///
///     PencilModes modes = lowest_modes(K, M, 8);       // modes.omega, modes.vectors
///     bool complete = frequencies_below(K, M, 0.5 * (modes.omega[7] + next)) == 8;

#include "core/problem.hpp"

namespace whirl {

struct PencilModes {
  Vector omega;    ///< w, increasing
  Matrix vectors;  ///< one column each, q' M q = 1; empty when not wanted
};

/// The `count` lowest (fewer if the matrices are smaller). Throws std::invalid_argument if K is not positive definite or the shapes differ.
/// Directions without mass (M q = 0) have infinite frequency. `spare`: so many frequencies more, without vectors.
PencilModes lowest_modes(const Matrix& K, const Matrix& M, int count, bool vectors = true, int spare = 0);

/// Number of eigenvalues of the symmetric matrix A below zero. `stiff`: rows at the top that are likely to be positive definite; only speed depends
/// on it.
int negative_eigenvalues(const Matrix& A, Eigen::Index stiff = 0);
inline int frequencies_below(const Matrix& K, const Matrix& M, double omega, Eigen::Index stiff = 0) {
  return negative_eigenvalues(K - omega * omega * M, stiff);
}

}  // namespace whirl
