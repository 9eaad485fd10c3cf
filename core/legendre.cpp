#include "core/legendre.hpp"

#include <cmath>
#include <map>
#include <mutex>
#include <numbers>

namespace whirl {
namespace {

GaussRule newton_rule(int n) {
  GaussRule rule{Vector(n), Vector(n)};
  for (int i = 0; i < (n + 1) / 2; ++i) {
    double t = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1.0;
    for (int step = 0; step < 20; ++step) {
      double p = 1.0, before = 0.0;
      for (int k = 1; k <= n; ++k) {
        const double next = ((2.0 * k - 1.0) * t * p - (k - 1.0) * before) / k;
        before = p;
        p = next;
      }
      slope = n * (t * p - before) / (t * t - 1.0);
      const double change = p / slope;
      t -= change;
      if (std::abs(change) < 1e-15) break;
    }
    if (2 * i + 1 == n) t = 0.0;
    rule.nodes[i] = -t;
    rule.nodes[n - 1 - i] = t;
    rule.weights[i] = rule.weights[n - 1 - i] = 2.0 / ((1.0 - t * t) * slope * slope);
  }
  return rule;
}

void require_count(bool enough, const char* what) {
  if (!enough) throw std::invalid_argument(what);
}

}  // namespace

GaussRule gauss_legendre(int n) {
  require_count(n > 0, "a Gauss rule has at least one point");
  static std::map<int, GaussRule> kept;
  static std::mutex guard;
  const std::lock_guard lock(guard);
  auto it = kept.find(n);
  if (it == kept.end()) it = kept.emplace(n, newton_rule(n)).first;
  return it->second;
}

Matrix legendre_values(In t, int count) {
  require_count(count > 0, "a table of Legendre polynomials has at least one column");
  Matrix p(t.size(), count);
  p.col(0).setOnes();
  if (count > 1) p.col(1) = t;
  // (2 k + 1) t first: with the products in another order the stiffness of slack guys loses a digit.
  for (int k = 1; k + 1 < count; ++k) p.col(k + 1) = (((2.0 * k + 1.0) * t).cwiseProduct(p.col(k)) - double(k) * p.col(k - 1)) / (k + 1.0);
  return p;
}

Matrix dirichlet_values(const Matrix& legendre, int count) {
  require_count(legendre.cols() >= count + 2, "phi_k needs P_0 ... P_{k+2}");
  Matrix f(legendre.rows(), count);
  for (int k = 0; k < count; ++k) f.col(k) = (legendre.col(k) - legendre.col(k + 2)) / std::sqrt(4.0 * k + 6.0);
  return f;
}

Matrix dirichlet_slopes(const Matrix& legendre, int count) {
  require_count(legendre.cols() >= count + 1, "the slope of phi_k needs P_{k+1}");
  Matrix f(legendre.rows(), count);
  for (int k = 0; k < count; ++k) f.col(k) = -std::sqrt(0.5 * (2.0 * k + 3.0)) * legendre.col(k + 1);
  return f;
}

Matrix legendre_integrals(const Matrix& legendre, int count) {
  require_count(legendre.cols() >= count + 1, "the integral of P_k needs P_{k+1}");
  Matrix f(legendre.rows(), count);
  f.col(0) = legendre.col(1) + legendre.col(0);
  for (int k = 1; k < count; ++k) f.col(k) = (legendre.col(k + 1) - legendre.col(k - 1)) / (2.0 * k + 1.0);
  return f;
}

Matrix dirichlet_integrals(const Matrix& legendre, int count) {
  const Matrix p = legendre_integrals(legendre, count + 2);
  Matrix f(legendre.rows(), count);
  for (int k = 0; k < count; ++k) f.col(k) = (p.col(k) - p.col(k + 2)) / std::sqrt(4.0 * k + 6.0);
  return f;
}

}  // namespace whirl
