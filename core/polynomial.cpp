#include "core/polynomial.hpp"

#include <Eigen/Eigenvalues>

namespace whirl {

std::vector<std::complex<double>> polynomial_roots(std::vector<double> c) {
  while (!c.empty() && c.back() == 0.0) c.pop_back();
  const auto n = static_cast<Eigen::Index>(c.size()) - 1;
  if (n < 1) return {};
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  companion.diagonal(-1).setOnes();
  for (Eigen::Index i = 0; i < n; ++i) companion(i, n - 1) = -c[static_cast<std::size_t>(i)] / c.back();
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(companion, false);
  return {solver.eigenvalues().begin(), solver.eigenvalues().end()};
}

}  // namespace whirl
