#pragma once
/// Normal-form coefficients of special points, from exact second and third derivatives, [Kuznetsov2004, secs 3.4, 5.4, 7.4].
///
///     fold        a' = beta + c a^2,      c = (1/2) w' B(v, v),                                     w'v = 1, |v| = 1
///     pitchfork   a' = beta a + c a^3,    c = (1/6) w' C(v, v, v) + (1/2) w' B(v, h),   A h = -B(v, v)        c < 0: supercritical
///     Hopf        l1 = Re[ p* C(q, q, q~) - 2 p* B(q, A^-1 B(q, q~)) + p* B(q~, (2 i w - A)^-1 B(q, q)) ] / (2 w)      < 0: supercritical
///
/// Of a periodic motion (OrbitProblem) a pitchfork and a period doubling get the bend of the branch that leaves, s = -(coefficient) a^2 where s
/// counts towards the side on which the motion it leaves is less stable: < 0 supercritical too. a is the length of the disturbance's harmonics.
///
/// A = r_x, B and C its second and third derivatives in x. v and q have unit length, so numbers depend on the units of x.

#include "continuation/branch.hpp"

namespace whirl::continuation {

/// Sets point.coefficient (and null vectors of a Hopf point) where the problem offers third derivatives and the type has a coefficient.
/// A branch point is a pitchfork where it breaks a reflection or its subtype says "PF" (without either: where w' B(v, v) = 0), else it gets the
/// transcritical (1/2) w' B(v, v).
/// The sign of a quadratic coefficient goes with the sense of v: along `sense` if it is given, else along the branch's tangent at the point.
void set_normal_form(const Problem& f, SpecialPoint& point, const Vector& sense = {});

/// "supercritical" or "subcritical" for a pitchfork or a Hopf point with a coefficient, else "".
std::string criticality(const SpecialPoint& point);

}  // namespace whirl::continuation
