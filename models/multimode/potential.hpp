#pragma once
/// Stretching energy of the N-mode cable as a sparse polynomial: the tensors of [NielsenKirkegaard2002, eq. (24)] by quadrature.
///
///     V(p, t) = sum over monomials of  p_i p_j .. cos(h omega t)  sum_f value_f factor_f(E, r)
///
/// One entry for each product of coordinates and harmonic, so that every equation's terms come from one symmetric number: the model has a
/// potential by construction. What a symmetry forbids (parity about midspan, sums of half waves, signs out of plane) has no entry at all;
/// which entries there are depends on the modes alone, never on a parameter.

#include "models/multimode/basis.hpp"

namespace whirl::models {

/// How an entry depends on the support's motion E = (E1, E2, E3) and the sag ratio r.
/// A product e_i e_j is (E_i E_j/2)(1 + cos 2 omega t): `half_..` in an entry of harmonic 0 and in one of harmonic 2.
enum class Factor {
  one,
  r,
  r2,
  E1,
  E2,
  E3,
  rE1,
  rE2,
  rE3,
  half_EE,
  half_E22,
  half_E33,
  half_E2E3,
  r_half_EE,
  r_half_E22,
  r_half_E2E3,
  half_N,
  r_half_N
};
inline constexpr std::size_t factor_count = 18;

/// Their values; EE = |E|^2, N = E2^2 + E3^2.
template <class S>
std::array<S, factor_count> factor_values(const std::array<S, 3>& E, const S& r) {
  const S EE = (E[0] * E[0] + E[1] * E[1] + E[2] * E[2]) * 0.5, E22 = E[1] * E[1] * 0.5, E33 = E[2] * E[2] * 0.5, E23 = E[1] * E[2] * 0.5;
  const S N = E22 + E33;
  return {S(1.0), r, r * r, E[0], E[1], E[2], r * E[0], r * E[1], r * E[2], EE, E22, E33, E23, r * EE, r * E22, r * E23, N, r * N};
}

template <class T>
struct Contribution {
  Factor factor;
  T value;
};

/// p_index[0] .. p_index[degree-1] cos(harmonic omega t), indices rising.
struct Monomial {
  int degree;
  std::array<short, 4> index;
  int harmonic;
  int first, count;  ///< of its contributions
};

/// Which components of E can be other than zero in a direction of motion.
using Moving = std::array<bool, 3>;
inline bool vanishes(Factor f, const Moving& moving) {
  using F = Factor;
  switch (f) {
    case F::one:
    case F::r:
    case F::r2:
      return false;
    case F::E1:
    case F::rE1:
      return !moving[0];
    case F::E2:
    case F::rE2:
    case F::half_E22:
    case F::r_half_E22:
      return !moving[1];
    case F::E3:
    case F::rE3:
    case F::half_E33:
      return !moving[2];
    case F::half_E2E3:
    case F::r_half_E2E3:
      return !(moving[1] && moving[2]);
    case F::half_N:
    case F::r_half_N:
      return !(moving[1] || moving[2]);
    case F::half_EE:
    case F::r_half_EE:
      return !(moving[0] || moving[1] || moving[2]);
  }
  return false;
}

template <class T>
struct Potential {
  Moving moving{true, true, true};
  std::vector<Monomial> monomials;
  std::vector<Contribution<T>> contributions;

  /// Leaves out what a motion in this direction never has.
  void add(std::initializer_list<int> index, int harmonic, std::initializer_list<Contribution<T>> parts) {
    Monomial m{static_cast<int>(index.size()), {}, harmonic, static_cast<int>(contributions.size()), 0};
    std::size_t i = 0;
    for (int k : index) m.index[i++] = static_cast<short>(k);
    for (const auto& part : parts)
      if (!vanishes(part.factor, moving)) {
        contributions.push_back(part);
        ++m.count;
      }
    if (m.count > 0) monomials.push_back(m);
  }
};

/// Integrals over the chord of products of slopes.
template <class T>
class SlopeIntegrals {
 public:
  explicit SlopeIntegrals(const std::vector<BasisMode<T>>& modes);
  T two(int a, int b) const { return sum(pair(a, b), one_.data()); }                             ///< int phi_a' phi_b'
  T two_sag(int a, int b) const { return sum(pair(a, b), sag_.data()); }                         ///< with s
  T three(int a, int b, int c) const { return sum(pair(a, b), slope(c)); }                       ///< int phi_a' phi_b' phi_c'
  T three_sag(int a, int b, int c) const { return sum(pair(a, b), sag_slope_.data() + at(c)); }  ///< with s
  T four(int a, int b, int c, int d) const { return sum(pair(a, b), pair(c, d)); }

