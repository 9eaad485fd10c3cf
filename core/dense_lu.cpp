#include "core/dense_lu.hpp"

#include <cmath>
#include <utility>

namespace whirl {
namespace {

// The compiler unrolls loops of known length only where it is asked to; it takes a third of the time off.

template <int N>
bool factor(const double* from, Eigen::Index stride, double* a, int* pivot) {
  bool odd = false;
#pragma GCC unroll 8
  for (int j = 0; j < N; ++j)
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i) a[i + N * j] = from[i + stride * j];
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k) {
    int best = k;
#pragma GCC unroll 8
    for (int i = k + 1; i < N; ++i)
      if (std::abs(a[i + N * k]) > std::abs(a[best + N * k])) best = i;
    pivot[k] = best;
    if (best != k) {
      odd = !odd;
#pragma GCC unroll 8
      for (int j = 0; j < N; ++j) std::swap(a[k + N * j], a[best + N * j]);
    }
    const double inverse = 1.0 / a[k + N * k];
    a[k + N * k] = inverse;
#pragma GCC unroll 8
    for (int i = k + 1; i < N; ++i) a[i + N * k] *= inverse;
#pragma GCC unroll 8
    for (int j = k + 1; j < N; ++j) {
      const double t = a[k + N * j];
#pragma GCC unroll 8
      for (int i = k + 1; i < N; ++i) a[i + N * j] -= a[i + N * k] * t;
    }
  }
  return odd;
}

template <int N>
void substitute(const double* a, const int* pivot, const double* b, double* out) {
  double x[N];
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) x[i] = b[i];
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k) std::swap(x[k], x[pivot[k]]);
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k)
#pragma GCC unroll 8
    for (int i = k + 1; i < N; ++i) x[i] -= a[i + N * k] * x[k];
#pragma GCC unroll 8
  for (int k = N - 1; k >= 0; --k) {
    x[k] *= a[k + N * k];
#pragma GCC unroll 8
    for (int i = 0; i < k; ++i) x[i] -= a[i + N * k] * x[k];
  }
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) out[i] = x[i];
}

// Two right-hand sides side by side.
template <int N>
void substitute_two(const double* a, const int* pivot, const double* b, const double* d, double* out, double* out2) {
  double x[N][2];
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) {
    x[i][0] = b[i];
    x[i][1] = d[i];
  }
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k) {
    std::swap(x[k][0], x[pivot[k]][0]);
    std::swap(x[k][1], x[pivot[k]][1]);
  }
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k)
#pragma GCC unroll 8
    for (int i = k + 1; i < N; ++i)
      for (int s = 0; s < 2; ++s) x[i][s] -= a[i + N * k] * x[k][s];
#pragma GCC unroll 8
  for (int k = N - 1; k >= 0; --k) {
    for (int s = 0; s < 2; ++s) x[k][s] *= a[k + N * k];
#pragma GCC unroll 8
    for (int i = 0; i < k; ++i)
      for (int s = 0; s < 2; ++s) x[i][s] -= a[i + N * k] * x[k][s];
  }
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) {
    out[i] = x[i][0];
    out2[i] = x[i][1];
  }
}

template <int N>
void substitute_transposed(const double* a, const int* pivot, const double* b, double* out) {
  double x[N];
#pragma GCC unroll 8
  for (int k = 0; k < N; ++k) {
    double t = b[k];
#pragma GCC unroll 8
    for (int i = 0; i < k; ++i) t -= a[i + N * k] * x[i];
    x[k] = t * a[k + N * k];
  }
#pragma GCC unroll 8
  for (int k = N - 1; k >= 0; --k)
#pragma GCC unroll 8
    for (int i = k + 1; i < N; ++i) x[k] -= a[i + N * k] * x[i];
#pragma GCC unroll 8
  for (int k = N - 1; k >= 0; --k) std::swap(x[k], x[pivot[k]]);
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) out[i] = x[i];
}

// Calls f with the size as a constant.
template <class F>
void with_size(int n, F&& f) {
  switch (n) {
    case 1:
      return f(std::integral_constant<int, 1>());
    case 2:
      return f(std::integral_constant<int, 2>());
    case 3:
      return f(std::integral_constant<int, 3>());
    case 4:
      return f(std::integral_constant<int, 4>());
    case 5:
      return f(std::integral_constant<int, 5>());
    case 6:
      return f(std::integral_constant<int, 6>());
    case 7:
      return f(std::integral_constant<int, 7>());
    case 8:
      return f(std::integral_constant<int, 8>());
    default:
      return;
  }
}

}  // namespace

void DenseLu::compute(MatrixIn a) {
  n_ = static_cast<int>(a.rows());
  if (n_ > small) {
    large_.compute(a);
    return;
  }
  with_size(n_, [&](auto size) { odd_ = factor<size()>(a.data(), a.outerStride(), a_, pivot_); });
}

void DenseLu::solve_small(const double* b, double* x) const {
  with_size(n_, [&](auto size) { substitute<size()>(a_, pivot_, b, x); });
}

void DenseLu::solve(In b, Out x) const {
  if (n_ > small) x = large_.solve(b);
  else solve_small(b.data(), x.data());
}

void DenseLu::solve(const Vector& b, Vector& x) const {
  if (n_ > small) x = large_.solve(b);
  else solve_small(b.data(), x.data());
}

template <class B, class X>
void DenseLu::solve_pair(const B& b, const B& d, X& x, X& y) const {
  if (n_ > small) {
    x = large_.solve(b);
    y = large_.solve(d);
    return;
  }
  with_size(n_, [&](auto size) { substitute_two<size()>(a_, pivot_, b.data(), d.data(), x.data(), y.data()); });
}

void DenseLu::solve_two(In b, In d, Out x, Out y) const { solve_pair(b, d, x, y); }
void DenseLu::solve_two(const Vector& b, const Vector& d, Vector& x, Vector& y) const { solve_pair(b, d, x, y); }

void DenseLu::solve_transposed(In b, Out x) const {
  if (n_ > small) x = large_.transpose().solve(b);
  else with_size(n_, [&](auto size) { substitute_transposed<size()>(a_, pivot_, b.data(), x.data()); });
}

bool DenseLu::negative_determinant() const {
  bool negative = n_ > small ? large_.permutationP().determinant() < 0 : odd_;
  for (int i = 0; i < n_; ++i) negative ^= (n_ > small ? large_.matrixLU()(i, i) : a_[i + n_ * i]) < 0.0;
  return negative;
}

}  // namespace whirl
