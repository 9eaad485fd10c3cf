#include "core/symmetric_pencil.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/tridiagonal_vectors.hpp"

namespace whirl {
namespace {

using Tridiagonal = Eigen::Tridiagonalization<Matrix>;

// Eigenvalues of C, the largest first, and vectors of the first `wanted`.
struct Spectrum {
  Vector mu;
  Matrix z;
};

Spectrum all_of(const Matrix& C, Eigen::Index wanted) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(C);
  return {solver.eigenvalues().reverse(), solver.eigenvectors().rightCols(wanted).rowwise().reverse()};
}

Spectrum largest_of(const Matrix& C, Eigen::Index wanted, bool vectors) {
  if (vectors && 3 * wanted > C.rows()) return all_of(C, wanted);
  const Tridiagonal t(C);
  const Vector d = t.diagonal(), e = t.subDiagonal();
  Eigen::SelfAdjointEigenSolver<Matrix> solver;
  solver.computeFromTridiagonal(d, e, Eigen::EigenvaluesOnly);
  Spectrum s{solver.eigenvalues().reverse(), Matrix()};
  if (!vectors) return s;
  if (!tridiagonal_vectors(d, e, s.mu.head(wanted), s.z)) return all_of(C, wanted);
  s.z.applyOnTheLeft(t.matrixQ());
  return s;
}

int negative_in_sturm_sequence(const Matrix& A) {
  if (A.rows() == 0) return 0;
  const Tridiagonal t(A);
  const Vector d = t.diagonal(), e = t.subDiagonal();
  const double tiny = std::numeric_limits<double>::min() + 1e-18 * d.cwiseAbs().maxCoeff();
  int count = 0;
  double pivot = 1.0;
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    pivot = d[i] - (i == 0 ? 0.0 : e[i - 1] * e[i - 1] / pivot);
    if (std::abs(pivot) < tiny) pivot = -tiny;
    if (pivot < 0.0) ++count;
  }
  return count;
}

}  // namespace

PencilModes lowest_modes(const Matrix& K, const Matrix& M, int count, bool vectors, int spare) {
  if (K.rows() != K.cols() || M.rows() != M.cols() || K.rows() != M.rows()) throw std::invalid_argument("K and M must be square, of one size");
  if (count < 0) throw std::invalid_argument("the number of modes must not be negative");
  const Eigen::LLT<Matrix> llt(K);
  if (llt.info() != Eigen::Success) throw std::invalid_argument("K is not positive definite");
  Matrix C = M;
  llt.matrixL().solveInPlace(C);
  C.transposeInPlace();
  llt.matrixL().solveInPlace(C);
  const Eigen::Index wanted = std::min<Eigen::Index>(count, C.rows()), listed = std::min<Eigen::Index>(wanted + spare, C.rows());
  Spectrum s = largest_of(C, wanted, vectors);
  PencilModes modes{Vector(listed), std::move(s.z)};
  for (Eigen::Index i = 0; i < listed; ++i) modes.omega[i] = s.mu[i] > 0.0 ? 1.0 / std::sqrt(s.mu[i]) : std::numeric_limits<double>::infinity();
  if (!vectors) return modes;
  llt.matrixU().solveInPlace(modes.vectors);
  for (Eigen::Index i = 0; i < wanted; ++i)
    if (std::isfinite(modes.omega[i])) modes.vectors.col(i) *= modes.omega[i];
  return modes;
}

int negative_eigenvalues(const Matrix& A, Eigen::Index stiff) {
  if (A.rows() != A.cols()) throw std::invalid_argument("a matrix with an inertia is square");
  if (stiff <= 0 || stiff >= A.rows()) return negative_in_sturm_sequence(A);
  const auto rest = A.rows() - stiff;
  const Eigen::LLT<Matrix> llt(A.topLeftCorner(stiff, stiff));
  if (llt.info() != Eigen::Success) return negative_in_sturm_sequence(A);
  const Matrix half = llt.matrixL().solve(A.topRightCorner(stiff, rest));
  Matrix S = A.bottomRightCorner(rest, rest);
  S.noalias() -= half.transpose() * half;
  return negative_in_sturm_sequence(S);
}

}  // namespace whirl
