#pragma once
/// Static equilibrium of a guy, in two named forms.
///
/// `exact`: elastic catenary, weight w per unstretched length, W = w L0, s0 = V/H, s1 = (V + W)/H,
///
///     l = H L0/AE + (H/w)(asinh s1 - asinh s0),   h = (L0/AE)(V + W/2) + (H/w)(sqrt(1 + s1^2) - sqrt(1 + s0^2))
///
/// `first_order`: inextensible catenary, weight per stretched length, stretched to first order, r = w l / 2H,
///
///     L^2 = h^2 + (l sinh r / r)^2                                                     [Sarvi1968, eq. (2.8)]
///     L0 = L - (H l / 2AE)[1 + sinh 2r / 2r + 2 (h/l)^2 r / tanh r]                    [Sarvi1968, eq. (2.11), with (2.10a)'s second E struck]
///
/// Any one of horizontal tension, sag, unstressed length, tension at an end or first transverse frequency may be known; `solve` finds the rest in
/// log H. A tension or a frequency has two solutions, taut and slack: the taut one is meant. Refused with std::invalid_argument: what no guy of this
/// geometry can have (too short a length, a tension below the least its weight allows), and strains above `largest_strain`.
///
///     const Statics rest = solve(guy, Known::horizontal_tension, 157023.0);
///     const Statics iced = solve(with_ice(guy, 4.0), Known::unstressed_length, rest.unstressed_length);

#include <string_view>

#include "models/guy/guy.hpp"

namespace whirl::models::guy {

enum class Form { exact, first_order };
enum class Known { horizontal_tension, unstressed_length, sag, lower_tension, upper_tension, first_frequency };

std::string_view to_string(Form form);
std::string_view to_string(Known known);

inline constexpr double largest_strain = 0.1;  ///< of the upper end; Hooke's law is not meant beyond: heavy ropes of 5 % on average are within

struct Statics {
  Guy guy;
  Form form = Form::exact;
  double horizontal_tension = 0.0;  ///< H [N]
  double vertical_tension = 0.0;    ///< V, vertical force at the lower end, upwards along the guy [N]
  double unstressed_length = 0.0;   ///< L0 [m]
  double length = 0.0;              ///< L, stretched [m]
  double sag = 0.0;                 ///< largest distance from the chord, normal to it [m]
  double lower_tension = 0.0;       ///< T0 [N]
  double upper_tension = 0.0;       ///< TL [N]

  double r() const { return 0.5 * guy.weight() * guy.horizontal_span / horizontal_tension; }  ///< w l / 2H
  double mean_tension() const { return 0.5 * (lower_tension + upper_tension); }               ///< Tm [N]
  double irvine_lambda2() const;                                                              ///< (w Lc cos g / Tm)^2 AE / Tm with the mean tension
  double first_frequency() const;  ///< lowest transverse frequency, linear tension [Sarvi1968, eq. (5.66)] [rad/s]
};

[[nodiscard]] Statics at_horizontal_tension(const Guy& guy, double horizontal_tension, Form form = Form::exact);
[[nodiscard]] Statics solve(const Guy& guy, Known known, double value, Form form = Form::exact);

/// The quantity `known` of a state.
double value_of(const Statics& state, Known known);

/// Place of the static curve at unstretched (exact) or stretched (first-order) arc length s from the lower end.
struct CurvePoint {
  double x, y, tension, slope;  ///< [m], [m], [N], dy/dx
};
CurvePoint curve_at(const Statics& state, double s);

}  // namespace whirl::models::guy
