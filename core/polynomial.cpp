#include "core/polynomial.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace whirl {
namespace {

using Complex = std::complex<double>;

// Starts on circles whose radii are the slopes of the upper hull of (k, log |c_k|): as many roots as the segment is long have about that modulus.
std::vector<Complex> starts(const std::vector<double>& c) {
  const std::size_t n = c.size() - 1;
  std::vector<std::size_t> hull;
  const auto slope = [&](std::size_t i, std::size_t k) { return (std::log(std::abs(c[k])) - std::log(std::abs(c[i]))) / static_cast<double>(k - i); };
  for (std::size_t k = 0; k <= n; ++k) {
    if (c[k] == 0.0) continue;
    while (hull.size() > 1 && slope(hull[hull.size() - 2], hull.back()) <= slope(hull.back(), k)) hull.pop_back();
    hull.push_back(k);
  }
  std::vector<Complex> z;
  for (std::size_t i = 0; i + 1 < hull.size(); ++i) {
    const std::size_t count = hull[i + 1] - hull[i];
    const double radius = std::exp(-slope(hull[i], hull[i + 1]));
    for (std::size_t k = 0; k < count; ++k)  // off the real axis, which conjugate pairs could not leave
      z.push_back(std::polar(radius, 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count) + 0.7 + static_cast<double>(i)));
  }
  return z;
}

}  // namespace

std::vector<std::complex<double>> polynomial_roots(std::vector<double> c) {
  constexpr int most_rounds = 200;
  constexpr double settled = 4.0 * std::numeric_limits<double>::epsilon();
  while (!c.empty() && c.back() == 0.0) c.pop_back();
  std::size_t zeros = 0;
  while (zeros + 1 < c.size() && c[zeros] == 0.0) ++zeros;
  if (c.size() < 2) return {};
  c.erase(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(zeros));
  std::vector<Complex> z = c.size() > 1 ? starts(c) : std::vector<Complex>();
  bool moved = true;
  for (int round = 0; round < most_rounds && moved; ++round) {
    moved = false;
    for (std::size_t i = 0; i < z.size(); ++i) {
      Complex f = 0.0, slope = 0.0, others = 0.0;
      for (auto k = c.rbegin(); k != c.rend(); ++k) {
        slope = slope * z[i] + f;
        f = f * z[i] + *k;
      }
      for (std::size_t k = 0; k < z.size(); ++k)
        if (k != i && z[k] != z[i]) others += 1.0 / (z[i] - z[k]);
      const Complex newton = f / slope, step = newton / (1.0 - newton * others);
      if (f == 0.0 || !std::isfinite(step.real()) || !std::isfinite(step.imag())) continue;
      z[i] -= step;
      moved = moved || std::abs(step) > settled * std::abs(z[i]);
    }
  }
  // A real root comes out with rounding beside the axis.
  for (auto& root : z)
    if (std::abs(root.imag()) < settled * std::abs(root.real())) root = root.real();
  z.insert(z.end(), zeros, 0.0);
  return z;
}

}  // namespace whirl
