#include "models/guy/transverse_modes.hpp"

#include <fmt/format.h>

#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace whirl::models::guy {
namespace {

using boost::math::cyl_bessel_j;
using boost::math::cyl_neumann;
using std::numbers::pi;

constexpr double modulus_limit = 2e-3;  // of k - 1: z > 785, where three terms of the series below are exact to rounding

double cross(double z, double x) { return cyl_bessel_j(0, z) * cyl_neumann(0, x) - cyl_neumann(0, z) * cyl_bessel_j(0, x); }

// Phase theta(x) - x + pi/4 of J0 + i N0, times x; squared modulus M^2 pi x / 2. In q = 1/x^2.
double phase_tail(double q) { return -1.0 / 8.0 + q * (25.0 / 384.0 - q * 1073.0 / 5120.0); }
double modulus2(double q) { return 1.0 - q * (1.0 / 8.0 - q * (27.0 / 128.0 - q * 1125.0 / 1024.0)); }

// theta(z + dx) - theta(z).
double phase_between(double z, double x, double dx) { return dx + phase_tail(1.0 / (x * x)) / x - phase_tail(1.0 / (z * z)) / z; }

void require_mode(int i) {
  if (i < 1) throw std::invalid_argument(fmt::format("transverse modes: mode number must be >= 1, got {}", i));
}

void require_positive(const char* name, double v) {
  if (!(v > 0.0) || !std::isfinite(v)) throw std::invalid_argument(fmt::format("transverse modes: {} must be > 0, got {:g}", name, v));
}

// X_i by the phase: X = i pi - [tail(kz)/(kz) - tail(z)/z], a contraction of factor (k - 1)^2 / 8 X^2.
double phase_root(int i, double k) {
  double X = i * pi;
  if (k == 1.0) return X;
  for (int sweep = 0; sweep < 6; ++sweep) {
    const double z = X / (k - 1.0), x = z + X;
    X = i * pi - (phase_tail(1.0 / (x * x)) / x - phase_tail(1.0 / (z * z)) / z);
  }
  return X;
}

double bessel_root(int i, double k) {
  const auto f = [k](double X) {
    const double z = X / (k - 1.0);
    return cross(z, z + X);
  };
  std::uintmax_t steps = 100;
  const auto r = boost::math::tools::toms748_solve(f, (i - 0.5) * pi, i * pi, boost::math::tools::eps_tolerance<double>(52), steps);
  return 0.5 * (r.first + r.second);
}

}  // namespace

TransverseModes::TransverseModes(double T0, double TL, double length, double mass) {
  require_positive("lower tension", T0);
  require_positive("upper tension", TL);
  require_positive("length", length);
  require_positive("mass per length", mass);
  flip_ = TL < T0;
  k_ = std::sqrt(flip_ ? T0 / TL : TL / T0);
  speed_ = 0.5 * (std::sqrt(T0) + std::sqrt(TL)) / (length * std::sqrt(mass));
}

TransverseModes::TransverseModes(const Statics& s) : TransverseModes(s.lower_tension, s.upper_tension, s.length, s.guy.mass_per_length) {}

double TransverseModes::phase_number(int i) const {
  require_mode(i);
  return k_ - 1.0 < modulus_limit ? phase_root(i, k_) : bessel_root(i, k_);
}

double TransverseModes::frequency(int i) const { return speed_ * phase_number(i); }

// Scale by int Y^2 ds = [(T Y')^2] / (m w^2 T'): with Y = J0(z) N0(x) - N0(z) J0(x), (T Y')(0) = T'/pi and (T Y')(L) = rho T'/pi, rho = J0(z)/J0(kz).
TransverseMode TransverseModes::mode(int i) const {
  TransverseMode m;
  m.k_ = k_;
  m.flip_ = flip_;
  m.phase_ = phase_number(i);
  m.frequency_ = speed_ * m.phase_;
  m.modulus_ = k_ - 1.0 < modulus_limit;
  m.sign_ = flip_ && i % 2 == 0 ? -1.0 : 1.0;
  if (!m.modulus_) {
    m.scale_ = 1.0 / m.printed_norm();
  } else if (k_ == 1.0) {
    m.scale_ = std::sqrt(2.0);
  } else {  // (rho^2 - 1)/(k - 1) = 1 + k (mu(z)/mu(kz) - 1)/(k - 1)
    const double z = m.root(), kz = z + m.phase_, qz = 1.0 / (z * z), qk = 1.0 / (kz * kz);
    const double dq = (k_ + 1.0) * qk;  // (qz - qk)/(k - 1)
    const double slope = -1.0 / 8.0 + (qz + qk) * 27.0 / 128.0;
    m.scale_ = std::sqrt(modulus2(qz) * (k_ + 1.0) / (1.0 + k_ * slope * dq / modulus2(qk)));
  }
  return m;
}

