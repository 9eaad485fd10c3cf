/// Totals that are conserved and symmetries that leave a coordinate free: found from the equations, and what holding them does.

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/newton.hpp"
#include "models/equilibrium_symmetry.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

EquilibriumModel sirs() {
  return {.variables = {"S", "I", "R"},
          .parameters = {{"b", 1.0}, {"g", 0.5}, {"w", 0.1}},
          .rhs = {"-b*S*I + w*R", "b*S*I - g*I", "g*I - w*R"},
          .initial = {1.0, 0.0, 0.0}};
}
EquilibriumModel ring() {
  return {.variables = {"x", "y"}, .parameters = {{"p", 0.5}}, .rhs = {"x*(p - x^2 - y^2)", "y*(p - x^2 - y^2)"}, .initial = {0.0, 0.5}};
}
EquilibriumModel kuramoto(double drift) {
  EquilibriumModel m{.variables = {"a", "b", "c"},
                     .parameters = {{"K", 3.0}, {"w", drift}},
                     .rhs = {"w + 0.3 + K/3*(sin(b-a) + sin(c-a))", "w - 0.1 + K/3*(sin(a-b) + sin(c-b))", "w - 0.2 + K/3*(sin(a-c) + sin(b-c))"},
                     .initial = {0.1, 0.0, -0.1}};
  return m;
}

Vector growth_rates(const Problem& f, const Vector& u) {
  Matrix j(f.size(), f.size() + f.parameters());
  f.jacobian(u, j);
  Vector rates = j.leftCols(f.size()).eigenvalues().real();
  std::sort(rates.begin(), rates.end());
  return rates;
}

}  // namespace

TEST_CASE("sums that the equations conserve are found", "[symmetry]") {
  CHECK(linear_invariants(sirs(), {"b"}) == std::vector<std::string>{"S + I + R"});
  CHECK(linear_invariants(ring(), {"p"}).empty());
  CHECK(linear_invariants(kuramoto(0.0), {"K"}) == std::vector<std::string>{"a + b + c"});
  CHECK(linear_invariants(kuramoto(0.1), {"K"}).empty());
  // A + B <-> C with rates that overflow no test: two totals
  EquilibriumModel binding{.variables = {"A", "B", "C"},
                           .parameters = {{"k", 2.0}, {"l", 1.0}},
                           .rhs = {"-k*A*B + l*C", "-k*A*B + l*C", "k*A*B - l*C"},
                           .initial = {1.0, 2.0, 0.0}};
  CHECK(linear_invariants(binding, {"k"}) == std::vector<std::string>{"A + C", "B + C"});
  // 2 A <-> B, in other units of B: weights that are not whole
  EquilibriumModel dimer{.variables = {"A", "B"}, .parameters = {{"k", 1.0}}, .rhs = {"-2*k*A^2 + 2*B", "0.3*k*A^2 - 0.3*B"}, .initial = {1.0, 0.0}};
  CHECK(linear_invariants(dimer, {"k"}) == std::vector<std::string>{"A + 6.666666666666667*B"});
  // positive only: logarithms
  EquilibriumModel logs{.variables = {"x", "y"}, .parameters = {{"k", 1.0}}, .rhs = {"k*log(x) - y", "y - k*log(x)"}, .initial = {1.0, 0.5}};
  CHECK(linear_invariants(logs, {"k"}) == std::vector<std::string>{"x + y"});
  // a variable that stands still, and an equation that is almost a sum
  EquilibriumModel still{.variables = {"x", "m"}, .parameters = {{"k", 1.0}}, .rhs = {"k - m*x", "0*x"}, .initial = {1.0, 1.0}};
  CHECK(linear_invariants(still, {"k"}) == std::vector<std::string>{"m"});
  EquilibriumModel almost = sirs();
  almost.rhs[2] += " + 0.000001*S*R";
  CHECK(linear_invariants(almost, {"b"}).empty());
  // what is held already is not told again
  EquilibriumModel held = sirs();
  held.conserved = {"(S + I + R)^2"};
  CHECK(linear_invariants(held, {"b"}).empty());
}

