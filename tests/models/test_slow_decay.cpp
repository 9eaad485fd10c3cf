// Motions that decay more slowly than a run can show, beside motions on a torus: both look alike until the multipliers are asked.
#include "models/slow_decay.hpp"

#include <catch2/catch.hpp>
#include <numbers>

#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

// q'' + c q' + 2 q + a q^3 = cos t: the free part decays at c/2, whatever its size where a = 0.
ModalSystem<double> oscillator(double c, double a = 0.0) {
  ModalSystem<double> s;
  s.omega = 1.0;
  s.damping = {c};
  s.stiffness = {2.0};
  s.add_term(0, a, {0, 0, 0});
  s.add_force(0, 1.0, 1);
  return s;
}

// Two coordinates, the second damped fast; b couples them.
ModalSystem<double> pair(double slow, double fast, double b) {
  ModalSystem<double> s;
  s.omega = 1.3;
  s.damping = {slow, fast};
  s.stiffness = {3.0, 7.7};
  s.add_term(0, b, {0, 1});
  s.add_term(1, 0.5 * b, {0, 0});
  s.add_force(0, 0.2, 1);
  return s;
}

// Mathieu-Duffing, q'' + c q' + (1 + .3 cos t) q + q^3 = .1 cos t
ModalSystem<double> parametric(double c) {
  ModalSystem<double> s = oscillator(c, 1.0);
  s.stiffness = {1.7};
  s.add_term(0, 0.05, {0}, 1);
  return s;
}

const SettleOptions briefly{.max_periods = 400, .samples = 16, .record_periods = 8, .lyapunov_periods = 64};

}  // namespace

TEST_CASE("settle: decays too slow to be seen are unsettled, with the rate of the multipliers") {
  for (const double c : {2e-5, 1e-5, 3e-6, 1e-6, 1e-7}) {
    const SteadyMotion m = settle(oscillator(c), point({2.0, 0.0}), briefly);
    INFO(c << ": " << to_string(m.kind) << ", " << m.why);
    CHECK(m.kind == MotionKind::unsettled);
    CHECK(m.decay_rate == Approx(0.5 * c).epsilon(0).margin(1e-9));  // multipliers are integrated to 1e-9 of one period
    CHECK(m.why.find("decays too slowly to be seen") != std::string::npos);
  }
  for (const auto& system : {oscillator(1e-5, 0.05), oscillator(1e-5, -0.02), pair(1e-5, 0.1, 0.05), pair(1e-5, 0.1, 0.0), parametric(1e-5)}) {
    const Vector start = system.size() == 1 ? point({0.3, 0.0}) : point({0.2, 0.1, 0.0, 0.0});
    const SteadyMotion m = settle(system, start, briefly);
    INFO(system.size() << ": " << to_string(m.kind) << ", " << m.why);
    CHECK(m.kind == MotionKind::unsettled);
    CHECK(m.decay_rate == Approx(0.5e-5).epsilon(0.2));
  }
}

TEST_CASE("settle: without damping, or beside an unstable motion, what lasts is quasi-periodic") {
  CHECK(settle(oscillator(0.0), point({2.0, 0.0}), briefly).kind == MotionKind::quasi_periodic);
  CHECK(settle(oscillator(0.0, 0.05), point({0.3, 0.0}), briefly).kind == MotionKind::quasi_periodic);
  CHECK(settle(pair(0.0, 0.0, 0.0), point({0.2, 0.1, 0.0, 0.0}), briefly).kind == MotionKind::quasi_periodic);
}

TEST_CASE("attractors: a decay too slow to be seen is no torus") {
  for (const auto& system : {oscillator(1e-5), oscillator(1e-6), oscillator(1e-5, 0.05), pair(1e-5, 0.1, 0.05)}) {
    AttractorFinder finder(system, {.max_periods = 3000, .nonperiodic_after = 50, .lyapunov_periods = 200});
    const Settled s = finder.settle(system.size() == 1 ? point({0.3, 0.0}) : point({0.2, 0.1, 0.0, 0.0}), AttractorSet());
    INFO(to_string(s.kind) << ", " << s.why);
    CHECK(s.kind != MotionKind::quasi_periodic);
    CHECK(s.kind != MotionKind::chaotic);
    if (s.kind == MotionKind::periodic) CHECK(s.fresh->lyapunov == Approx(-0.5 * system.damping[0]).epsilon(0.2));
    else CHECK(s.why.find("decays too slowly to be seen") != std::string::npos);
  }
  AttractorFinder undamped(oscillator(0.0), {.max_periods = 1000, .nonperiodic_after = 50, .lyapunov_periods = 200});
  CHECK(undamped.settle(point({0.3, 0.0}), AttractorSet()).kind == MotionKind::quasi_periodic);
}
