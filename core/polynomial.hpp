#pragma once
/// All roots of a real polynomial, of any moduli, by the simultaneous iteration of Ehrlich and Aberth: Newton steps with the other roots divided out.

#include <complex>
#include <vector>

namespace whirl {

/// Roots of c[0] + c[1] x + ... + c[n] x^n. Trailing zero coefficients lower the degree; a constant has no roots.
std::vector<std::complex<double>> polynomial_roots(std::vector<double> coefficients);

}  // namespace whirl
