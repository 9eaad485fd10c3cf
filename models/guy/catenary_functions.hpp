#pragma once
/// Differences and removable singularities of the catenary, without cancellation in the taut limit.

#include <cmath>

namespace whirl::models::guy {

/// asinh a - asinh b = asinh(a sqrt(1 + b^2) - b sqrt(1 + a^2)), with a - b given apart.
inline double asinh_difference(double a, double b, double a_minus_b) {
  const double p = a * std::hypot(1.0, b), q = b * std::hypot(1.0, a);
  return std::asinh(p * q > 0.0 ? a_minus_b * (a + b) / (p + q) : p - q);
}

/// sqrt(1 + a^2) - sqrt(1 + b^2), with a - b given apart.
inline double root_difference(double a, double b, double a_minus_b) { return a_minus_b * (a + b) / (std::hypot(1.0, a) + std::hypot(1.0, b)); }

/// cosh r - sinh r / r = r^2/3 (1 + r^2/10 + r^4/280 + ...).
inline double cosh_minus_sinhc(double r) {
  if (std::abs(r) > 0.3) return std::cosh(r) - std::sinh(r) / r;
  const double q = r * r;
  return q / 3.0 * (1.0 + q / 10.0 * (1.0 + q / 28.0 * (1.0 + q / 54.0 * (1.0 + q / 88.0 * (1.0 + q / 130.0)))));
}

}  // namespace whirl::models::guy
