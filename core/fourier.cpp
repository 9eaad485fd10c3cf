#include "core/fourier.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace whirl {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

double hann(std::size_t j, std::size_t n) { return 0.5 * (1.0 - std::cos(two_pi * static_cast<double>(j) / static_cast<double>(n))); }

std::vector<double> windowed(std::span<const double> x) {
  double mean = 0.0;
  for (const double v : x) mean += v / static_cast<double>(x.size());
  std::vector<double> y(x.size());
  for (std::size_t j = 0; j < x.size(); ++j) y[j] = hann(j, x.size()) * (x[j] - mean);
  return y;
}

std::complex<double> at(std::span<const double> weighted, double frequency) {
  const std::complex<double> turn = std::polar(1.0, -two_pi * frequency);
  std::complex<double> sum = 0.0, w = 1.0;
  for (std::size_t j = 0; j < weighted.size(); ++j) {
    if (j % 512 == 0) w = std::polar(1.0, -two_pi * std::fmod(frequency * static_cast<double>(j), 1.0));  // no drift of the recurrence
    sum += weighted[j] * w;
    w *= turn;
  }
  return sum;
}

// Golden-section search of the largest modulus between a and b.
double largest_between(std::span<const double> weighted, double a, double b) {
  constexpr double golden = 0.6180339887498949;
  double c = b - golden * (b - a), d = a + golden * (b - a);
  double fc = std::abs(at(weighted, c)), fd = std::abs(at(weighted, d));
  while (b - a > 1e-7 / static_cast<double>(weighted.size())) {
    if (fc > fd) {
      b = d;
      d = c;
      fd = fc;
      c = b - golden * (b - a);
      fc = std::abs(at(weighted, c));
    } else {
      a = c;
      c = d;
      fc = fd;
      d = a + golden * (b - a);
      fd = std::abs(at(weighted, d));
    }
  }
  return 0.5 * (a + b);
}

}  // namespace

void fourier_transform(std::span<std::complex<double>> x) {
  const std::size_t n = x.size();
  if (!std::has_single_bit(n)) throw std::invalid_argument("the size of a Fourier transform must be a power of two");
  for (std::size_t i = 1, j = 0; i < n; ++i) {  // bit reversal
    std::size_t bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(x[i], x[j]);
  }
  std::vector<std::complex<double>> root(n / 2 + 1);
  for (std::size_t k = 0; k < root.size(); ++k) root[k] = std::polar(1.0, -two_pi * static_cast<double>(k) / static_cast<double>(n));
  for (std::size_t length = 2; length <= n; length *= 2)
    for (std::size_t i = 0; i < n; i += length)
      for (std::size_t k = 0; k < length / 2; ++k) {
        const auto u = x[i + k], v = x[i + k + length / 2] * root[k * (n / length)];
        x[i + k] = u + v;
        x[i + k + length / 2] = u - v;
      }
}

std::vector<double> amplitude_spectrum(std::span<const double> x) {
  if (x.size() < 4) throw std::invalid_argument("a spectrum needs at least 4 samples");
  const std::size_t n = std::bit_floor(x.size());
  const auto y = windowed(x.first(n));
  std::vector<std::complex<double>> z(y.begin(), y.end());
  fourier_transform(z);
  std::vector<double> amplitude(n / 2 + 1);
  for (std::size_t k = 0; k < amplitude.size(); ++k) amplitude[k] = std::abs(z[k]) * 4.0 / static_cast<double>(n);
  return amplitude;
}

std::complex<double> windowed_line(std::span<const double> x, double frequency) {
  if (x.empty()) throw std::invalid_argument("a spectral line needs samples");
  std::vector<double> y(x.begin(), x.end());
  double weight = 0.0;
  for (std::size_t j = 0; j < y.size(); ++j) {
    const double w = hann(j, y.size());
    y[j] *= w;
    weight += w;
  }
  return at(y, frequency) * ((frequency == 0.0 ? 1.0 : 2.0) / weight);
}

std::vector<SpectralLine> spectral_lines(std::span<const double> x, const SpectralOptions& o) {
  const auto amplitude = amplitude_spectrum(x);
  const std::size_t n = std::bit_floor(x.size());
  const auto weighted = windowed(x.first(n));
  const double top = *std::max_element(amplitude.begin() + 1, amplitude.end());
  std::vector<std::size_t> bins;
  for (std::size_t k = 1; k + 1 < amplitude.size(); ++k)
    if (amplitude[k] > o.floor * top && amplitude[k] > amplitude[k - 1] && amplitude[k] >= amplitude[k + 1]) bins.push_back(k);
  std::sort(bins.begin(), bins.end(), [&](std::size_t a, std::size_t b) { return amplitude[a] > amplitude[b]; });
  std::vector<SpectralLine> lines;
  for (const std::size_t k : bins) {
    if (static_cast<int>(lines.size()) >= o.most) break;
    const double bin = 1.0 / static_cast<double>(n),
                 f = largest_between(weighted, (static_cast<double>(k) - 1.0) * bin, (static_cast<double>(k) + 1.0) * bin);
    // A side lobe of a stronger line is no line.
    const bool lobe = std::any_of(lines.begin(), lines.end(), [&](const SpectralLine& l) { return std::abs(l.frequency - f) < 4.0 * bin; });
    const auto value = at(weighted, f) * (4.0 / static_cast<double>(n));
    if (!lobe && std::abs(value) > o.floor * top) lines.push_back({f, value});
  }
  return lines;
}

}  // namespace whirl
