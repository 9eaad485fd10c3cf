#include "core/symmetric_pencil.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace whirl {

PencilModes lowest_modes(const Matrix& K, const Matrix& M, int count, bool vectors) {
  if (K.rows() != K.cols() || M.rows() != M.cols() || K.rows() != M.rows()) throw std::invalid_argument("K and M must be square, of one size");
  if (count < 0) throw std::invalid_argument("the number of modes must not be negative");
  const Eigen::LLT<Matrix> llt(K);
  if (llt.info() != Eigen::Success) throw std::invalid_argument("K is not positive definite");
  Matrix C = M;
  llt.matrixL().solveInPlace(C);
  C.transposeInPlace();
  llt.matrixL().solveInPlace(C);
  C = 0.5 * (C + C.transpose()).eval();
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(C, vectors ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly);
  const auto n = C.rows();
  const Eigen::Index wanted = std::min<Eigen::Index>(count, n);
  PencilModes modes{Vector(wanted), Matrix()};
  for (Eigen::Index i = 0; i < wanted; ++i) {
    const double mu = solver.eigenvalues()[n - 1 - i];
    modes.omega[i] = mu > 0.0 ? 1.0 / std::sqrt(mu) : std::numeric_limits<double>::infinity();
  }
  if (!vectors) return modes;
  modes.vectors = solver.eigenvectors().rightCols(wanted).rowwise().reverse();
  llt.matrixU().solveInPlace(modes.vectors);
  for (Eigen::Index i = 0; i < wanted; ++i)
    if (std::isfinite(modes.omega[i])) modes.vectors.col(i) *= modes.omega[i];
  return modes;
}

int negative_eigenvalues(const Matrix& A) {
  const Eigen::Tridiagonalization<Matrix> t(A);
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

}  // namespace whirl
