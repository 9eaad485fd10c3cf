#pragma once
/// The entries of the stretching energy. t_a = int s phi_a' = 8 int phi_a, S = int phi' phi', V = int s phi' phi', D = int phi' phi' phi',
/// d = int s phi' phi' phi', G = int phi' phi' phi' phi'; (bb) a pair of coordinates of one plane.
///
/// galerkin, V = (1/2) int eps^2 to first order in r:
///
///     p         in:  r (e1 + e.e/2 + e2^2) t             out:  r e2 e3 t
///     p p    in in:  (1/2)[(e1 + e.e/2 + e2^2) S + 3 r e2 V]   out out: (1/2)[(e1 + e.e/2 + e3^2) S + r e2 V]   in out: e2 e3 S + r e3 V
///     p p p  in (bb): (1/2)(r d + e2 D)                  out (bb): (1/2) e3 D
///     p p p p        (1/8) G (bb)(bb)
///
/// quasi_static, V = (1/2) epsbar^2, c = e1 + (e2^2 + e3^2)/2, over the in-plane t and S of pairs of one plane:
///
///     c r t p + (1/2) c S p p + (1/2) r t p S p p + (1/8) (S p p)^2   [+ (1/2) (r t p)^2 where the linear stiffness is the string's]

#include "models/multimode/potential.hpp"

