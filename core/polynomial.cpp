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
  std::vector<std::complex<double>> roots(solver.eigenvalues().begin(), solver.eigenvalues().end());
  for (auto& z : roots) {  // eigenvalues of an unbalanced companion lose digits; Newton on the polynomial itself gives them back
    for (int i = 0; i < 3; ++i) {
      std::complex<double> f = 0.0, slope = 0.0;
      for (auto k = c.rbegin(); k != c.rend(); ++k) {
        slope = slope * z + f;
        f = f * z + *k;
      }
      const std::complex<double> step = f / slope;
      if (!(std::abs(step) < 1e-3 * std::abs(z))) break;
      z -= step;
    }
  }
  return roots;
}

}  // namespace whirl
