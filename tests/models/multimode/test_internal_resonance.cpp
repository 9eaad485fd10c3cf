// A suspended cable at its cross-over: the first symmetric mode moves at twice the first out-of-plane frequency and drives it through the sag.
#include <catch2/catch.hpp>

#include "core/newton.hpp"
#include "models/multimode/cable_model.hpp"
#include "models/shallow/modes.hpp"
#include "models/statics.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

// lambda2 = 4 pi^2 by the tension.
Cable<double> crossed() {
  Cable<double> c{200.0, 37.6e6, 37e3, 1.57, 0.0, 9.81};
  double low = 1e4, high = 37e3;
  for (int i = 0; i < 200; ++i) {
    c.chord_tension = 0.5 * (low + high);
    (parabola(c).irvine_lambda2 > shallow::cross_over(1) ? low : high) = c.chord_tension;
  }
  return c;
}

}  // namespace

TEST_CASE("internal 1:2 resonance: in-plane motion at the cross-over passes its energy out of plane") {
  const double zeta = 0.002;
  CableModel m{.stay = {crossed(), zeta, zeta, 1e-4, 1.0}};
  m.direction = Direction::vertical;
  m.longitudinal = Longitudinal::quasi_static;
  const auto linear = modes(m.stay.cable);
  REQUIRE(linear.omega2 == Approx(2.0 * linear.omega1).epsilon(1e-10));
  m.stay.omega = linear.omega2;
  const auto equations = cable_equations(m);
  const auto quadratic = std::find_if(equations.terms.begin(), equations.terms.end(),
                                      [](const auto& t) { return t.equation == 0 && t.degree == 2 && t.factor[0] != t.factor[1]; });
  REQUIRE(quadratic != equations.terms.end());
  // y1'' + .. + (w1^2 + c z1) y1 = 0 with z1 = Z cos(2 w1 t): unstable from c Z = 4 zeta w1^2 on, to first order.
  const double predicted = 4.0 * zeta * linear.omega1 * linear.omega1 / std::abs(quadratic->coefficient);

  const HarmonicBalance balance(cable_system(m, {Lens("support_amplitude")}), {.harmonics = 6, .reflections = cable_reflections(m)});
  Vector u = balance.linear_response(Vector::Constant(1, 1e-9));
  const auto stable = [&](double amplitude, double& Z) {
    u[balance.size()] = amplitude;
    const auto at = newton(balance, u, {.max_iterations = 20});
    REQUIRE(at.ok());
    u = at.x;
    Z = std::abs(balance.observe(u)(1, 1));
    const auto system = balance.system_at(u);
    Floquet floquet(system, balance.harmonics(), 1);
    return floquet.compute(system, u.head(balance.size())).multipliers.head(2).cwiseAbs().maxCoeff() < 1.0;  // out of plane
  };
  double low = 1e-9, high = low, Z = 0.0;
  while (stable(high, Z)) {
    low = high;
    high *= 1.2;
    REQUIRE(high < 1.0);
  }
  u = balance.linear_response(Vector::Constant(1, low));
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (stable(middle, Z) ? low : high) = middle;
  }
  CHECK(Z == Approx(predicted).epsilon(0.02));  // what is left is of the order of the damping and of the modulation
  CHECK(Z < 0.05);                              // centimetres on a span of 200 m
}