TEST_CASE("holding a conserved total leaves isolated equilibria and all growth rates but one", "[symmetry]") {
  EquilibriumModel m = sirs();
  for (const char* total : {"S + I + R", "(S + I + R)^2", "exp(S + I + R)", "2*S + 2*I + 2*R - 7"}) {
    INFO(total);
    m.conserved = {total};
    const EquilibriumFlow flow(m, {"b"});
    Vector u(4);
    u << 0.6, 0.1, 0.3, 1.0;
    const NewtonResult at = newton(flow, u);
    REQUIRE(at.ok());
    // endemic: S = g/b, I = (1 - g/b)/(1 + g/w)
    CHECK(at.x[0] == Approx(0.5).epsilon(1e-12));
    CHECK(at.x[1] == Approx(0.5 / 6.0).epsilon(1e-12));
    // The other two: trace and determinant of the field on S + I + R = 1 by hand, x = (S, I): S' = -b S I + w (1 - S - I), I' = b S I - g I.
    const double I = 0.5 / 6.0, trace = -I - 0.1, determinant = I * (0.5 + 0.1);
    const Vector rates = growth_rates(flow, at.x);
    CHECK(rates[0] < 0.0);
    CHECK(trace * trace < 4.0 * determinant);
    std::vector<double> two = {rates[1], rates[2]};
    if (std::abs(rates[0] - rates[1]) < 1e-9) two = {rates[0], rates[1]};
    CHECK(two[0] == Approx(0.5 * trace).epsilon(1e-10));
    CHECK(two[1] == Approx(0.5 * trace).epsilon(1e-10));
  }
  m.conserved = {"S + I"};
  CHECK_THROWS_WITH(EquilibriumFlow(m, {"b"}), "the equations do not conserve expression 1: it changes with time");
  m.conserved = {"b + g"};
  CHECK_THROWS_WITH(EquilibriumFlow(m, {"b"}), Catch::Contains("no variable moves it"));
}

TEST_CASE("a held nonlinear integral has exact derivatives", "[symmetry]") {
  // Rigid body: x' = A y z ...; energy and momentum are conserved. c = every function of the language, through the chain rule of the steps.
  EquilibriumModel m{.variables = {"x", "y", "z"}, .parameters = {{"p", 0.4}}, .rhs = {"p*y*z", "-(1 + p)*x*z", "x*y"}, .initial = {0.3, 0.5, 0.7}};
  // y^2 + z^2 (1 + p) and x^2 - p z^2 are constant
  m.conserved = {"exp(0.1*(y^2 + (1+p)*z^2)) + sin(x^2 - p*z^2)/(2 + cos(x^2 - p*z^2))", "sqrt(1 + (x^2 - p*z^2)^2) + atan(x^2 - p*z^2)^3"};
  const EquilibriumFlow flow(m, {"p"});
  Vector u(4), r(3), up(3), down(3);
  u << 0.4, 0.45, 0.8, 0.4;
  Matrix j(3, 4);
  flow.linearise(u, r, j);
  constexpr double h = 1e-5;
  for (int k = 0; k < 4; ++k) {
    Vector a = u, b = u;
    a[k] += h;
    b[k] -= h;
    flow.residual(a, up);
    flow.residual(b, down);
    CHECK((j.col(k) - (up - down) / (2.0 * h)).norm() < 1e-8);  // h^2 and rounding / h
  }
  // at the start the field is the field
  Vector start(4), plain(3);
  start << 0.3, 0.5, 0.7, 0.4;
  m.conserved.clear();
  EquilibriumFlow(m, {"p"}).residual(start, plain);
  flow.residual(start, r);
  CHECK((r - plain).norm() < 1e-15);
}

TEST_CASE("translations and rotations are found and described", "[symmetry]") {
  const auto described = [](const EquilibriumModel& m, const std::vector<std::string>& lenses) {
    std::vector<std::string> all;
    for (const auto& s : continuous_symmetries(m, lenses)) all.push_back(describe(s, m.variables));
    return all;
  };
  CHECK(described(ring(), {"p"}) == std::vector<std::string>{"a rotation of (x, y)"});
  CHECK(described(kuramoto(0.1), {"K"}) == std::vector<std::string>{"a translation along a + b + c"});
  CHECK(described(sirs(), {"b"}).empty());
}

