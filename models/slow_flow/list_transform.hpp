#pragma once
/// Between the kept harmonics of one coordinate and samples at theta_j = 2 pi j / M (M even) over the base period, in any scalar.
///
///     f(theta) = sum over k of  u_k cos(k theta) - v_k sin(k theta),  a mean for k = 0
///
/// theta and theta + pi are folded together: even and odd harmonics are separate products half as long, and harmonics that a symmetry forbids stay
/// zero to the last bit.

#include <vector>

#include "core/problem.hpp"

namespace whirl::models {

class ListTransform {
 public:
  ListTransform() = default;
  ListTransform(const std::vector<int>& harmonics, int samples);

  int width() const { return width_; }
  /// x -> f.
  template <class S>
  void synthesise(const S* x, S* f) const;
  /// f -> Re and Im of 2 <f e^{-i k theta}>, the mean for k = 0.
  template <class S>
  void analyse(const S* f, S* y) const;

 private:
  int half_ = 0, width_ = 0;
  std::vector<int> place_[2];  // in x, of the columns with even and odd k
  Matrix basis_[2], projection_[2];
  mutable Vector x_[2], f_[2];
};

// ---------------------------------------------------------------------------------------------------------------------------

template <>
void ListTransform::synthesise<double>(const double* x, double* f) const;
template <>
void ListTransform::analyse<double>(const double* f, double* y) const;

template <class S>
void ListTransform::synthesise(const S* x, S* f) const {
  for (int m = 0; m < 2 * half_; ++m) f[m] = S(0.0);
  for (int parity : {0, 1})
    for (std::size_t c = 0; c < place_[parity].size(); ++c)
      for (int m = 0; m < half_; ++m) f[parity * half_ + m] += x[place_[parity][c]] * basis_[parity](m, static_cast<Eigen::Index>(c));
  for (int m = 0; m < half_; ++m) {
    const S even = f[m], odd = f[half_ + m];
    f[m] = even + odd;
    f[half_ + m] = even - odd;
  }
}

template <class S>
void ListTransform::analyse(const S* f, S* y) const {
  for (int parity : {0, 1})
    for (std::size_t c = 0; c < place_[parity].size(); ++c) {
      S sum(0.0);
      for (int m = 0; m < half_; ++m)
        sum += (parity == 0 ? f[m] + f[half_ + m] : f[m] - f[half_ + m]) * projection_[parity](static_cast<Eigen::Index>(c), m);
      y[place_[parity][c]] = sum;
    }
}

}  // namespace whirl::models
