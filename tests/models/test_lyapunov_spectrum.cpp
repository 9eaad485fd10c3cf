// Lyapunov spectra against closed forms, mean divergences, and the published and recomputed exponents of classic systems
// (Ueda's exponent: [Sprott2003]).
#include <catch2/catch.hpp>

#include "models/dynamics/time/lyapunov_spectrum.hpp"
#include "models/equilibrium_model.hpp"
#include "models/modal_model.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

EquilibriumModel lorenz(double r) {
  return {.variables = {"x", "y", "z"},
          .parameters = {{"r", r}},
          .rhs = {"10*(y - x)", "r*x - y - x*z", "x*y - 8*z/3"},
          .initial = {1.0, 1.0, 20.0},
          .mirrors = {}};
}

LyapunovSpectrum of(const EquilibriumModel& model, const LyapunovSpectrumOptions& options) {
  const EquilibriumFlow flow(model, {model.parameters.front().name});
  return lyapunov_spectrum(flow, Eigen::Map<const Vector>(model.initial.data(), model.size()), Vector::Constant(1, model.parameters.front().value),
                           options);
}

}  // namespace

TEST_CASE("Lorenz: chaos at r = 28, sum of the exponents, dimension", "[lyapunov]") {
  const auto s = of(lorenz(28.0), {.interval = 0.5, .skip = 200, .counted = 8000});
  REQUIRE(s.ok());
  CHECK(s.kind == FlowMotion::chaotic);
  CHECK(std::abs(s.exponent[0] - 0.9066) < 3.0 * s.error[0] + 1e-3);
  CHECK(s.error[0] < 6e-3);
  CHECK(std::abs(s.exponent[1]) < 3.0 * s.error[1] + 1e-3);
  CHECK(s.sum() == Approx(-41.0 / 3.0).epsilon(1e-6));
  CHECK(s.divergence == Approx(-41.0 / 3.0).epsilon(1e-12));
  CHECK(s.dimension() == Approx(2.062).margin(2e-3));
}

TEST_CASE("Lorenz: equilibria, a forced pair on a circle, a cycle", "[lyapunov]") {
  const auto rest = of(lorenz(10.0), {.interval = 1.0, .skip = 100, .counted = 400});
  CHECK(rest.kind == FlowMotion::equilibrium);
  // x = y = sqrt(8 (r - 1)/3): lambda^3 + 41/3 lambda^2 + 8 (r + 10)/3 lambda + 160 (r - 1)/3 = 0, r = 10: -12.4757, -.5955 +- 6.1742 i
  CHECK(rest.exponent[0] == Approx(-0.595).margin(2e-3));
  CHECK(rest.exponent[2] == Approx(-12.4757).margin(2e-3));
  const EquilibriumModel oscillator{.variables = {"x", "y"},
                                    .parameters = {{"m", 1.0}},
                                    .rhs = {"x*(m - x^2 - y^2) - 3*y", "y*(m - x^2 - y^2) + 3*x"},
                                    .initial = {0.1, 0.2},
                                    .mirrors = {}};
  const auto cycle = of(oscillator, {.interval = 0.5, .skip = 100, .counted = 400});
  CHECK(cycle.kind == FlowMotion::cycle);
  CHECK(std::abs(cycle.exponent[0]) < 1e-6);
  CHECK(cycle.exponent[1] == Approx(-2.0).epsilon(1e-6));
  CHECK(cycle.divergence == Approx(-2.0).epsilon(1e-6));
  const EquilibriumModel pair{.variables = {"x", "y", "u", "v"},
                              .parameters = {{"m", 1.0}},
                              .rhs = {"x*(m - x^2 - y^2) - 3*y", "y*(m - x^2 - y^2) + 3*x", "u*(m - u^2 - v^2) - 1.7*v", "v*(m - u^2 - v^2) + 1.7*u"},
                              .initial = {0.1, 0.2, 0.3, 0.0},
                              .mirrors = {}};
  CHECK(of(pair, {.interval = 0.5, .skip = 100, .counted = 400}).kind == FlowMotion::torus);
}

TEST_CASE("exponents of a forced oscillator: their sum is the damping, chaos of Ueda's oscillator", "[lyapunov]") {
  ModalModel ueda{.frequency = {}, .stiffness = {{0.0}}, .damping = {0.05}, .terms = {{0, 1.0, {3}}}, .forces = {{0, 7.5}}};
  Stroboscope strobe(modal_system(ueda));
  const Vector start = (Vector(2) << 2.5, 0.0).finished();
  const auto s = lyapunov_spectrum(strobe, start, {.skip = 100, .counted = 2000});
  REQUIRE(s.ok());
  CHECK(s.kind == FlowMotion::chaotic);
  CHECK(s.error[0] < 0.006);
  CHECK(s.sum() == Approx(-0.05).epsilon(1e-8));
  CHECK(s.exponent[0] == Approx(0.1034).margin(4.0 * s.error[0]));
  CHECK_THROWS_AS(lyapunov_spectrum(strobe, start, {.counted = 3}), std::invalid_argument);
}
