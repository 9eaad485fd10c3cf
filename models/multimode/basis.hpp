#pragma once
/// Mode shapes of the N-mode cable in any scalar, tabulated for quadrature over half the chord (the other half by symmetry).
///
/// A mode of k half waves: sin(k pi xi), except symmetric in-plane linear modes, [cos(b (1/2 - xi)) - cos(b/2)]/D with b from the
/// linear theory at lambda2 (models/shallow/modes.hpp). Slopes with respect to xi.

#include "models/multimode/cable_model.hpp"
#include "models/shallow/modes.hpp"

namespace whirl::models {

/// b of the n-th symmetric mode with slopes: the root in double, then Newton steps in S.
template <class S>
S symmetric_root_in(const S& lambda2, int order) {
  using std::cos;
  using std::sin;
  S x(0.5 * shallow::symmetric_root(value_of(lambda2), order));
  for (int level = 0; level < 3; ++level) {  // one for each level of nesting
    const S s = sin(x), c = cos(x), x2 = x * x;
    x = x - (lambda2 * (s - x * c) + x2 * x * c * 4.0) / (lambda2 * x * s + x2 * (c * 12.0 - x * s * 4.0));
  }
  return x * 2.0;
}

template <class T>
struct BasisMode {
  int half_waves;
  bool in_plane;
  bool sine;  ///< exactly sin(k pi xi): selection rules hold
  T b;        ///< frequency number: omega = (b/L) sqrt(T/mu), of the linear mode or the string
  T half_cos, divisor;
  T mass;  ///< m = int phi^2
  T mean;  ///< int phi
  bool symmetric() const { return half_waves % 2 == 1; }

  T shape(double xi) const {
    using std::cos;
    if (sine) return T(std::sin(half_waves * pi * xi));
    return (cos(b * (0.5 - xi)) - half_cos) / divisor;
  }
  T slope(double xi) const {
    using std::sin;
    if (sine) return T(half_waves * pi * std::cos(half_waves * pi * xi));
    return b * sin(b * (0.5 - xi)) / divisor;
  }
  /// int phi xi (upper end moves) or int phi (1 - xi) (lower end).
  T first_moment(End end) const {
    if (symmetric()) return mean * 0.5;
    return T((end == End::upper ? -1.0 : 1.0) / (half_waves * pi));  // antisymmetric modes are sines
  }
};

template <class T>
BasisMode<T> basis_mode(int half_waves, bool in_plane, Shapes shapes, const T& lambda2) {
  using std::cos;
  using std::sin;
  const bool sine = !in_plane || shapes == Shapes::sines || half_waves % 2 == 0;
  BasisMode<T> m{half_waves, in_plane, sine, T(half_waves * pi), T(0.0), T(1.0), T(0.5), T(half_waves % 2 == 1 ? 2.0 / (half_waves * pi) : 0.0)};
  if (sine) return m;
  const int order = (half_waves + 1) / 2;
  m.b = symmetric_root_in(lambda2, order);
  const T s = sin(m.b * 0.5);
  m.half_cos = cos(m.b * 0.5);
  m.divisor = (order % 2 == 1 ? 1.0 : -1.0) - m.half_cos;
  m.mass = (m.half_cos * m.half_cos + 0.5 - m.half_cos * s * 3.0 / m.b) / (m.divisor * m.divisor);
  m.mean = (s * 2.0 / m.b - m.half_cos) / m.divisor;
  return m;
}

template <class T>
std::vector<BasisMode<T>> basis_modes(const CableModel& model, const T& lambda2) {
  std::vector<BasisMode<T>> modes;
  for (int k : model.out_of_plane) modes.push_back(basis_mode<T>(k, false, model.shapes, lambda2));
  for (int k : model.in_plane) modes.push_back(basis_mode<T>(k, true, model.shapes, lambda2));
  return modes;
}

/// Gauss nodes on [0, 1/2] in as many panels as the product of four slopes needs; weights count both halves.
struct HalfChord {
  std::vector<double> xi, weight;
  explicit HalfChord(int highest_half_waves);
  std::size_t size() const { return xi.size(); }
};

}  // namespace whirl::models
