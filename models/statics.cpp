#include "models/statics.hpp"

#include <fmt/format.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <stdexcept>

namespace whirl::models {

double symmetric_root(double lambda2) {
  if (!(lambda2 >= 0.0)) throw std::invalid_argument(fmt::format("irvine_lambda2 must be >= 0, got {}", lambda2));
  if (lambda2 == 0.0) return pi;
  // One root x = W/2 in (pi/2, 3 pi/2); g > 0 at the left end and < 0 at the right.
  const auto g = [lambda2](double x) { return lambda2 * (std::sin(x) - x * std::cos(x)) + 4.0 * x * x * x * std::cos(x); };
  boost::uintmax_t iterations = 200;
  const auto [lo, hi] = boost::math::tools::toms748_solve(g, 0.5 * pi, 1.5 * pi, boost::math::tools::eps_tolerance<double>(52), iterations);
  return lo + hi;
}

std::vector<std::string> check(const Cable<double>& cable) {
  StayParameters<double> record{};
  record.cable = cable;
  fields(record, [](const Field& f, const double& value) {
    if (!f.name.starts_with("cable.")) return;
    if (std::isfinite(value) && (value > f.lower || (f.closed_lower && value == f.lower)) &&
        (value < f.upper || (f.closed_lower && value == f.upper)))
      return;
    throw std::invalid_argument(
        fmt::format("{} = {} is out of range: {} {} value < {} [{}]", f.name, value, f.lower, f.closed_lower ? "<=" : "<", f.upper, f.unit));
  });
  std::vector<std::string> warnings;
  const auto p = parabola(cable);
  const auto m = modes(cable);
  const double ratio = std::abs(p.sag_ratio);
  if (ratio > 0.08)
    throw std::invalid_argument(
        fmt::format("the sag ratio f/L = {:.4g} is beyond the parabola's range 0 <= f/L <= 0.08: raise cable.chord_tension", ratio));
  if (ratio > 0.02) warnings.push_back(fmt::format("sag ratio f/L = {:.4g} > 0.02: the two-mode model is meant for smaller sag", ratio));
  if (std::abs(m.omega2 / m.omega1 - 1.0) > 0.2)
    warnings.push_back(fmt::format("w1 = {:.4g} and w2 = {:.4g} rad/s differ by more than 20 %: the two-mode model is not meant for this cable",
                                   m.omega1, m.omega2));
  return warnings;
}

}  // namespace whirl::models
