#pragma once
/// Fourier analysis of evenly sampled records: a radix-2 transform, the lines of a spectrum refined between its bins, and single lines.
///
///     X_k = sum_j x_j e^{-2 pi i j k / N};     a line a cos(2 pi f j + phase) of a Hann-windowed record is found at the maximum over f of
///     |sum_j w_j x_j e^{-2 pi i f j}| and read off there: a e^{i phase} = 2 sum / sum_j w_j.
///
///     for (const auto& line : spectral_lines(x, {.floor = 1e-4})) line.frequency, std::abs(line.amplitude)
///
/// Frequencies are in cycles per sample, 0 .. 1/2. Throws std::invalid_argument for sizes that do not fit.

#include <complex>
#include <span>
#include <vector>

namespace whirl {

/// In place; the size must be a power of two.
void fourier_transform(std::span<std::complex<double>> x);

/// Hann-windowed amplitude at every bin 0 .. N/2 of the first power of two samples: a line's peak shows its amplitude.
std::vector<double> amplitude_spectrum(std::span<const double> x);

/// Complex amplitude a e^{i phase} of the Hann-windowed record at one frequency; a mean for frequency 0.
std::complex<double> windowed_line(std::span<const double> x, double frequency);

struct SpectralLine {
  double frequency;                ///< cycles per sample
  std::complex<double> amplitude;  ///< a e^{i phase} of a cos(2 pi f j + phase)
};
struct SpectralOptions {
  double floor = 1e-4;  ///< lines below this share of the largest are left out
  int most = 40;        ///< strongest kept
};
/// By falling amplitude; the mean is not among them. Lines nearer than four bins are not told apart.
std::vector<SpectralLine> spectral_lines(std::span<const double> x, const SpectralOptions& options = {});

}  // namespace whirl
