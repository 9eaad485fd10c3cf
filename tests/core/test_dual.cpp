#include <catch2/catch.hpp>

#include "core/dual.hpp"
#include "core/dual_problem.hpp"
#include "core/polynomial.hpp"
#include "core/quadrature.hpp"

using namespace whirl;

namespace {
template <class S>
S mixture(const S& x, const S& y) {
  using std::atan, std::cos, std::cosh, std::exp, std::log, std::sin, std::sinh, std::sqrt, std::tan, std::tanh, std::asin, std::acos;
  return sin(x) * exp(y) + sqrt(x * x + 2.0) / (y + 3.0) - log(x + 4.0) * cos(y * 2.0) + power(x, 3) * tan(y) + atan(x) - sinh(y) * cosh(x) +
         tanh(x * y) + asin(x * 0.3) * acos(y * 0.2) + 1.0 / (x + 5.0) - (2.0 - y) * 3.0 + abs(x - 10.0);
}
double plain(double x, double y) {
  return std::sin(x) * std::exp(y) + std::sqrt(x * x + 2.0) / (y + 3.0) - std::log(x + 4.0) * std::cos(y * 2.0) + x * x * x * std::tan(y) +
         std::atan(x) - std::sinh(y) * std::cosh(x) + std::tanh(x * y) + std::asin(x * 0.3) * std::acos(y * 0.2) + 1.0 / (x + 5.0) - (2.0 - y) * 3.0 +
         std::abs(x - 10.0);
}
struct Cubic {
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    r[0] = u[2] + u[0] * u[1] - u[0] * u[0] * u[0];
    r[1] = u[0] * u[1] * u[2] - u[1] * u[1];
  }
};
}  // namespace

TEST_CASE("duals carry first and second slopes exactly") {
  using D = Dual<double, 2>;
  const double x = 0.7, y = -0.4, h = 1e-5;
  const D f = mixture(seed<D>(x, 0), seed<D>(y, 1));
  CHECK(f.v == Approx(plain(x, y)).epsilon(1e-15));
  CHECK(f.d[0] == Approx((plain(x + h, y) - plain(x - h, y)) / (2 * h)).epsilon(1e-8).margin(1e-9));  // central difference of numbers of order 10
  CHECK(f.d[1] == Approx((plain(x, y + h) - plain(x, y - h)) / (2 * h)).epsilon(1e-8));
  using A = Dual<double, 1>;
  using DD = Dual<A, 1>;
  DD a(seed<A>(x, 0)), b(A{y});
  b.d[0].v = 1.0;  // mixed second derivative
  const auto slope = [&](double yy) { return mixture(seed<D>(x, 0), seed<D>(yy, 1)).d[0]; };
  CHECK(mixture(a, b).d[0].d[0] == Approx((slope(y + h) - slope(y - h)) / (2 * h)).epsilon(1e-8));
}

TEST_CASE("power keeps its slope at zero") {
  using D = Dual<double, 1>;
  CHECK(power(seed<D>(0.0, 0), 1).d[0] == 1.0);
  CHECK(power(seed<D>(0.0, 0), 2).d[0] == 0.0);
  CHECK(power(seed<D>(2.0, 0), -2).d[0] == Approx(-0.25).epsilon(1e-15));
}

TEST_CASE("a dual problem offers Jacobian, second and third derivatives") {
  const DualProblem<Cubic> f({}, 2, 1, true);
  const Eigen::Vector3d u(0.5, -0.3, 0.2), v(1.0, 2.0, -1.0), w(0.3, 0.1, 0.7);
  Matrix j(2, 3), h(2, 3);
  f.jacobian(u, j);
  Matrix exact(2, 3);
  exact << u[1] - 3 * u[0] * u[0], u[0], 1, u[1] * u[2], u[0] * u[2] - 2 * u[1], u[0] * u[1];
  CHECK((j - exact).norm() < 1e-15);
  f.second(u, v, h);
  // r0: v0 w1 + v1 w0 - 6 u0 v0 w0
  CHECK((h * w)[0] == Approx(v[0] * w[1] + v[1] * w[0] - 6 * u[0] * v[0] * w[0]).epsilon(1e-14));
  CHECK((h * w)[1] ==
        Approx(u[2] * (v[0] * w[1] + v[1] * w[0]) + u[1] * (v[0] * w[2] + v[2] * w[0]) + u[0] * (v[1] * w[2] + v[2] * w[1]) - 2 * v[1] * w[1])
            .epsilon(1e-14));
  Vector t(2);
  f.third(u, v, w, v, t);
  CHECK(t[0] == Approx(-6 * v[0] * w[0] * v[0]).epsilon(1e-14));
  CHECK(t[1] == Approx(2 * (v[0] * w[1] * v[2] + v[0] * v[1] * w[2] + v[1] * w[0] * v[2])).epsilon(1e-14));
}

TEST_CASE("roots of polynomials") {
  // (x - 1)(x - 2)(x + 3)(x^2 + 1)
  const auto roots = polynomial_roots({6, -7, 6, -6, 0, 1});
  REQUIRE(roots.size() == 5);
  for (const std::complex<double> z : {std::complex<double>{1, 0}, {2, 0}, {-3, 0}, {0, 1}, {0, -1}})
    CHECK(std::any_of(roots.begin(), roots.end(), [&](auto r) { return std::abs(r - z) < 1e-13; }));
  CHECK(polynomial_roots({3.0}).empty());
  CHECK(polynomial_roots({-2.0, 1.0, 0.0}).size() == 1);
}

TEST_CASE("Gauss quadrature integrates products of mode slopes to rounding") {
  const double w = 3.2;
  const double exact = 0.5 - std::sin(2 * w) / (4 * w);
  CHECK(integrate<double>([&](double x) { return std::sin(w * x) * std::sin(w * x); }) == Approx(exact).epsilon(1e-14));
}
