#pragma once
/// Eigenvalues of 3 x 3 and 4 x 4 matrices from the characteristic polynomial, split into real factors by Newton from the factors of the last matrix:
///
///     z^4 + c3 z^3 + c2 z^2 + c1 z + c0 = (z^2 + p z + q)(z^2 + r z + s),      z^3 + c2 z^2 + c1 z + c0 = (z - t)(z^2 + p z + q)
///
/// Along a branch factors move little, and steadily: of the quartic's they are extrapolated; two steps or so. False where they do not settle (factors
/// about to share a root, no factors yet): ask a general solver and hand its eigenvalues to `restart`.

#include <complex>

#include "core/problem.hpp"

namespace whirl::continuation {

/// Roots of z^2 + p z + q; the smaller real one without cancellation.
void quadratic_roots(double p, double q, std::complex<double>& z0, std::complex<double>& z1);

class RealFactors {
 public:
  [[nodiscard]] bool eigenvalues(const Matrix& a, std::complex<double>* z);
  void restart(const std::complex<double>* z, int m);

 private:
  bool three(const Matrix& a, std::complex<double>* z);
  bool four(const Matrix& a, std::complex<double>* z);
  double t_ = 0.0, p_ = 0.0, q_ = 0.0, p_before_ = 0.0, q_before_ = 0.0;
  bool known_ = false;
};

}  // namespace whirl::continuation
