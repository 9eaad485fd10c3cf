#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/polynomial.hpp"

using namespace whirl;

namespace {

// Coefficients of the product of (x - r).
std::vector<double> with_roots(const std::vector<double>& roots) {
  std::vector<double> c = {1.0};
  for (const double r : roots) {
    c.insert(c.begin(), 0.0);
    for (std::size_t i = 0; i + 1 < c.size(); ++i) c[i] -= r * c[i + 1];
  }
  return c;
}

bool has(const std::vector<std::complex<double>>& roots, std::complex<double> r, double within) {
  return std::any_of(roots.begin(), roots.end(), [&](const auto& z) { return std::abs(z - r) <= within * std::abs(r); });
}

}  // namespace

TEST_CASE("roots of any size, twice or at zero") {
  for (const auto& wanted :
       std::vector<std::vector<double>>{{1e-15, 2.0, -3e9}, {1e-12, -1e-8, 1e-4, 1.0, 1e4, -1e8, 1e12}, {0.0, 0.0, 5.0, -1e-9}}) {
    const auto roots = polynomial_roots(with_roots(wanted));
    REQUIRE(roots.size() == wanted.size());
    for (const double r : wanted) CHECK(has(roots, r, 1e-12));
  }
  const auto twice = polynomial_roots(with_roots({1e-6, 1e-6, 7.0}));
  CHECK(has(twice, 7.0, 1e-14));
  CHECK(std::count_if(twice.begin(), twice.end(), [](const auto& z) { return std::abs(z - 1e-6) < 1e-13; }) == 2);  // half the digits
  // one real root beside a far larger complex pair, as the in-plane balance of a faint load has: y ((2091 + 55782 y)^2 + 32.5^2) = 2e-8
  // 32^2)
  const auto faint = polynomial_roots({-2e-8, 32.5 * 32.5 + 2090.8 * 2090.8, 2.0 * 55782.2 * 2090.8, 55782.2 * 55782.2});
  CHECK(has(faint, 2e-8 / (32.5 * 32.5 + 2090.8 * 2090.8), 1e-12));
  CHECK(has(faint, {-2090.8 / 55782.2, 32.5 / 55782.2}, 1e-6));
}
