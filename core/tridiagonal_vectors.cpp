#include "core/tridiagonal_vectors.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace whirl {
namespace {

// T - mu = P L U, partial pivoting: rows of U hold three entries, L one multiplier a row.
class ShiftedFactors {
 public:
  explicit ShiftedFactors(Eigen::Index n) : u_(n), v_(n), w_(n), l_(n), swapped_(n) {}

  void factor(In d, In e, double mu, double tiny) {
    const auto n = d.size();
    double pivot = d[0] - mu, next = n > 1 ? e[0] : 0.0;  // the row under elimination
    for (Eigen::Index i = 0; i + 1 < n; ++i) {
      const double below = e[i], diagonal = d[i + 1] - mu, right = i + 2 < n ? e[i + 1] : 0.0;
      swapped_[i] = std::abs(below) > std::abs(pivot);
      if (swapped_[i]) {
        l_[i] = pivot / below;
        u_[i] = below;
        v_[i] = diagonal;
        w_[i] = right;
        pivot = next - l_[i] * diagonal;
        next = -l_[i] * right;
      } else {
        u_[i] = std::abs(pivot) > tiny ? pivot : tiny;
        v_[i] = next;
        w_[i] = 0.0;
        l_[i] = below / u_[i];
        pivot = diagonal - l_[i] * next;
        next = right;
      }
    }
    u_[n - 1] = std::abs(pivot) > tiny ? pivot : tiny;
    v_[n - 1] = w_[n - 1] = 0.0;
  }

  void solve_in_place(Out y, bool forward) const {
    const auto n = y.size();
    if (forward)
      for (Eigen::Index i = 0; i + 1 < n; ++i) {
        if (swapped_[i]) std::swap(y[i], y[i + 1]);
        y[i + 1] -= l_[i] * y[i];
      }
    y[n - 1] /= u_[n - 1];
    if (n > 1) y[n - 2] = (y[n - 2] - v_[n - 2] * y[n - 1]) / u_[n - 2];
    for (Eigen::Index i = n - 3; i >= 0; --i) y[i] = (y[i] - v_[i] * y[i + 1] - w_[i] * y[i + 2]) / u_[i];
  }

 private:
  Vector u_, v_, w_, l_;
  Eigen::Array<bool, Eigen::Dynamic, 1> swapped_;
};

double residual(In d, In e, double mu, In z) {
  const auto n = d.size();
  double worst = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double row = (d[i] - mu) * z[i] + (i > 0 ? e[i - 1] * z[i - 1] : 0.0) + (i + 1 < n ? e[i] * z[i + 1] : 0.0);
    worst = std::max(worst, std::abs(row));
  }
  return worst;
}

}  // namespace

bool tridiagonal_vectors(In d, In e, In mu, Matrix& z) {
  const auto n = d.size(), wanted = mu.size();
  const double norm = d.cwiseAbs().maxCoeff() + (n > 1 ? 2.0 * e.cwiseAbs().maxCoeff() : 0.0);
  const double rounding = std::numeric_limits<double>::epsilon() * norm;
  z.resize(n, wanted);
  ShiftedFactors factors(n);
  Eigen::Index cluster = 0;  // first vector the present one is kept orthogonal to
  double shift = 0.0;
  for (Eigen::Index j = 0; j < wanted; ++j) {
    while (cluster < j && mu[cluster] - mu[j] > 1e-3 * norm) ++cluster;
    shift = j > 0 && shift - mu[j] < 10.0 * rounding ? shift - 10.0 * rounding : mu[j];
    factors.factor(d, e, shift, rounding);
    auto y = z.col(j);
    for (Eigen::Index i = 0; i < n; ++i) y[i] = 1.0 + 0.3 * std::sin(1.7 * double(i) * double(j + 1));  // no symmetry
    for (int step = 0; step < 4; ++step) {
      factors.solve_in_place(y, step > 0);
      y /= y.cwiseAbs().maxCoeff();
      for (Eigen::Index i = cluster; i < j; ++i) y -= z.col(i).dot(y) * z.col(i);
      y.normalize();
    }
    if (!(residual(d, e, shift, y) < 100.0 * std::sqrt(double(n)) * rounding)) return false;
  }
  return true;
}

}  // namespace whirl
