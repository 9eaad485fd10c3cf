#include "models/shallow/statics.hpp"

#include <fmt/format.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "models/shallow/modes.hpp"

namespace whirl::models::shallow {
namespace {

template <class F>
double root(F&& f, double a, double b) {
  const double fa = f(a), fb = f(b);
  if (fa == 0.0) return a;
  if (fb == 0.0) return b;
  boost::uintmax_t iterations = 300;
  const auto [lo, hi] = boost::math::tools::toms748_solve(f, a, b, fa, fb, boost::math::tools::eps_tolerance<double>(52), iterations);
  return 0.5 * (lo + hi);
}

double weight_across_chord(const Cable<double>& c) { return c.mass_per_length * c.gravity * std::cos(c.inclination_deg * std::numbers::pi / 180.0); }

// Arc length of the parabola over the chord length, less 1: 8 r^2/3 - 32 r^4/5 + ..., without cancellation.
double excess_length(double r) {
  const double z = 4.0 * r;
  if (std::abs(z) < 0.05) {
    const double q = z * z;
    return q * (1.0 / 6.0 - q * (1.0 / 40.0 - q * (1.0 / 112.0 - q * (5.0 / 1152.0 - q * 7.0 / 2816.0))));
  }
  return 0.5 * (std::sqrt(1.0 + z * z) + std::asinh(z) / z) - 1.0;
}

double excess_unstressed(const Cable<double>& c) {
  const double r = weight_across_chord(c) * c.chord_length / (8.0 * c.chord_tension);
  return excess_length(r) - c.chord_tension / c.axial_stiffness * (1.0 + 16.0 / 3.0 * r * r);
}

// Every sign change of f on a logarithmic grid of tensions.
template <class F>
std::vector<double> roots_over_tensions(F&& f, double lowest, double highest, int steps) {
  std::vector<double> found;
  double a = lowest, fa = f(a);
  for (int i = 1; i <= steps; ++i) {
    const double b = lowest * std::pow(highest / lowest, static_cast<double>(i) / steps), fb = f(b);
    if (fa * fb <= 0.0 && fb != 0.0) found.push_back(root(f, a, b));
    a = b;
    fa = fb;
  }
  return found;
}

void require_positive(const char* name, double x) {
  if (!(x > 0.0) || !std::isfinite(x)) throw std::invalid_argument(fmt::format("{} must be a number > 0, got {}", name, x));
}

}  // namespace

Statics statics(const Cable<double>& c) {
  for (const auto& [name, x] : {std::pair{"chord_length", c.chord_length},
                                {"chord_tension", c.chord_tension},
                                {"mass_per_length", c.mass_per_length},
                                {"axial_stiffness", c.axial_stiffness}})
    require_positive(name, x);
  const double l = c.chord_length, d = weight_across_chord(c) * l * l / (8.0 * c.chord_tension), r = d / l;
  if (!(std::abs(r) <= steepest_sag_ratio))
    throw std::invalid_argument(fmt::format("the sag ratio {:.4g} is beyond the shallow cable's range, at most {}", r, steepest_sag_ratio));
  const double Le = l * (1.0 + 8.0 * r * r);
  return {d, r, Le, 64.0 * r * r * l * c.axial_stiffness / (c.chord_tension * Le), l * (1.0 + excess_length(r)), l * (1.0 + excess_unstressed(c))};
}

ElasticCorrection elastic_correction(double lambda2) {
  if (!(lambda2 >= 0.0)) throw std::invalid_argument(fmt::format("lambda2 must be >= 0, got {}", lambda2));
  if (lambda2 == 0.0) return {1.0, std::numeric_limits<double>::infinity()};
  const double a = lambda2 / 24.0;
  // x = H*, y = 1 - x: (1 - x)^3 = a x (2 - x) is y^3 = a (1 - y^2); each is solved for itself, so neither loses digits.
  const double x = root([a](double s) { return (1.0 - s) * (1.0 - s) * (1.0 - s) / (1.0 + a) - a / (1.0 + a) * s * (2.0 - s); }, 0.0, 1.0);
  const double y = root([a](double s) { return s * s * s / (1.0 + a) - a / (1.0 + a) * (1.0 - s) * (1.0 + s); }, 0.0, 1.0);
  return {x, x / y};
}

ElasticCorrection elastic_correction_large(double lambda2) { return {1.0 / (3.0 + lambda2 / 12.0), 1.0 / (2.0 + lambda2 / 12.0)}; }

ElasticCorrection elastic_correction_small(double lambda2) {
  const double y = std::cbrt(lambda2 / 24.0);
  return {1.0 - y, 1.0 / y};
}

std::vector<double> tensions(const Cable<double>& cable, Given given, double value) {
  Cable<double> c = cable;
  c.chord_tension = 1.0;
  for (const auto& [name, x] : {std::pair{"chord_length", c.chord_length},
                                {"mass_per_length", c.mass_per_length},
                                {"axial_stiffness", c.axial_stiffness},
                                {"the number given", value}})
    require_positive(name, x);
  const double l = c.chord_length, across = weight_across_chord(c);
  const double lowest = across * l / (8.0 * steepest_sag_ratio), highest = 0.5 * c.axial_stiffness;
  std::vector<double> found;
  switch (given) {
    case Given::chord_tension:
      found = {value};
      break;
    case Given::sag:
      found = {across * l * l / (8.0 * value)};
      break;
    case Given::first_frequency:
      found = {4.0 * c.mass_per_length * value * value * l * l};
      break;
    case Given::unstressed_length: {
      const double excess = value / l - 1.0;
      found = roots_over_tensions(
          [&](double T) {
            c.chord_tension = T;
            return excess_unstressed(c) - excess;
          },
          std::max(lowest, 1e-9 * highest), highest, 1);  // falls as the tension rises
      break;
    }
    case Given::first_in_plane_frequency:
      found = roots_over_tensions(
          [&](double T) {
            c.chord_tension = T;
            return std::log(symmetric_root(statics(c).lambda2, 1) / (2.0 * std::numbers::pi * l) * std::sqrt(T / c.mass_per_length) / value);
          },
          std::max(lowest * (1.0 + 1e-12), 1e-9 * highest), highest, 400);
      break;
  }
  std::erase_if(found, [&](double T) { return !(T >= lowest * (1.0 - 1e-12)) || !(T > 0.0); });
  return found;
}

Cable<double> complete(Cable<double> cable, Given given, double value) {
  const auto found = tensions(cable, given, value);
  if (found.empty()) throw std::invalid_argument(fmt::format("no tension with a sag ratio of at most {} gives {}", steepest_sag_ratio, value));
  cable.chord_tension = found.back();
  return cable;
}

}  // namespace whirl::models::shallow
