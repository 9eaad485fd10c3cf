// The averaged equations in time beside the demodulated motion of the Oresund stay, from rest.
#include <catch2/catch.hpp>

#include "models/dynamics/averaging/modulation.hpp"
#include "models/slow_flow/slow_flow.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

Modulation from_rest(double U, double omega, const Ansatz& ansatz) {
  StayParameters<double> stay{{260.0, 2.17e9, 5.5e6, 81.05, 30.4, 9.81}, 0.01, 0.01, U, omega};
  const ParametricSystem parametric = stay_system(stay, {Lens("omega")}, Terms::reduced, Coefficients::exact);
  const SlowFlow flow(parametric, ansatz, {{{-1, 1}, "WH"}});
  ModalSystem<double> system;
  const double p[] = {omega};
  parametric.at(std::span<const double>(p, 1), system);
  return modulation(system, {flow, ansatz, [&](In u, double t) { return flow.motion(u, t); }}, Vector::Constant(1, omega), Vector::Zero(4));
}

}  // namespace

TEST_CASE("from rest the averaged equations follow the motion, the better the smaller it is", "[modulation]") {
  const Ansatz ansatz = Ansatz::superharmonic(2, 2);
  // Largest difference over the largest averaged amplitude as an independent program found it, three digits.
  for (const auto& [omega, U, difference] :
       {std::tuple(1.6, 0.15, 0.121), {1.6, 0.075, 0.058}, {1.6, 0.0375, 0.017}, {1.58, 0.15, 0.093}, {1.58, 0.075, 0.038}, {1.58, 0.0375, 0.021}}) {
    const Modulation m = from_rest(U, omega, ansatz);
    INFO(omega << " " << U);
    REQUIRE(m.why.empty());
    CHECK(m.difference() == Approx(difference).margin(1e-3));
    CHECK(m.integrated.row(0).isZero());  // in plane it stays
  }
  const Modulation m = from_rest(0.15, 1.58, ansatz);
  CHECK(m.largest(1) == Approx(0.7444).margin(1e-4));
  CHECK(m.averaged.row(1).cwiseAbs().maxCoeff() == Approx(0.7033).margin(1e-4));
}

TEST_CASE("a linear oscillator: amplitudes demodulated are those of the closed form", "[modulation]") {
  // q'' + 2 z q' + q = f cos(w t) at w = 1.02: Z integrated tends to the response, and the averaged one with it to first order.
  ModalSystem<double> system{1.02, {0.02}, {1.0}, {}, {}, 0};
  system.add_force(0, 0.05, 1);
  const ParametricSystem parametric = ParametricSystem::over_omega(system);
  const Ansatz ansatz = Ansatz::list({{1}});
  const SlowFlow flow(parametric, ansatz);
  const AveragedFlow averaged{flow, ansatz, [&](In u, double t) { return flow.motion(u, t); }};
  const Modulation m = modulation(system, averaged, Vector::Constant(1, 1.02), Vector::Zero(2), {.periods = 150});
  const std::complex<double> response = 0.05 / std::complex<double>(1.0 - 1.02 * 1.02, 0.02 * 1.02);
  const auto last = m.t.size() - 1;
  CHECK(std::abs(m.integrated(0, last) - response) < 2e-4 * std::abs(response));
  CHECK(std::abs(m.averaged(0, last) - response) < 2e-4 * std::abs(response));
  CHECK(m.difference() < 0.02);
  // The start is the physical one.
  const Vector y0 = (Vector(2) << 0.3, -0.1).finished();
  Vector u(3);
  u << averaged_start(system, averaged, Vector::Constant(1, 1.02), y0), 1.02;
  CHECK((flow.motion(u, 0.0) - y0).norm() < 1e-14);
  CHECK_THROWS_AS(modulation(system, averaged, Vector::Constant(1, 1.02), y0, {.samples = 3}), std::invalid_argument);
}
