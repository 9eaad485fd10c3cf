#pragma once
// The guys of [Sarvi1968] in SI: the top guy of the Oklahoma City tower (p. 9) and Davenport's guy (p. 107), g = 32.174 ft/s^2.
#include <cmath>
#include <numbers>

#include "models/guy/statics.hpp"

namespace guy_cases {

inline constexpr double foot = 0.3048, pound = 4.4482216152605, inch = 0.0254;
inline constexpr double pound_per_foot = pound / foot, kip_per_foot = 1000.0 * pound_per_foot;

inline whirl::models::guy::Guy guy_in_us_units(double area_in2, double modulus_psi, double w_lb_ft, double l_ft, double h_ft) {
  const double g = 32.174 * foot;
  return {.horizontal_span = l_ft * foot,
          .rise = h_ft * foot,
          .axial_stiffness = area_in2 * modulus_psi * pound,
          .mass_per_length = w_lb_ft * pound_per_foot / g,
          .gravity = g};
}

inline whirl::models::guy::Guy oklahoma() { return guy_in_us_units(2.42, 24e6, 9.0, 950.0, 1349.0); }
inline whirl::models::guy::Statics oklahoma_rest(whirl::models::guy::Form form = whirl::models::guy::Form::exact) {
  return whirl::models::guy::at_horizontal_tension(oklahoma(), 35300.0 * pound, form);
}

inline whirl::models::guy::Guy davenport() {
  const double angle = 46.0 * std::numbers::pi / 180.0;
  return guy_in_us_units(0.6, 20e6, 1.9, 125.0 * std::cos(angle), 125.0 * std::sin(angle));
}
inline whirl::models::guy::Statics davenport_rest(whirl::models::guy::Form form = whirl::models::guy::Form::exact) {
  return whirl::models::guy::at_horizontal_tension(davenport(), 12000.0 * pound * std::cos(46.0 * std::numbers::pi / 180.0), form);
}

}  // namespace guy_cases
