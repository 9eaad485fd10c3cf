#include "continuation/characteristic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace whirl::continuation {
namespace {

constexpr int most_steps = 10;

// Has a step of this relative size, after the one before it, come to rounding? Steps go on as squares: the next is size (size / previous)^2.
bool settled(double size, double previous) { return size <= 1e-11 || size * (size / previous) * (size / previous) <= 1e-16; }

// What is left when a factor is split off carries an error of rounding times the size of the matrix squared: too much where both its roots are far
// smaller. And the steps end at 1e-11 of the size: too early for a root that is far smaller than the other.
bool lost(double p, double q, double size) { return std::max(p * p, std::abs(q)) < 1e-8 * size * size || std::abs(q) < 1e-5 * p * p; }

}  // namespace

void quadratic_roots(double p, double q, std::complex<double>& z0, std::complex<double>& z1) {
  const double half = -0.5 * p, discriminant = half * half - q;
  if (discriminant < 0.0) {
    z0 = {half, std::sqrt(-discriminant)};
    z1 = std::conj(z0);
    return;
  }
  const double large = half + std::copysign(std::sqrt(discriminant), half);
  z0 = large;
  z1 = large == 0.0 ? 0.0 : q / large;
}

bool RealFactors::eigenvalues(const Matrix& a, std::complex<double>* z) {
  if (!known_) return false;
  const double p = p_, q = q_;
  known_ = a.rows() == 3 ? three(a, z) : four(a, z);
  if (known_ || a.rows() == 3 || (p == p_before_ && q == q_before_)) return known_;
  p_ = p_before_ = p;  // the matrices have not gone on steadily: from where the last one stood
  q_ = q_before_ = q;
  return known_ = four(a, z);
}

void RealFactors::restart(const std::complex<double>* z, int m) {
  // A complex pair goes together; without one the two lowest.
  int first = 0;
  while (first < m && z[first].imag() == 0.0) ++first;
  if (first < m) {
    p_ = -2.0 * z[first].real();
    q_ = std::norm(z[first]);
    for (int i = 0; i < m; ++i)
      if (z[i].imag() == 0.0) t_ = z[i].real();
  } else {
    double low = std::numeric_limits<double>::infinity(), next = low, high = -low;
    for (int i = 0; i < m; ++i) {
      const double x = z[i].real();
      if (x < low) {
        next = low;
        low = x;
      } else {
        next = std::min(next, x);
      }
      high = std::max(high, x);
    }
    p_ = -(low + next);
    q_ = low * next;
    t_ = high;
  }
  p_before_ = p_;
  q_before_ = q_;
  known_ = std::isfinite(p_) && std::isfinite(q_) && std::isfinite(t_);
}

bool RealFactors::three(const Matrix& a, std::complex<double>* z) {
  const double* d = a.data();  // columns of 3
  const double m00 = d[4] * d[8] - d[7] * d[5], m01 = d[1] * d[8] - d[7] * d[2], m02 = d[1] * d[5] - d[4] * d[2];
  const double c2 = -(d[0] + d[4] + d[8]);
  const double c1 = m00 + d[0] * d[8] - d[6] * d[2] + d[0] * d[4] - d[3] * d[1];
  const double c0 = -(d[0] * m00 - d[3] * m01 + d[6] * m02), size = a.norm();
  double previous = 1e-3;
  for (int i = 0; i < most_steps; ++i) {
    const double left = c2 + t_, product = c1 + t_ * left, f = c0 + t_ * product, slope = product + t_ * (left + t_);
    const double step = f / slope;
    t_ -= step;
    if (!std::isfinite(step)) return false;
    const double now = std::abs(step) / size, last = std::exchange(previous, now);
    if (!settled(now, last)) continue;
    const double p = c2 + t_, q = c1 + t_ * p;
    z[0] = t_;
    quadratic_roots(p, q, z[1], z[2]);
    return !lost(p, q, size);
  }
  return false;
}

bool RealFactors::four(const Matrix& a, std::complex<double>* z) {
  const double* d = a.data();  // columns of 4
  // Minors of the first two rows and of the last two.
  const double s0 = d[0] * d[5] - d[1] * d[4], s1 = d[0] * d[9] - d[1] * d[8], s2 = d[0] * d[13] - d[1] * d[12], s3 = d[4] * d[9] - d[5] * d[8],
               s4 = d[4] * d[13] - d[5] * d[12], s5 = d[8] * d[13] - d[9] * d[12];
  const double k5 = d[10] * d[15] - d[11] * d[14], k4 = d[6] * d[15] - d[7] * d[14], k3 = d[6] * d[11] - d[7] * d[10],
               k2 = d[2] * d[15] - d[3] * d[14], k1 = d[2] * d[11] - d[3] * d[10], k0 = d[2] * d[7] - d[3] * d[6];
  const double c3 = -(d[0] + d[5] + d[10] + d[15]);
  const double c2 = s0 + k5 + (d[0] + d[5]) * (d[10] + d[15]) - d[8] * d[2] - d[12] * d[3] - d[9] * d[6] - d[13] * d[7];
  const double c1 = -(d[5] * k5 - d[9] * k4 + d[13] * k3 + d[0] * k5 - d[8] * k2 + d[12] * k1 + d[3] * s4 - d[7] * s2 + d[15] * s0 + d[2] * s3 -
                      d[6] * s1 + d[10] * s0);
  const double c0 = s0 * k5 - s1 * k4 + s2 * k3 + s3 * k2 - s4 * k1 + s5 * k0, size = a.norm();
  const double inverse_size = 1.0 / size, p_here = p_, q_here = q_;
  p_ += p_here - p_before_;
  q_ += q_here - q_before_;
  double previous = 1e-3;
  for (int i = 0; i < most_steps; ++i) {  // Bairstow: the remainder R1 z + R0 of the division by z^2 + p z + q vanishes
    const double r = c3 - p_, s = c2 - q_ - p_ * r, R1 = c1 - p_ * s - q_ * r, R0 = c0 - q_ * s;
    const double R1_p = q_ - s - p_ * (p_ - r), R1_q = p_ - r, R0_p = -q_ * (p_ - r), R0_q = q_ - s;
    const double inverse = 1.0 / (R1_p * R0_q - R1_q * R0_p);
    const double dp = (R1 * R0_q - R0 * R1_q) * inverse, dq = (R0 * R1_p - R1 * R0_p) * inverse;
    if (!std::isfinite(dp) || !std::isfinite(dq)) return false;
    p_ -= dp;
    q_ -= dq;
    const double now = std::max(std::abs(dp), std::abs(dq) * inverse_size) * inverse_size, last = std::exchange(previous, now);
    if (!settled(now, last)) continue;
    p_before_ = p_here;
    q_before_ = q_here;
    const double r_end = c3 - p_, rest = c2 - q_ - p_ * r_end;
    quadratic_roots(p_, q_, z[0], z[1]);
    quadratic_roots(r_end, rest, z[2], z[3]);
    return !lost(p_, q_, size) && !lost(r_end, rest, size);
  }
  return false;
}

}  // namespace whirl::continuation
