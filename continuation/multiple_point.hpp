#pragma once
/// A point where two or more eigenvalues of r_x are zero at once, as symmetries ask for. A = r_x has a kernel of dimension d there:
///
///     r(x, p) = 0,  G(x, p) = 0      [ A   B ] [V]   [0]      dG = -W' D2r[V, .],   [W' G] [ A   B ] = [0 I]
///                                    [ C'  0 ] [G] = [I]                                   [ C'  0 ]
///
/// n + d^2 equations in n + 1 unknowns that agree at the point: Gauss-Newton with steps of least norm. What the symmetry leaves open (x along the
/// kernel, where second derivatives vanish) stays as it is.

#include <optional>

#include "core/problem.hpp"

namespace whirl::continuation {

/// Up to so many coordinates every branch point is asked whether it is one; in larger problems only where a search has come to its end.
inline constexpr int always_asked = 8;

struct MultiplePoint {
  Vector u;         ///< (x, p), size n + 1
  int dimension;    ///< d, of the kernel of r_x
  double residual;  ///< largest entry of r and G
};

/// Nothing if fewer than two eigenvalues are near zero at u, or if they do not vanish at one point near it. `f` has second derivatives; x_scale and
/// p_scale are the sizes of x and p that it is solved in.
[[nodiscard]] std::optional<MultiplePoint> multiple_point_near(const Problem& f, In u, double x_scale = 1.0, double p_scale = 1.0);

/// Usual size of [r_x r_p] a hundredth about u, where at u itself all of it may vanish; 0 if none can be computed. x and p are of order one.
[[nodiscard]] double usual_jacobian(const Problem& f, In u);

}  // namespace whirl::continuation