double TransverseMode::root() const { return k_ == 1.0 ? std::numeric_limits<double>::infinity() : phase_ / (k_ - 1.0); }

double TransverseMode::printed_norm() const {  // N^2 = 4 (rho^2 - 1) / (pi^2 z^2 (k^2 - 1)), T' L = T0 (k^2 - 1)
  if (k_ == 1.0) return 0.0;
  const double z = root(), kz = z + phase_, rho = cyl_bessel_j(0, z) / cyl_bessel_j(0, kz);
  const double sine = cyl_neumann(0, z) / cyl_neumann(0, kz);  // the same ratio; the one with the larger functions is the accurate one
  const double ratio = std::abs(cyl_bessel_j(0, kz)) > std::abs(cyl_neumann(0, kz)) ? rho : sine;
  return 2.0 / (pi * z) * std::sqrt((ratio * ratio - 1.0) / (k_ * k_ - 1.0));
}

double TransverseMode::value(double sigma) const { return sign_ * low_value(flip_ ? 1.0 - sigma : sigma); }

double TransverseMode::slope(double sigma) const { return (flip_ ? -sign_ : sign_) * low_slope(flip_ ? 1.0 - sigma : sigma); }

// x = z sqrt(T/T0), x - z = X (1 + k) sigma / (1 + sqrt(T/T0)).
double TransverseMode::low_value(double sigma) const {
  const double root_t = std::sqrt(1.0 + (k_ * k_ - 1.0) * sigma), dx = phase_ * (1.0 + k_) * sigma / (1.0 + root_t);
  if (k_ == 1.0) return scale_ * std::sin(dx);
  const double z = root(), x = z + dx;
  if (!modulus_) return scale_ * cross(z, x);
  return scale_ * std::sqrt(modulus2(1.0 / (x * x)) / root_t) * std::sin(phase_between(z, x, dx));
}

double TransverseMode::low_slope(double sigma) const {
  const double root_t = std::sqrt(1.0 + (k_ * k_ - 1.0) * sigma), dx = phase_ * (1.0 + k_) * sigma / (1.0 + root_t);
  const double dx_dsigma = 0.5 * phase_ * (k_ + 1.0) / root_t;  // z (k^2 - 1) / (2 sqrt(T/T0))
  if (k_ == 1.0) return scale_ * phase_ * std::cos(dx);
  const double z = root(), x = z + dx;
  if (!modulus_) return scale_ * dx_dsigma * (cyl_neumann(0, z) * cyl_bessel_j(1, x) - cyl_bessel_j(0, z) * cyl_neumann(1, x));
  // f = sqrt(mu2 / root_t) sin(theta), theta' = 1/mu2
  const double q = 1.0 / (x * x), mu2 = modulus2(q), theta = phase_between(z, x, dx), amplitude = std::sqrt(mu2 / root_t);
  const double mu2_slope = 2.0 * q / x * (1.0 / 8.0 - q * (27.0 / 64.0 - q * 3375.0 / 1024.0));
  const double log_slope = 0.5 * (mu2_slope / mu2 - 1.0 / x);  // of the amplitude, with respect to x
  return scale_ * dx_dsigma * amplitude * (std::cos(theta) / mu2 + log_slope * std::sin(theta));
}

double mcmahon_root(int i, double k, int terms) {
  require_mode(i);
  if (!(k > 1.0) || terms < 1 || terms > 4)
    throw std::invalid_argument(fmt::format("McMahon's expansion: k must be > 1 and terms 1 to 4, got {:g} and {}", k, terms));
  const double b = i * pi / (k - 1.0), q = 4.0 * k;
  const double k1 = -1.0 / (8.0 * k), k2 = 25.0 * (std::pow(k, 3) - 1.0) / (6.0 * std::pow(q, 3) * (k - 1.0));
  const double k3 = -1073.0 * (std::pow(k, 5) - 1.0) / (5.0 * std::pow(q, 5) * (k - 1.0));
  const double all[] = {b, k1 / b, (k2 - k1 * k1) / std::pow(b, 3), (k3 - 4.0 * k1 * k2 + 2.0 * std::pow(k1, 3)) / std::pow(b, 5)};
  double sum = 0.0;
  for (int t = 0; t < terms; ++t) sum += all[t];
  return sum;
}

double string_frequency(const Statics& s, int i) {
  require_mode(i);
  return i * pi / s.guy.chord() * std::sqrt(s.mean_tension() / s.guy.mass_per_length);
}

}  // namespace whirl::models::guy
