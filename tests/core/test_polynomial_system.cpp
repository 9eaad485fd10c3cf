// Every root of polynomial systems whose number of roots is known.
#include <catch2/catch.hpp>
#include <functional>
#include <random>

#include "core/polynomial_system.hpp"

using namespace whirl;

namespace {

double largest_residual(const PolynomialSystem& s, const Eigen::VectorXcd& x) {
  double worst = 0.0;
  for (const auto& equation : s.equations) {
    std::complex<double> sum = 0.0;
    double size = 0.0;
    for (const auto& m : equation) {
      std::complex<double> product = m.coefficient;
      for (std::size_t v = 0; v < m.powers.size(); ++v) product *= std::pow(x[static_cast<Eigen::Index>(v)], m.powers[v]);
      sum += product;
      size = std::max(size, std::abs(product));
    }
    worst = std::max(worst, std::abs(sum) / size);
  }
  return worst;
}

// Every monomial up to a degree, with random real coefficients.
PolynomialSystem dense(int unknowns, int degree, std::mt19937& random) {
  std::normal_distribution<double> normal;
  PolynomialSystem s;
  s.equations.resize(static_cast<std::size_t>(unknowns));
  std::vector<int> powers(static_cast<std::size_t>(unknowns), 0);
  const std::function<void(std::size_t, int)> fill = [&](std::size_t v, int left) {
    if (v == powers.size()) {
      for (auto& equation : s.equations) equation.push_back({normal(random), powers});
      return;
    }
    for (powers[v] = 0; powers[v] <= left; ++powers[v]) fill(v + 1, left - powers[v]);
    powers[v] = 0;
  };
  fill(0, degree);
  return s;
}

}  // namespace

TEST_CASE("dense systems have as many roots as the product of their degrees") {
  std::mt19937 random(5);
  const int cases[][2] = {{1, 3}, {1, 7}, {2, 2}, {2, 3}, {2, 5}, {3, 3}, {4, 2}};
  for (const auto& [n, degree] : cases) {
    const PolynomialSystem s = dense(n, degree, random);
    const PolynomialRoots r = PolynomialSolver(s, std::vector<int>(static_cast<std::size_t>(n), 0)).solve(s);
    CAPTURE(n, degree, r.failed);
    CHECK(r.finite.size() == static_cast<std::size_t>(std::lround(std::pow(degree, n))));
    for (const auto& x : r.finite) CHECK(largest_residual(s, x) < 1e-9);
  }
}

TEST_CASE("two groups: bilinear systems, and the eigenvectors of a matrix") {
  // A v = lambda v with a'v = 1: n eigenvalues in groups {v}, {lambda}, where the degrees alone allow 2^n.
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const int n = 4;
  PolynomialSystem s;
  for (int e = 0; e < n; ++e) {
    s.equations.emplace_back();
    for (int v = 0; v < n; ++v) {
      std::vector<int> powers(n + 1, 0);
      powers[static_cast<std::size_t>(v)] = 1;
      s.equations.back().push_back({normal(random), powers});
      if (v != e) continue;
      powers[n] = 1;
      s.equations.back().push_back({-1.0, powers});
    }
  }
  s.equations.emplace_back();
  s.equations.back().push_back({-1.0, std::vector<int>(n + 1, 0)});
  for (int v = 0; v < n; ++v) {
    std::vector<int> powers(n + 1, 0);
    powers[static_cast<std::size_t>(v)] = 1;
    s.equations.back().push_back({normal(random), powers});
  }
  const std::vector<int> group = {0, 0, 0, 0, 1};
  CHECK(multihomogeneous_bezout(s, group, 100) == n);
  CHECK(multihomogeneous_bezout(s, {0, 0, 0, 0, 0}, 100) == 16);
  CHECK(multihomogeneous_bezout(s, group, 3) == -1);
  CHECK(PolynomialSolver(s, group).solve(s).finite.size() == n);
}

TEST_CASE("roots that leave to infinity are counted as such") {
  // x^2 + x y = 1, x + y = 2: only x = 1/2.
  const PolynomialSystem s{{{{1.0, {2, 0}}, {1.0, {1, 1}}, {-1.0, {0, 0}}}, {{1.0, {1, 0}}, {1.0, {0, 1}}, {-2.0, {0, 0}}}}};
  const PolynomialRoots r = PolynomialSolver(s, {0, 0}).solve(s);
  REQUIRE(r.finite.size() == 1);
  CHECK(std::abs(r.finite[0][0] - 0.5) < 1e-12);
  CHECK(r.at_infinity + r.failed == r.paths - 1);
}

TEST_CASE("polynomial systems: shapes that do not fit are refused") {
  const PolynomialSystem s{{{{1.0, {2}}, {-1.0, {0}}}}}, other{{{{1.0, {3}}, {-1.0, {0}}}}};
  CHECK_THROWS_AS(PolynomialSolver(s, {0, 0}), std::invalid_argument);
  CHECK_THROWS_AS(PolynomialSolver(s, {-1}), std::invalid_argument);
  CHECK_THROWS_AS(PolynomialSolver(s, {0}).solve(other), std::invalid_argument);
  CHECK_THROWS_AS(PolynomialSolver(s, {0}, {.tolerance = 0.0}), std::invalid_argument);
}
