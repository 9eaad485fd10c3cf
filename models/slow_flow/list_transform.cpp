#include "models/slow_flow/list_transform.hpp"

#include <cmath>
#include <numbers>

namespace whirl::models {

ListTransform::ListTransform(const std::vector<int>& harmonics, int samples) : half_(samples / 2) {
  if (samples % 2 != 0) throw std::invalid_argument("a folded transform needs an even number of samples");
  std::vector<int> harmonic[2];
  for (const int k : harmonics)
    for (int part = 0; part < (k > 0 ? 2 : 1); ++part) {
      place_[k % 2].push_back(width_++);
      harmonic[k % 2].push_back(part == 0 ? k : -k);  // negative: -sin
    }
  for (int parity : {0, 1}) {
    const auto columns = static_cast<Eigen::Index>(place_[parity].size());
    basis_[parity].resize(half_, columns);
    projection_[parity].resize(columns, half_);
    for (Eigen::Index c = 0; c < columns; ++c) {
      const int k = harmonic[parity][static_cast<std::size_t>(c)];
      for (int m = 0; m < half_; ++m) {
        const double theta = 2.0 * std::numbers::pi * ((std::abs(k) * m) % samples) / samples;
        basis_[parity](m, c) = k >= 0 ? std::cos(theta) : -std::sin(theta);
      }
      projection_[parity].row(c) = basis_[parity].col(c).transpose() * ((k == 0 ? 1.0 : 2.0) / samples);
    }
    x_[parity].resize(columns);
    f_[parity].resize(half_);
  }
}

template <>
void ListTransform::synthesise<double>(const double* x, double* f) const {
  for (int parity : {0, 1}) {
    for (std::size_t c = 0; c < place_[parity].size(); ++c) x_[parity][static_cast<Eigen::Index>(c)] = x[place_[parity][c]];
    f_[parity].noalias() = basis_[parity] * x_[parity];
  }
  for (int m = 0; m < half_; ++m) {
    f[m] = f_[0][m] + f_[1][m];
    f[half_ + m] = f_[0][m] - f_[1][m];
  }
}

template <>
void ListTransform::analyse<double>(const double* f, double* y) const {
  for (int m = 0; m < half_; ++m) {
    f_[0][m] = f[m] + f[half_ + m];
    f_[1][m] = f[m] - f[half_ + m];
  }
  for (int parity : {0, 1}) {
    x_[parity].noalias() = projection_[parity] * f_[parity];
    for (std::size_t c = 0; c < place_[parity].size(); ++c) y[place_[parity][c]] = x_[parity][static_cast<Eigen::Index>(c)];
  }
}

}  // namespace whirl::models
