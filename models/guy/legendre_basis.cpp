#include "models/guy/legendre_basis.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace whirl::models::guy {

LegendreBasis::LegendreBasis(int degree, const Eigen::VectorXd& x) : value(x.size(), degree), slope(x.size(), degree) {
  if (degree < 1) throw std::invalid_argument(fmt::format("Legendre basis: degree must be >= 1, got {}", degree));
  value.col(0) = (0.5 * (1.0 + x.array())).matrix();
  slope.col(0).setConstant(0.5);
  if (degree == 1) return;
  const Matrix p = legendre_values(x, degree + 1);
  value.rightCols(degree - 1) = -dirichlet_values(p, degree - 1);
  slope.rightCols(degree - 1) = -dirichlet_slopes(p, degree - 1);
}

}  // namespace whirl::models::guy
