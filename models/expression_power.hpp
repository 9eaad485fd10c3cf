#pragma once
/// Powers as vector fields given as text mean them, in any depth of duals: every derivative that exists, and nothing spoilt by one that does not.
///
///     x > 0             x^y = e^(y log x)
///     x < 0, y whole    the product; beside a whole y there is no real power, so slopes along y are NaN
///     x = 0             one-sided, from x > 0: 0 for y > 0, 1 for y = 0, infinite for y < 0; slopes likewise
///     otherwise         NaN
///
/// With P(x, y, k) = x^y (log x)^k derivatives stay within one family:
///
///     dP/dx = y P(x, y-1, k) + k P(x, y-1, k-1),    dP/dy = P(x, y, k+1)
///
/// A slope of zero is zero whatever it multiplies: an exponent that does not move never meets log x, a base that does not move no infinite slope.

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/dual.hpp"

namespace whirl::models::detail {

inline bool is_zero(double x) { return x == 0.0; }
template <class T, int N>
bool is_zero(const Dual<T, N>& x) {
  return is_zero(x.v) && std::all_of(x.d.begin(), x.d.end(), [](const T& slope) { return is_zero(slope); });
}

template <class T>
T times(const T& a, const T& b) {
  return is_zero(a) || is_zero(b) ? T(0.0) : T(a * b);
}

/// f(a) with f(a.v) and f'(a.v) known, f' perhaps infinite.
template <class T, int N>
Dual<T, N> one_sided(const Dual<T, N>& a, const T& f, const T& slope) {
  Dual<T, N> r = whirl::detail::chain(a, f, slope);
  if (!std::isfinite(value_of(slope)))
    for (int i = 0; i < N; ++i) r.d[i] = times(slope, a.d[i]);
  return r;
}

inline double root(double x) { return std::sqrt(x); }
template <class T, int N>
Dual<T, N> root(const Dual<T, N>& x) {
  const T f = root(x.v);
  return one_sided(x, f, T(T(0.5) / f));
}

/// x^y for a number y.
inline double real_power(double x, double y) { return std::pow(x, y); }
template <class T, int N>
Dual<T, N> real_power(const Dual<T, N>& x, double y) {
  if (y == 0.0) return Dual<T, N>(1.0);
  return one_sided(x, T(real_power(x.v, y)), T(real_power(x.v, y - 1.0) * y));
}

/// P(x, y, k).
inline double log_power(double x, double y, int k) {
  if (k == 0) return std::pow(x == 0.0 ? 0.0 : x, y);  // -0 is 0
  if (x < 0.0) return std::numeric_limits<double>::quiet_NaN();
  if (x > 0.0) return std::pow(x, y) * power(std::log(x), k);
  return y > 0.0 ? 0.0 : power(-std::numeric_limits<double>::infinity(), k);
}
template <class T, int N>
Dual<T, N> log_power(const Dual<T, N>& x, const Dual<T, N>& y, int k) {
  const auto moves = [](const Dual<T, N>& a) { return std::any_of(a.d.begin(), a.d.end(), [](const T& slope) { return !is_zero(slope); }); };
  Dual<T, N> r;
  r.v = log_power(x.v, y.v, k);
  if (moves(x)) {
    T slope = times(y.v, T(log_power(x.v, T(y.v - 1.0), k)));
    if (k > 0) slope = slope + log_power(x.v, T(y.v - 1.0), k - 1) * static_cast<double>(k);
    for (int i = 0; i < N; ++i) r.d[i] = times(slope, x.d[i]);
  }
  if (moves(y)) {
    const T slope = log_power(x.v, y.v, k + 1);
    for (int i = 0; i < N; ++i) r.d[i] = r.d[i] + times(slope, y.d[i]);
  }
  return r;
}

}  // namespace whirl::models::detail
