#pragma once
/// Static parabola of a shallow cable and its two lowest modes, [NielsenKirkegaard2002, eqs (25)-(30)].
///
///     f = mu g cos(theta) L^2 / (8 T)                                   sag
///     lambda2 = (AE/T) 64 (f/L)^2 / (1 + (8/3)(f/L)^2)                   Irvine parameter; note 8/3, [IrvineCaughey1974] have 8
///     w1 = (pi/L) sqrt(T/mu),  phi1 = sin(pi xi)                         out of plane
///     w2 = (W/L) sqrt(T/mu),   phi2 = [cos(W/2 (1-2 xi)) - cos(W/2)] / (1 - cos(W/2))     in plane, symmetric
///     tan(W/2) = W/2 - (4/lambda2) (W/2)^3
///
/// Modes are 1 at midspan: modal coordinates are midspan displacements in metres. xi = x1/L.

#include <boost/math/constants/constants.hpp>
#include <string>
#include <vector>

#include "core/dual.hpp"
#include "core/quadrature.hpp"
#include "models/parameters.hpp"

namespace whirl::models {

inline constexpr double pi = boost::math::constants::pi<double>();

template <class S>
struct Parabola {
  S sag;             ///< f [m]
  S sag_ratio;       ///< f/L
  S irvine_lambda2;  ///< lambda^2
};

template <class S>
Parabola<S> parabola(const Cable<S>& c) {
  using std::cos;
  const S f = c.mass_per_length * c.gravity * cos(c.inclination_deg * (pi / 180.0)) * c.chord_length * c.chord_length / (c.chord_tension * 8.0);
  const S ratio = f / c.chord_length, r2 = ratio * ratio;
  return {f, ratio, c.axial_stiffness / c.chord_tension * 64.0 * r2 / (r2 * (8.0 / 3.0) + 1.0)};
}

/// Lowest positive root W of the symmetric frequency equation at lambda2 >= 0; pi for the taut string.
double symmetric_root(double lambda2);

/// The same with slopes: the root in double, then one Newton step in S.
template <class S>
S symmetric_root_in(const S& lambda2) {
  using std::cos;
  using std::sin;
  S x(0.5 * symmetric_root(value_of(lambda2)));
  // g = lambda2 (sin x - x cos x) + 4 x^3 cos x; one step a level of nesting keeps second and third slopes right
  for (int level = 0; level < 3; ++level) {
    const S s = sin(x), c = cos(x), x2 = x * x;
    const S g = lambda2 * (s - x * c) + x2 * x * c * 4.0;
    const S slope = lambda2 * x * s + x2 * (c * 12.0 - x * s * 4.0);
    x = x - g / slope;
  }
  return x * 2.0;
}

template <class S>
struct Modes {
  S frequency_number;   ///< W, w2 = (W/L) sqrt(T/mu)
  S omega1, omega2;     ///< [rad/s]
  S shape_denominator;  ///< 1 - cos(W/2)

  S phi1(double xi) const { return S(std::sin(pi * xi)); }
  S phi1_slope(double xi) const { return S(pi * std::cos(pi * xi)); }
  S phi2(double xi) const {
    using std::cos;
    const S half = frequency_number * 0.5;
    return (cos(half * (1.0 - 2.0 * xi)) - cos(half)) / shape_denominator;
  }
  S phi2_slope(double xi) const {
    using std::sin;
    return frequency_number * sin(frequency_number * (0.5 * (1.0 - 2.0 * xi))) / shape_denominator;
  }
};

template <class S>
Modes<S> modes(const Cable<S>& c) {
  using std::cos;
  using std::sqrt;
  const S wave = sqrt(c.chord_tension / c.mass_per_length) / c.chord_length;  // speed over length [1/s]
  const S W = symmetric_root_in(parabola(c).irvine_lambda2);
  return {W, wave * pi, wave * W, S(1.0) - cos(W * 0.5)};
}

/// Throws std::invalid_argument for a value out of range (naming it) and for f/L > 0.08; returns warnings where the model is stretched.
std::vector<std::string> check(const Cable<double>& cable);

}  // namespace whirl::models
