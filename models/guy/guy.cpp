#include "models/guy/guy.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace whirl::models::guy {
namespace {

constexpr double largest_own_strain = 0.05;  // by the weight of a guy hung upright; with tension on top the limit is that of the statics

void require_positive(const char* name, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) throw std::invalid_argument(fmt::format("guy: {} must be > 0, got {:g}", name, value));
}

}  // namespace

double Guy::chord() const { return std::hypot(horizontal_span, rise); }

double Guy::taut_modulus() const {
  const double c = chord_cosine();
  return axial_stiffness * c * c / chord();
}

void Guy::validate() const {
  require_positive("horizontal_span", horizontal_span);
  require_positive("axial_stiffness", axial_stiffness);
  require_positive("mass_per_length", mass_per_length);
  require_positive("gravity", gravity);
  if (!std::isfinite(rise)) throw std::invalid_argument(fmt::format("guy: rise must be a number, got {:g}", rise));
  const double strain = weight() * chord() / axial_stiffness;
  if (strain > largest_own_strain)
    throw std::invalid_argument(fmt::format("guy: its own weight would strain it by {:.3g} %; axial_stiffness is too small", 100.0 * strain));
}

Guy with_ice(Guy guy, double ice_mass_per_length) {
  if (!(ice_mass_per_length >= 0.0)) throw std::invalid_argument(fmt::format("guy: mass of ice must be >= 0, got {:g}", ice_mass_per_length));
  guy.mass_per_length += ice_mass_per_length;
  return guy;
}

double heated_length(double unstressed_length, double temperature_change, double expansion) {
  const double factor = 1.0 + expansion * temperature_change;
  if (!(factor > 0.9 && factor < 1.1))
    throw std::invalid_argument(fmt::format("guy: a temperature change of {:g} K at {:g} /K is not physical", temperature_change, expansion));
  return unstressed_length * factor;
}

}  // namespace whirl::models::guy
