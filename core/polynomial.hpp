#pragma once
/// All roots of a real polynomial, as eigenvalues of its companion matrix.

#include <complex>
#include <vector>

namespace whirl {

/// Roots of c[0] + c[1] x + ... + c[n] x^n. Trailing zero coefficients lower the degree; a constant has no roots.
std::vector<std::complex<double>> polynomial_roots(std::vector<double> coefficients);

}  // namespace whirl