 private:
  std::size_t at(int c) const { return static_cast<std::size_t>(c) * points_; }
  const T* slope(int a) const { return slope_.data() + at(a); }
  const T* pair(int a, int b) const {  // a <= b
    return pair_.data() + static_cast<std::size_t>(b * (b + 1) / 2 + a) * points_;
  }
  // Weights stand in `weighted_`: sum of x y w over half the chord, counted twice.
  template <class Y>
  T sum(const T* x, const Y* y) const {
    T total(0.0);
    for (std::size_t i = 0; i < points_; ++i) total += x[i] * y[i] * weight_[i];
    return total;
  }

  std::size_t points_;
  std::vector<double> weight_, one_, sag_;
  std::vector<T> slope_, sag_slope_, pair_;
};

// ---------------------------------------------------------------------------------------------------------------------------

template <class T>
SlopeIntegrals<T>::SlopeIntegrals(const std::vector<BasisMode<T>>& modes) {
  int highest = 1;
  for (const auto& m : modes) highest = std::max(highest, m.half_waves);
  const HalfChord chord(highest);
  points_ = chord.size();
  weight_ = chord.weight;
  one_.assign(points_, 1.0);
  for (double xi : chord.xi) sag_.push_back(4.0 * (1.0 - 2.0 * xi));
  for (const auto& m : modes)
    for (std::size_t i = 0; i < points_; ++i) {
      slope_.push_back(m.slope(chord.xi[i]));
      sag_slope_.push_back(slope_.back() * sag_[i]);
    }
  const int n = static_cast<int>(modes.size());
  for (int b = 0; b < n; ++b)
    for (int a = 0; a <= b; ++a)
      for (std::size_t i = 0; i < points_; ++i) pair_.push_back(slope(a)[i] * slope(b)[i]);
}

namespace detail {

/// Which integrals a symmetry makes zero, and how many orders of its factors a monomial stands for.
template <class T>
struct Selection {
  const std::vector<BasisMode<T>>& modes;

  bool in(int a) const { return modes[static_cast<std::size_t>(a)].in_plane; }
  int waves(int a) const { return modes[static_cast<std::size_t>(a)].half_waves; }
  /// Pulls at the sag to first order: symmetric in plane.
  bool pulls(int a) const { return in(a) && waves(a) % 2 == 1; }
  bool same_plane(int a, int b) const { return in(a) == in(b); }
  bool even(std::initializer_list<int> list) const {
    int sum = 0;
    for (int a : list) sum += waves(a);
    return sum % 2 == 0;
  }
  /// int of the product of slopes: even about midspan, and for sines some +-k1 +-k2 .. = 0.
  bool product(std::initializer_list<int> list) const {
    if (!even(list)) return false;
    for (int a : list)
      if (!modes[static_cast<std::size_t>(a)].sine) return true;
    const int count = static_cast<int>(list.size());
    for (int signs = 0; signs < 1 << count; ++signs) {
      int total = 0, i = 0;
      for (int a : list) total += ((signs >> i++) & 1) != 0 ? -waves(a) : waves(a);
      if (total == 0) return true;
    }
    return false;
  }
  /// The same with the sag's slope s, odd about midspan.
  bool sag_product(std::initializer_list<int> list) const { return !even(list); }
};

inline int orders(int a, int b) { return a == b ? 1 : 2; }
inline int orders(int a, int b, int c) { return a == b && b == c ? 1 : a == b || b == c ? 3 : 6; }
inline int orders(int a, int b, int c, int d) {
  int count = 24, run = 1;
  const int list[] = {a, b, c, d};
  for (int i = 1; i < 4; ++i) {
    run = list[i] == list[i - 1] ? run + 1 : 1;
    count /= run;
  }
  return count;
}

}  // namespace detail

}  // namespace whirl::models
