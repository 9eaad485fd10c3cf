#pragma once
/// Normal-form coefficients of special points, from exact second and third derivatives, [Kuznetsov2004, secs 3.4, 5.4, 7.4].
///
///     fold        a' = beta + c a^2,      c = (1/2) w' B(v, v),                                     w'v = 1, |v| = 1
///     pitchfork   a' = beta a + c a^3,    c = (1/6) w' C(v, v, v) + (1/2) w' B(v, h),   A h = -B(v, v)        c < 0: supercritical
///     Hopf        l1 = Re[ p* C(q, q, q~) - 2 p* B(q, A^-1 B(q, q~)) + p* B(q~, (2 i w - A)^-1 B(q, q)) ] / (2 w)      < 0: supercritical
///
/// Of a periodic motion r is no flow: disturbances e^{lambda t} v obey (A + lambda C + lambda^2) v = 0 (orbit_problem.hpp), so that w'v = 1 becomes
/// -w'C v = 1 and the coefficients are again those of a' on the centre manifold. A period doubling gets the pitchfork's in the doubled problem.
///
/// A = r_x, B and C its second and third derivatives in x. v and q have unit length, so numbers depend on the units of x.

#include <functional>

#include "continuation/branch.hpp"

namespace whirl::continuation {

inline constexpr const char* zero_hopf_subtype = "ZH";  ///< of a Hopf point where an eigenvalue is zero as well: it has no coefficient

/// Sets point.coefficient (and null vectors of a Hopf point) where the problem offers third derivatives and the type has a coefficient.
/// A branch point is a pitchfork where it breaks a reflection or its subtype says "PF" (without either: where w' B(v, v) = 0), else it gets the
/// transcritical (1/2) w' B(v, v).
/// The sign of a quadratic coefficient goes with the sense of v: along `sense` if it is given, else along the branch's tangent at the point.
void set_normal_form(const Problem& f, SpecialPoint& point, const Vector& sense = {});

/// What w'v is to a flow: of periodic motions -w'C v, u with all parameters of f.
double mass(const Problem& f, In u, const Vector& v, const Vector& w);
using Mass = std::function<double(const Vector& v, const Vector& w)>;
/// The same with the mass given, where f is not itself the problem that knows it.
void set_normal_form(const Problem& f, SpecialPoint& point, const Vector& sense, const Mass& mass);

/// "supercritical" or "subcritical" for a pitchfork or a Hopf point with a coefficient, else "".
std::string criticality(const SpecialPoint& point);

}  // namespace whirl::continuation
