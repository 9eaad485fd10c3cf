#pragma once
/// Forward-mode dual numbers: a value and N slopes, carried exactly through arithmetic.
///
///     f(x + e_i) = f(x) + f'(x) e_i,   e_i e_j = 0
///
/// Eager (no expression templates), so a generic model may use `S` for every local. Nesting gives higher derivatives:
/// `Dual<Dual<double, 1>, 8>` carries the Hessian along one vector. `sqrt` at 0 has an infinite slope, as in the reals.
///
///     using D = Dual<double, 2>;
///     D x = seed<D>(3.0, 0), y = seed<D>(2.0, 1);
///     D f = x * x * y;              // f.v = 18, f.d = {12, 9}

#include <array>
#include <cmath>
#include <type_traits>

namespace whirl {

template <class T, int N>
struct Dual {
  T v{};
  std::array<T, N> d{};

  Dual() = default;
  Dual(double value) : v(value) {}
  template <class U>
  requires(std::is_same_v<U, T> && !std::is_same_v<U, double>) Dual(const U& value) : v(value) {}

  Dual& operator+=(const Dual& o) { return *this = *this + o; }
  Dual& operator-=(const Dual& o) { return *this = *this - o; }
  Dual& operator*=(const Dual& o) { return *this = *this * o; }
  Dual& operator/=(const Dual& o) { return *this = *this / o; }

  friend Dual operator+(const Dual& a) { return a; }
  friend Dual operator-(const Dual& a) {
    Dual r;
    r.v = -a.v;
    for (int i = 0; i < N; ++i) r.d[i] = -a.d[i];
    return r;
  }
  friend Dual operator+(const Dual& a, const Dual& b) {
    Dual r;
    r.v = a.v + b.v;
    for (int i = 0; i < N; ++i) r.d[i] = a.d[i] + b.d[i];
    return r;
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    Dual r;
    r.v = a.v - b.v;
    for (int i = 0; i < N; ++i) r.d[i] = a.d[i] - b.d[i];
    return r;
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual r;
    r.v = a.v * b.v;
    for (int i = 0; i < N; ++i) r.d[i] = a.d[i] * b.v + a.v * b.d[i];
    return r;
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T inverse = T(1.0) / b.v;
    Dual r;
    r.v = a.v * inverse;
    for (int i = 0; i < N; ++i) r.d[i] = (a.d[i] - r.v * b.d[i]) * inverse;
    return r;
  }
  friend Dual operator+(Dual a, double b) {
    a.v += b;
    return a;
  }
  friend Dual operator+(double a, Dual b) {
    b.v += a;
    return b;
  }
  friend Dual operator-(Dual a, double b) {
    a.v -= b;
    return a;
  }
  friend Dual operator-(double a, const Dual& b) { return -b + a; }
  friend Dual operator*(Dual a, double b) {
    a.v *= b;
    for (int i = 0; i < N; ++i) a.d[i] *= b;
    return a;
  }
  friend Dual operator*(double a, const Dual& b) { return b * a; }
  friend Dual operator/(const Dual& a, double b) { return a * (1.0 / b); }
  friend Dual operator/(double a, const Dual& b) { return Dual(a) / b; }

  friend bool operator<(const Dual& a, const Dual& b) { return a.v < b.v; }
  friend bool operator>(const Dual& a, const Dual& b) { return a.v > b.v; }
  friend bool operator<(const Dual& a, double b) { return a.v < b; }
  friend bool operator>(const Dual& a, double b) { return a.v > b; }
};

/// The number behind any depth of duals.
inline double value_of(double x) { return x; }
template <class T, int N>
double value_of(const Dual<T, N>& x) {
  return value_of(x.v);
}

/// An independent variable: value x, slope 1 in direction i.
template <class D>
D seed(double x, int i) {
  D r(x);
  r.d[static_cast<std::size_t>(i)] = 1.0;
  return r;
}

namespace detail {
// f(a) with f(a.v) and f'(a.v) known.
template <class T, int N>
Dual<T, N> chain(const Dual<T, N>& a, const T& f, const T& slope) {
  Dual<T, N> r;
  r.v = f;
  for (int i = 0; i < N; ++i) r.d[i] = slope * a.d[i];
  return r;
}
}  // namespace detail

template <class T, int N>
Dual<T, N> sqrt(const Dual<T, N>& a) {
  using std::sqrt;
  const T f = sqrt(a.v);
  return detail::chain(a, f, T(0.5) / f);
}
template <class T, int N>
Dual<T, N> exp(const Dual<T, N>& a) {
  using std::exp;
  const T f = exp(a.v);
  return detail::chain(a, f, f);
}
template <class T, int N>
Dual<T, N> log(const Dual<T, N>& a) {
  using std::log;
  return detail::chain(a, T(log(a.v)), T(1.0) / a.v);
}
template <class T, int N>
Dual<T, N> sin(const Dual<T, N>& a) {
  using std::cos;
  using std::sin;
  return detail::chain(a, T(sin(a.v)), T(cos(a.v)));
}
template <class T, int N>
Dual<T, N> cos(const Dual<T, N>& a) {
  using std::cos;
  using std::sin;
  return detail::chain(a, T(cos(a.v)), T(-sin(a.v)));
}
template <class T, int N>
Dual<T, N> tan(const Dual<T, N>& a) {
  using std::tan;
  const T f = tan(a.v);
  return detail::chain(a, f, T(1.0) + f * f);
}
template <class T, int N>
Dual<T, N> sinh(const Dual<T, N>& a) {
  using std::cosh;
  using std::sinh;
  return detail::chain(a, T(sinh(a.v)), T(cosh(a.v)));
}
template <class T, int N>
Dual<T, N> cosh(const Dual<T, N>& a) {
  using std::cosh;
  using std::sinh;
  return detail::chain(a, T(cosh(a.v)), T(sinh(a.v)));
}
template <class T, int N>
Dual<T, N> tanh(const Dual<T, N>& a) {
  using std::tanh;
  const T f = tanh(a.v);
  return detail::chain(a, f, T(1.0) - f * f);
}
template <class T, int N>
Dual<T, N> atan(const Dual<T, N>& a) {
  using std::atan;
  return detail::chain(a, T(atan(a.v)), T(1.0) / (T(1.0) + a.v * a.v));
}
template <class T, int N>
Dual<T, N> asin(const Dual<T, N>& a) {
  using std::asin;
  using std::sqrt;
  return detail::chain(a, T(asin(a.v)), T(1.0) / sqrt(T(1.0) - a.v * a.v));
}
template <class T, int N>
Dual<T, N> acos(const Dual<T, N>& a) {
  using std::acos;
  using std::sqrt;
  return detail::chain(a, T(acos(a.v)), T(-1.0) / sqrt(T(1.0) - a.v * a.v));
}
template <class T, int N>
Dual<T, N> abs(const Dual<T, N>& a) {
  return value_of(a) < 0.0 ? -a : a;
}

/// x^k for whole k by repeated multiplication; exact slopes at x = 0.
template <class S>
S power(const S& x, int k) {
  if (k < 0) return S(1.0) / power(x, -k);
  S r(1.0), b = x;
  for (; k > 0; k >>= 1) {
    if (k & 1) r = r * b;
    if (k > 1) b = b * b;
  }
  return r;
}

/// x^y for real y, x > 0.
template <class T, int N>
Dual<T, N> pow(const Dual<T, N>& x, const Dual<T, N>& y) {
  return exp(y * log(x));
}

}  // namespace whirl
