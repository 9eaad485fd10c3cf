#pragma once
/// Statics of a shallow elastic cable, [IrvineCaughey1974, eqs (2), (26)-(33)], in chord axes (an inclined chord sees g cos(theta)).
///
///     profile  y = 4 d xi (1 - xi),  d = m g cos(theta) l^2 / (8 T)                                                     (2)
///     Le/l = 1 + 8 r^2,  r = d/l;  lambda2 = (8 r)^2 l EA / (T Le)                                                       (19)
///     length along the arc: exact for the parabola; unstressed length = arc - (T l/EA)(1 + 16 r^2/3), strain to first order
///
/// A cable cut to the length of the inextensible sag d and hung stretches: tension falls by the fraction H*, sag grows by d* = H*/(1 - H*),
///
///     (1 - H*)^3 = (lambda2/24)(2 H* - H*^2);     lambda2 large: H* = 1/(3 + lambda2/12), d* = 1/(2 + lambda2/12)        (31)(32)
///     lambda2 small: H* = 1 - (lambda2/24)^(1/3)                                       (33; the print has the ratio upside down)
///
///     Cable<double> c = complete(cable, Given::sag, 2.08);        // any one of four numbers; chord_tension is filled in
///     statics(c).lambda2;
///
/// Lengths in m, forces in N. Throws std::invalid_argument, one line, for numbers out of range and for values that no tension gives.

#include <vector>

#include "models/parameters.hpp"

namespace whirl::models::shallow {

inline constexpr double steepest_sag_ratio = 0.125;  ///< the source's range; its frequencies are up to 6 % high there

struct Statics {
  double sag, sag_ratio;    ///< d [m], r = d/l
  double effective_length;  ///< Le [m], of the stretching
  double lambda2;           ///< with Le/l = 1 + 8 r^2
  double arc_length;        ///< under tension [m]
  double unstressed_length;
};
Statics statics(const Cable<double>& cable);

/// H* of (31) and d* = H*/(1 - H*), each to full relative precision. lambda2 >= 0, here of the inextensible cable.
struct ElasticCorrection {
  double tension_drop, sag_increase;
};
ElasticCorrection elastic_correction(double lambda2);
ElasticCorrection elastic_correction_large(double lambda2);  ///< (32)
ElasticCorrection elastic_correction_small(double lambda2);  ///< (33)

/// What is known instead of the tension.
enum class Given {
  chord_tension,            ///< [N]
  sag,                      ///< [m]
  unstressed_length,        ///< [m]
  first_frequency,          ///< [Hz], the lowest: out of plane
  first_in_plane_frequency  ///< [Hz], first symmetric in plane: up to three tensions have it
};

/// All tensions, rising, whose sag ratio is at most `steepest_sag_ratio`. `cable.chord_tension` is not looked at.
std::vector<double> tensions(const Cable<double>& cable, Given given, double value);
/// The cable with the highest of them.
Cable<double> complete(Cable<double> cable, Given given, double value);

}  // namespace whirl::models::shallow
