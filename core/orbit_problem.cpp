#include "core/orbit_problem.hpp"

namespace whirl {

// i kappa C - kappa^2 I
void OrbitProblem::do_characteristic(In u, double kappa, Eigen::MatrixXcd& shift, Eigen::MatrixXcd& by_kappa) const {
  const std::complex<double> i(0.0, 1.0);
  Matrix c(size(), size());
  velocity(u, c);
  shift = (i * kappa) * c;
  by_kappa = i * c;
  shift.diagonal().array() -= kappa * kappa;
  by_kappa.diagonal().array() -= 2.0 * kappa;
}

bool OrbitProblem::do_characteristic_slope(In u, double kappa, int i, Eigen::MatrixXcd& slope) const {
  if (i < size()) return false;
  Matrix c(size(), size());
  velocity_slope(u, i - size(), c);
  slope = std::complex<double>(0.0, kappa) * c;
  return true;
}

}  // namespace whirl
