#pragma once
/// The sizes of x that a problem has of its own: where its residual departs from its linear part by as much as that part is.
///
///     |r_i(u + s e_i) - r_i(u) - s A_ii| = s |A_ii|,   A_ii the entry of r_x that is largest over the range of p
///
/// (of another row where A_ii = 0). At rest x says nothing of its own size, and lengths, steps and tolerances must not depend on the units in which x
/// is written: x_i -> a_i x_i gives a_i times the size, whatever the units of p and of time.

#include "core/problem.hpp"

namespace whirl::continuation {

/// At u = (x, p), the last parameter in [lower, upper], of each coordinate; 1 where the problem is linear along it, or not finite nearby.
Vector natural_sizes(const Problem& f, In u, double lower, double upper);

/// The least of some coordinates or, where it is linear along each of them, along a direction of them all; 1 where the problem is linear.
double natural_size(const Problem& f, In u, double lower, double upper);

}  // namespace whirl::continuation
