#include "models/catenary/resolution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/catenary/modes.hpp"

namespace whirl::models::catenary {
namespace {

struct Waves {
  double travel_time;  // of transverse and longitudinal waves, one after the other
  double densest;      // K at w = 1
  double growth;
};

Waves waves_on(const CoreCable& c) {
  const Coordinate map(c.x1, c.x2);
  constexpr int samples = 48;
  const double s = std::sqrt(c.kappa), step = (c.x2 - c.x1) / samples;
  Waves waves{0.0, 0.0, map.growth()};
  for (int i = 0; i < samples; ++i) {
    const double x = c.x1 + (i + 0.5) * step, t = map.t(x), across = std::sqrt(std::cosh(x)), along = s * std::cosh(x);
    waves.travel_time += (across + along) * step;
    waves.densest = std::max(waves.densest, std::max(across, along) * map.slope(x) * std::sqrt(1.0 - t * t));
  }
  return waves;
}

// Fitted to where the last coefficients fall below 1e-9: 1 to 100 modes, ends up to x = 14, stiff and soft. u = 1/ln rho: 0 taut, 2.3 at x = +-14.
int degree(double densest, double growth) {
  const double u = 1.0 / std::log(growth), u2 = u * u;
  return 2 + static_cast<int>(std::max(1.0 + 30.0 * u, 10.0 + densest + (5.2 + 9.5 * u2 / (1.0 + u2)) * std::cbrt(densest)));
}

}  // namespace

int functions_for(const CoreCable& c, int modes) {
  const Waves w = waves_on(c);
  return degree(std::numbers::pi * modes / w.travel_time * w.densest, w.growth);
}

namespace {

constexpr double most_waves = 1000.0;  // in K

double largest_drag(const CoreCable& c) { return std::max({c.eta1, c.eta2, c.eta3}); }

}  // namespace

// |L| = |-w^2 + i eta w| stands in place of w^2.
int functions_up_to(const CoreCable& c, double omega) {
  if (!(omega >= 0.0 && std::isfinite(omega))) throw std::invalid_argument(fmt::format("a frequency must be >= 0, got {:g}", omega));
  const Waves w = waves_on(c);
  const double densest = std::sqrt(omega * std::hypot(omega, largest_drag(c))) * w.densest;
  if (!(densest < most_waves)) throw std::invalid_argument(fmt::format("the frequency {:g} sqrt(g/a) has too many waves along the cable", omega));
  return degree(densest, w.growth);
}

double highest_frequency(const CoreCable& c) {
  const double square = std::pow(most_waves / waves_on(c).densest, 2), drag2 = std::pow(largest_drag(c), 2);  // w^2 (w^2 + drag^2) = square^2
  return square * std::sqrt(2.0 / (drag2 + std::hypot(drag2, 2.0 * square)));
}

}  // namespace whirl::models::catenary