namespace whirl::models {

/// Terms::reduced keeps what is linear in e1, and the quartic part. `coupled`: the sag's linear coupling, that of the uniform tension, is part
/// of V (plain sines); else the linear stiffness has it already.
template <class T>
Potential<T> galerkin_potential(const std::vector<BasisMode<T>>& modes, Terms terms, bool coupled = false,
                                const Moving& moving = {true, true, true}) {
  using F = Factor;
  const detail::Selection<T> sel{modes};
  const SlopeIntegrals<T> I(modes);
  const int n = static_cast<int>(modes.size());
  const bool full = terms == Terms::full;
  Potential<T> v{moving, {}, {}};
  for (int a = 0; a < n; ++a) {
    const auto& m = modes[static_cast<std::size_t>(a)];
    if (!m.symmetric()) continue;
    const T t = m.mean * 8.0;
    if (m.in_plane) v.add({a}, 1, {{F::rE1, t}});
    if (full)
      for (int h : {0, 2}) {
        if (m.in_plane) v.add({a}, h, {{F::r_half_EE, t * 0.5}, {F::r_half_E22, t}});
        else v.add({a}, h, {{F::r_half_E2E3, t}});
      }
  }
  for (int b = 0; b < n; ++b)
    for (int a = 0; a <= b; ++a) {
      const double half = 0.5 * detail::orders(a, b);
      const bool one_plane = sel.same_plane(a, b);
      if (coupled && sel.pulls(a) && sel.pulls(b))
        v.add({a, b}, 0, {{F::r2, modes[static_cast<std::size_t>(a)].mean * modes[static_cast<std::size_t>(b)].mean * (64.0 * half)}});
      if (sel.product({a, b})) {
        const T S = I.two(a, b);
        if (one_plane) v.add({a, b}, 1, {{F::E1, S * half}});
        if (full)
          for (int h : {0, 2}) {
            if (one_plane) v.add({a, b}, h, {{F::half_EE, S * (0.5 * half)}, {sel.in(a) ? F::half_E22 : F::half_E33, S * half}});
            else v.add({a, b}, h, {{F::half_E2E3, S}});
          }
      } else if (full && sel.sag_product({a, b})) {
        const T V = I.two_sag(a, b);
        if (one_plane) v.add({a, b}, 1, {{F::rE2, V * (half * (sel.in(a) ? 3.0 : 1.0))}});
        else v.add({a, b}, 1, {{F::rE3, V}});
      }
    }
  if (full)
    for (int c = 0; c < n; ++c)
      for (int b = 0; b <= c; ++b)
        for (int a = 0; a <= b; ++a) {
          // How often a coordinate stands alone beside a pair of one plane, in plane and out of plane.
          const int in = sel.in(a) + sel.in(b) + sel.in(c);
          const int all = detail::orders(a, b, c), one = detail::orders(a, b);  // a, b out of plane where in = 1
          const double alone_in = in == 3 ? all : in == 1 ? one : 0, alone_out = in == 0 ? all : in == 2 ? detail::orders(b, c) : 0;
          if (sel.sag_product({a, b, c})) {
            if (alone_in > 0) v.add({a, b, c}, 0, {{F::r, I.three_sag(a, b, c) * (0.5 * alone_in)}});
          } else if (sel.product({a, b, c})) {
            v.add({a, b, c}, 1, {{alone_in > 0 ? F::E2 : F::E3, I.three(a, b, c) * (0.5 * (alone_in + alone_out))}});
          }
        }
  for (int d = 0; d < n; ++d)
    for (int c = 0; c <= d; ++c)
      for (int b = 0; b <= c; ++b)
        for (int a = 0; a <= b; ++a) {
          const int in = sel.in(a) + sel.in(b) + sel.in(c) + sel.in(d);
          if (in % 2 == 1 || !sel.product({a, b, c, d})) continue;
          // Out of plane stand first: two of each plane are the pairs (a b)(c d), in either order.
          const int ways = in == 2 ? 2 * detail::orders(a, b) * detail::orders(c, d) : detail::orders(a, b, c, d);
          v.add({a, b, c, d}, 0, {{F::one, I.four(a, b, c, d) * (0.125 * ways)}});
        }
  return v;
}

template <class T>
Potential<T> quasi_static_potential(const std::vector<BasisMode<T>>& modes, Terms terms, bool coupled, const Moving& moving = {true, true, true}) {
  using F = Factor;
  const detail::Selection<T> sel{modes};
  const SlopeIntegrals<T> I(modes);
  const int n = static_cast<int>(modes.size());
  const bool full = terms == Terms::full;
  Potential<T> v{moving, {}, {}};
  std::vector<T> t, S(static_cast<std::size_t>(n * n));
  for (const auto& m : modes) t.push_back(m.mean * 8.0);
  const auto stretches = [&](int a, int b) { return sel.same_plane(a, b) && sel.product({a, b}); };
  const auto at = [n](int a, int b) { return static_cast<std::size_t>(a * n + b); };
  for (int b = 0; b < n; ++b)
    for (int a = 0; a <= b; ++a) S[at(a, b)] = S[at(b, a)] = stretches(a, b) ? I.two(a, b) : T(0.0);
  for (int a = 0; a < n; ++a)
    if (sel.pulls(a)) {
      v.add({a}, 1, {{F::rE1, t[at(0, a)]}});
      if (full)
        for (int h : {0, 2}) v.add({a}, h, {{F::r_half_N, t[at(0, a)] * 0.5}});
    }
  for (int b = 0; b < n; ++b)
    for (int a = 0; a <= b; ++a) {
      const double half = 0.5 * detail::orders(a, b);
      if (coupled && sel.pulls(a) && sel.pulls(b)) v.add({a, b}, 0, {{F::r2, t[at(0, a)] * t[at(0, b)] * half}});
      if (!stretches(a, b)) continue;
      v.add({a, b}, 1, {{F::E1, S[at(a, b)] * half}});
      if (full)
        for (int h : {0, 2}) v.add({a, b}, h, {{F::half_N, S[at(a, b)] * (0.5 * half)}});
    }
  // Sum over the ways to choose the single coordinate, or the two pairs, times the orders within a pair.
  if (full)
    for (int c = 0; c < n; ++c)
      for (int b = 0; b <= c; ++b)
        for (int a = 0; a <= b; ++a) {
          T sum(0.0);
          bool any = false;
          const auto alone = [&](int i, int j, int k) {
            if (!sel.pulls(i) || !stretches(j, k)) return;
            any = true;
            sum += t[at(0, i)] * S[at(j, k)];
          };
          alone(a, b, c);
          alone(b, a, c);
          alone(c, a, b);
          if (any) v.add({a, b, c}, 0, {{F::r, sum * (0.5 * detail::orders(a, b, c) / 3.0)}});
        }
  for (int d = 0; d < n; ++d)
    for (int c = 0; c <= d; ++c)
      for (int b = 0; b <= c; ++b)
        for (int a = 0; a <= b; ++a) {
          T sum(0.0);
          bool any = false;
          const auto pairs = [&](int i, int j, int k, int l) {
            if (!stretches(i, j) || !stretches(k, l)) return;
            any = true;
            sum += S[at(i, j)] * S[at(k, l)];
          };
          pairs(a, b, c, d);
          pairs(a, c, b, d);
          pairs(a, d, b, c);
          if (any) v.add({a, b, c, d}, 0, {{F::one, sum * (0.125 * detail::orders(a, b, c, d) / 3.0)}});
        }
  return v;
}

}  // namespace whirl::models
