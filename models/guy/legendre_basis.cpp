#include "models/guy/legendre_basis.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace whirl::models::guy {
namespace {

// P_n(x) and P_{n-1}(x) by the three-term recurrence.
std::pair<double, double> legendre_pair(int n, double x) {
  double before = 0.0, now = 1.0;
  for (int j = 0; j < n; ++j) before = std::exchange(now, ((2.0 * j + 1.0) * x * now - j * before) / (j + 1.0));
  return {now, before};
}

}  // namespace

GaussRule gauss_legendre(int points) {
  if (points < 1) throw std::invalid_argument(fmt::format("Gauss rule: points must be >= 1, got {}", points));
  GaussRule rule{Eigen::VectorXd(points), Eigen::VectorXd(points)};
  for (int i = 0; i < (points + 1) / 2; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (points + 0.5)), slope = 0.0;
    for (int sweep = 0; sweep < 10; ++sweep) {  // Newton from Tricomi's estimate: 3 sweeps reach rounding
      const auto [p, q] = legendre_pair(points, x);
      slope = points * (q - x * p) / (1.0 - x * x);
      const double step = p / slope;
      x -= step;
      if (std::abs(step) < 1e-15) break;
    }
    rule.nodes[points - 1 - i] = x;
    rule.nodes[i] = -x;
    rule.weights[i] = rule.weights[points - 1 - i] = 2.0 / ((1.0 - x * x) * slope * slope);
  }
  if (points % 2 == 1) rule.nodes[points / 2] = 0.0;
  return rule;
}

LegendreBasis::LegendreBasis(int degree, const Eigen::VectorXd& x) : value(x.size(), degree), slope(x.size(), degree) {
  if (degree < 1) throw std::invalid_argument(fmt::format("Legendre basis: degree must be >= 1, got {}", degree));
  value.col(0) = (0.5 * (1.0 + x.array())).matrix();
  slope.col(0).setConstant(0.5);
  Eigen::ArrayXd before = Eigen::ArrayXd::Ones(x.size()), now = x.array();  // P_{j-1}, P_j
  for (int j = 1; j < degree; ++j) {
    const Eigen::ArrayXd after = ((2.0 * j + 1.0) * x.array() * now - j * before) / (j + 1.0);
    value.col(j) = ((after - before) / std::sqrt(2.0 * (2.0 * j + 1.0))).matrix();
    slope.col(j) = (std::sqrt(0.5 * (2.0 * j + 1.0)) * now).matrix();
    before = now;
    now = after;
  }
}

}  // namespace whirl::models::guy
