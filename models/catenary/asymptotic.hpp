#pragma once
/// Frequencies in plane of a level inextensible cable for short waves: the asymptotic solution of the fourth-order equation of the core system, the
/// way of [SaxonCahn1953], derived here to the second order (their own formula is not used).
///
/// Two motions are waves, U ~ c^(-7/4) exp(+-i phase), two are slow, on which the tension alone acts (alpha is the angle of the tangent):
///
///     phase(x) = w int_0^x sqrt(c) dx - (1/w) int_0^x (12 - 29 s^2)/(32 c^(5/2)) dx,      V = c U_x
///     slow: T = w^2 c (A + B alpha),   U = -[s (A + B alpha) + B]/c,   V = -(A + B alpha)/c
///
/// With U = V = 0 at x = m, c = cosh m, s = sinh m, alpha = gd(m):
///
///     symmetric      tan phase =  s c phase' / (1 + 7 s^2/4)
///     antisymmetric  tan phase = -(7 s/4 + alpha/(1 + s alpha)) / (c phase')
///
/// As m -> 0 these are tan(wm) = wm and sin(wm) = 0. The frequency of mode n is off by its n^-4; deep cables begin late: at b/2a = 1.5 the first is 2
/// % too high and the fifth right to 1e-4.
///
///     std::optional<double> w = asymptotic_frequency(1.0, 3);      // b/2a, mode; sqrt(g/a)
///
/// Empty where the formula has no such root (deep cables, low modes). Throws std::invalid_argument for m <= 0 or mode < 1.

#include <optional>

namespace whirl::models::catenary {

std::optional<double> asymptotic_frequency(double half_width, int mode);

}  // namespace whirl::models::catenary