TEST_CASE("variables that repeat every turn are found", "[symmetry]") {
  const auto turning = [](const EquilibriumModel& m, const std::vector<std::string>& lenses) {
    std::vector<std::string> all;
    for (const auto& t : turns(m, lenses)) all.push_back(describe(t, m.variables));
    return all;
  };
  CHECK(turning(kuramoto(0.1), {"K"}) == std::vector<std::string>{"a", "b", "c"});
  CHECK(turning(ring(), {"p"}).empty());
  const EquilibriumModel pendulum{
      .variables = {"x", "v"}, .parameters = {{"p", 0.2}}, .rhs = {"v", "p - sin(x)*cos(2*x) - v"}, .initial = {0.2, 0.0}};
  CHECK(turning(pendulum, {"p"}) == std::vector<std::string>{"x"});
  // Tied by springs and gears they turn together only.
  const EquilibriumModel tied{.variables = {"x", "y", "z"},
                              .parameters = {{"p", 0.2}, {"c", 0.3}},
                              .rhs = {"p - sin(x) + c*(y - x)", "p - sin(y) + c*(x - y)", "p - sin(z)"},
                              .initial = {0.2, 0.1, 0.0}};
  CHECK(turning(tied, {"p"}) == std::vector<std::string>{"x + y", "z"});
  CHECK(describe(turn_of(tied, turns(tied, {"p"}), "y"), tied.variables) == "x + y");
  const EquilibriumModel geared{
      .variables = {"x", "y"}, .parameters = {{"p", 0.2}}, .rhs = {"p - sin(x) + y - 2*x", "cos(y) - (y - 2*x)"}, .initial = {0.2, 0.1}};
  CHECK(turning(geared, {"p"}) == std::vector<std::string>{"x + 2*y"});
  CHECK(describe(turn_of(geared, turns(geared, {"p"}), "x"), geared.variables) == "x + 2*y");
  const EquilibriumModel slanted{// half a turn of y is none
                                 .variables = {"x", "y"},
                                 .parameters = {{"p", 0.2}},
                                 .rhs = {"p - sin(x) + y - x/2", "cos(y) - y + x/2"},
                                 .initial = {0.2, 0.1}};
  CHECK(turning(slanted, {"p"}) == std::vector<std::string>{"2*x + y"});
  CHECK(turning({.variables = {"x"}, .parameters = {{"p", 0.2}}, .rhs = {"p - x - sin(x)"}, .initial = {0.0}}, {"p"}).empty());
}

TEST_CASE("a field that is linear only near the start has no symmetry", "[symmetry]") {
  const EquilibriumModel chua{.variables = {"x", "y", "z"},
                              .parameters = {{"m", -0.5}},
                              .rhs = {"9*(y - x + 0.714*x - 0.5*(m + 0.714)*(abs(x+1) - abs(x-1)))", "x - y + z", "-14*y"},
                              .initial = {0.0, 0.0, 0.0}};
  CHECK(continuous_symmetries(chua, {"m"}).empty());
}

TEST_CASE("a pinned variable reduces the flow to what the symmetry leaves", "[symmetry]") {
  EquilibriumModel start = ring();
  start.initial = {0.0, 0.5};
  const EquilibriumModel reduced = pinned(start, "x", {"p"});
  REQUIRE(reduced.variables == std::vector<std::string>{"y"});
  const EquilibriumFlow flow(reduced, {"p"});
  for (const double y : {-0.8, 0.0, 0.3}) {  // y' = y (p - y^2)
    Vector u(2), r(1);
    u << y, 0.5;
    flow.residual(u, r);
    CHECK(r[0] == Approx(y * (0.5 - y * y)).margin(1e-16));
  }
  CHECK_THROWS_WITH(pinned(sirs(), "S", {"b"}), Catch::Contains("no translation or rotation that moves S"));
  CHECK_THROWS_WITH(pinned(ring(), "z", {"p"}), Catch::Contains("the variables are x, y"));

  // Locked oscillators that drift together: two growth rates of the three are left, the neutral one is gone.
  const EquilibriumModel full = kuramoto(0.25), locked = pinned(full, "c", {"K"});
  const EquilibriumFlow phases(locked, {"K"});
  Vector u(3);
  u << 0.2, 0.1, 3.0;
  const NewtonResult at = newton(phases, u);
  REQUIRE(at.ok());
  const double c = -0.1, a = at.x[0], b = at.x[1];
  double drift = 0.0;
  bound(locked, {locked.pinned[0].drift}, {"K"}).evaluate<double>(std::vector<double>{a, b, 3.0}, std::span<double>(&drift, 1));
  CHECK(drift == Approx(0.25).epsilon(1e-12));  // the mean frequency
  CHECK(0.3 + (std::sin(b - a) + std::sin(c - a)) == Approx(0.0).margin(1e-12));
  Vector x(4);
  x << a, b, c, 3.0;
  const Vector all = growth_rates(EquilibriumFlow(full, {"K"}), x), left = growth_rates(phases, at.x);
  CHECK(all[2] == Approx(0.0).margin(1e-12));
  CHECK(left[0] == Approx(all[0]).epsilon(1e-12));
  CHECK(left[1] == Approx(all[1]).epsilon(1e-12));
}
