#include "models/catenary/asymptotic.hpp"

#include <fmt/format.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numbers>

#include "models/catenary/mesh.hpp"

namespace whirl::models::catenary {
namespace {

constexpr double pi = std::numbers::pi;

double correction(double s, double c) { return (12.0 - 29.0 * s * s) / (32.0 * c * c * std::sqrt(c)); }

}  // namespace

std::optional<double> asymptotic_frequency(double m, int mode) {
  if (!(m > 0.0 && std::isfinite(m))) throw std::invalid_argument(fmt::format("b/2a must be > 0, got {:g}", m));
  if (mode < 1) throw std::invalid_argument(fmt::format("modes are numbered from 1, got {}", mode));
  const Mesh mesh(-m, m, 40);
  const Eigen::ArrayXd slope = mesh.x.array().sinh();
  double time = 0.5 * mesh.weight.dot(mesh.c.cwiseSqrt()), late = 0.0;  // the two integrals to x = m
  for (Eigen::Index i = 0; i < mesh.x.size(); ++i) late += 0.5 * mesh.weight[i] * correction(slope[i], mesh.c[i]);
  const double c = std::cosh(m), s = std::sinh(m), alpha = 2.0 * std::atan(std::tanh(0.5 * m));
  const double turns = pi * ((mode + 1) / 2);
  const auto excess = [&](double w) {
    const double phase = w * time - late / w, rate = w * std::sqrt(c) - correction(s, c) / w;
    if (mode % 2 == 0) return phase - turns - std::atan2(s * c * rate, 1.0 + 1.75 * s * s);
    return phase - turns + std::atan2(1.75 * s + alpha / (1.0 + s * alpha), c * rate);
  };
  // Upwards from where the phase begins to grow with w.
  const double lower = late < 0.0 ? std::sqrt(-late / time) : 1e-3 / time, upper = (turns + pi + std::abs(late) * time) / time;
  const double at_lower = excess(lower), at_upper = excess(upper);
  if (!(at_lower < 0.0 && at_upper > 0.0)) return std::nullopt;
  std::uintmax_t steps = 100;
  const auto root = boost::math::tools::toms748_solve(excess, lower, upper, at_lower, at_upper, boost::math::tools::eps_tolerance<double>(50), steps);
  return 0.5 * (root.first + root.second);
}

}  // namespace whirl::models::catenary
