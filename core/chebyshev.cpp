#include "core/chebyshev.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace whirl {

ChebyshevGrid::ChebyshevGrid(int n, double a, double b) : nodes(n + 1), derivative(n + 1, n + 1) {
  if (n < 1) throw std::invalid_argument(fmt::format("Chebyshev grid: n must be >= 1, got {}", n));
  const double half = 0.5 * (b - a), angle = std::numbers::pi / (2.0 * n);
  for (int j = 0; j <= n; ++j) nodes[j] = 0.5 * (a + b) - half * std::cos(2.0 * angle * j);
  const auto weight = [n](int j) { return (j == 0 || j == n ? 2.0 : 1.0) * (j % 2 == 0 ? 1.0 : -1.0); };
  for (int i = 0; i <= n; ++i) {
    derivative(i, i) = 0.0;
    for (int j = 0; j <= n; ++j)  // x_i - x_j as a product of sines: no cancellation
      if (i != j) derivative(i, j) = weight(i) / weight(j) / (2.0 * half * std::sin(angle * (i + j)) * std::sin(angle * (i - j)));
    derivative(i, i) = -derivative.row(i).sum();
  }
}

}  // namespace whirl
