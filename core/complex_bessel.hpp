#pragma once
/// Bessel functions J0, J1, Y0, Y1 of a complex argument with positive real part, as damped strings need them (Boost's are real only).
///
/// |x| < 25: backward recurrence, normalised by e^{-+ix} = J0 + 2 sum (-+i)^k J_k, and Neumann's series for Y0; above: Hankel's expansions. Relative
/// accuracy about 1e-13 of |J| + |Y|. Throws std::invalid_argument unless Re x > 0.
///
///     const CylinderFunctions f = cylinder_functions({12.3, -0.4});        // f.j0, f.j1, f.y0, f.y1

#include <complex>

namespace whirl {

struct CylinderFunctions {
  std::complex<double> j0, j1, y0, y1;
};

/// Hankel functions without their exponential: H1_n = first_n e^{ix}, H2_n = second_n e^{-ix}. Products of them at neighbouring large arguments need
/// only the difference of the arguments, which the caller knows better than we do.
struct ScaledHankel {
  std::complex<double> first_0, second_0, first_1, second_1;
};

[[nodiscard]] CylinderFunctions cylinder_functions(std::complex<double> x);
[[nodiscard]] ScaledHankel scaled_hankel(std::complex<double> x);

}  // namespace whirl
