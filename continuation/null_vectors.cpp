#include "continuation/null_vectors.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace whirl::continuation {

void null_vectors(const Matrix& a, Vector& v, Vector& w) {
  const auto n = a.rows();
  if (n <= 8) {
    const Eigen::JacobiSVD<Matrix> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
    v = svd.matrixV().col(n - 1);
    w = svd.matrixU().col(n - 1);
    return;
  }
  // Starts with no symmetry that a null vector could be orthogonal to.
  v.resize(n);
  w.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    v[i] = std::sin(1.0 + 1.3 * static_cast<double>(i));
    w[i] = std::cos(2.0 + 0.7 * static_cast<double>(i));
  }
  v.normalize();
  w.normalize();
  const double size = a.norm() / std::sqrt(static_cast<double>(n));
  Matrix m(n + 1, n + 1);
  Eigen::PartialPivLU<Matrix> lu(n + 1);
  const Vector e = Vector::Unit(n + 1, n);
  for (int round = 0; round < 3; ++round) {
    m << a, size * w, size * v.transpose(), 0.0;
    lu.compute(m);
    const Vector right = lu.solve(e), left = lu.transpose().solve(e);
    if (!right.allFinite() || !left.allFinite()) return;
    v = right.head(n).normalized();
    w = left.head(n).normalized();
  }
}

}  // namespace whirl::continuation
