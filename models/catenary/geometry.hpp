#pragma once
/// Shape of an inextensible cable hung between two points: the common catenary, [Gale1976, sec. II.2 and III.1].
///
/// Lengths are measured from the apex (of the curve continued, where the cable does not reach it), x horizontal, in units of a = H/(mu g):
///
///     y = cosh x,  s = sinh x,  xi = sgn(x) (cosh x - 1),  static tension cosh x in units of H
///     m = b/2a,   x_m = asinh(h / (2 a sinh m)),   x_1,2 = x_m -+ m                                        [Gale1976, eq. (3.5)]
///     l = 2 a sinh m cosh x_m,   h = 2 a sinh m sinh x_m,   f = a cosh x_m (cosh m - 1) = (l/2) tanh(m/2)
///
/// b span, h >= 0 height of the upper end 2 above the lower end 1, l length, f sag: vertical distance from the chord to the cable at
/// half the span. Any three of b, h, l, f and a tension give the rest; of two cables with one tension at the upper end the taut one is meant.
/// Throws std::invalid_argument, one clear line, for a set that is not sufficient, not consistent or out of reach.
///
///     Geometry g = geometry({.span = 100.0, .height = 20.0, .length = 130.0});
///     Geometry k = geometry({.span = 100.0, .height = 20.0, .horizontal_tension = 5e3, .weight_per_length = 98.1});
///     double upper = 98.1 * g.a * std::cosh(g.x2);                                     // static tension at the upper end [N]

#include <optional>

namespace whirl::models::catenary {

struct GeometryInput {
  std::optional<double> span = {}, height = {};   ///< b > 0, h >= 0 [m]
  std::optional<double> length = {}, sag = {};    ///< l, f > 0 [m]
  std::optional<double> horizontal_tension = {};  ///< H > 0 [N]
  std::optional<double> upper_tension = {};       ///< static tension at the upper end [N]
  double weight_per_length = 0.0;                 ///< mu g [N/m], needed with a tension
};

struct Geometry {
  double span, height, length, sag;  ///< b, h, l, f [m]
  double a;                          ///< H/(mu g) [m]
  double m, x_m, x1, x2;             ///< half width, middle and ends in units of a

  double sag_parameter() const;      ///< b / sqrt(l^2 - h^2): 1 taut, 0 slack
  double depth_below_upper() const;  ///< of the lowest point of the cable [m]
  double effective_length() const;   ///< Le / a: integral of (ds/dx)^3
};

Geometry geometry(const GeometryInput& input);
/// a = 1: span 2 m, height 2 m h/b.
Geometry unit_geometry(double m, double height_over_span);

/// m from the sag parameter b / sqrt(l^2 - h^2) in (0, 1): m / sinh m.
double half_width_of(double sag_parameter);
/// m of the cable with given h/b whose upper end stands at xi; throws where none does.
double half_width_reaching(double xi, double height_over_span);
double xi_of(double x);

/// Widest cable the solvers take: cosh x spans 13 orders of magnitude beyond.
inline constexpr double largest_x = 15.0;

}  // namespace whirl::models::catenary
