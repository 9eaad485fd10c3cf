// Attractors from many starts, in any unit.
#include <algorithm>
#include <catch2/catch.hpp>

#include "models/attractor_survey.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

// x'' + .1 x' + x + x^3 = .3 cos 1.5 t in units of `size` and `second`: two motions, high and low.
ModalSystem<double> duffing(double size, double second) {
  ModalSystem<double> s;
  s.omega = 1.5 / second;
  s.damping = {0.1 / second};
  s.stiffness = {1.0 / (second * second)};
  s.add_term(0, 1.0 / (size * size * second * second), {0, 0, 0});
  s.add_force(0, 0.3 * size / (second * second), 1);
  return s;
}

}  // namespace

TEST_CASE("a survey meets both motions of a Duffing oscillator, the same in any unit") {
  std::vector<double> first;
  for (const auto& [size, second] : {std::pair{1.0, 1.0}, std::pair{1e-6, 1e3}, std::pair{1e5, 1e-2}}) {
    const SurveyResult s =
        survey_attractors(duffing(size, second), {}, {.starts = 12, .half_width = size * Eigen::Vector2d(2.0, 2.0 / second), .settle = {}});
    REQUIRE(s.attractors.size() == 2);
    CHECK(s.attractors[0].starts + s.attractors[1].starts == 12);
    CHECK(s.unsettled + s.diverged + s.failed == 0);
    std::vector<double> amplitudes;
    for (const auto& a : s.attractors) {
      CHECK(a.motion.multiple == 1);
      amplitudes.push_back(std::abs(a.motion.harmonic(0, 1.0)) / size);
    }
    std::sort(amplitudes.begin(), amplitudes.end());
    if (first.empty()) first = amplitudes;
    for (const int k : {0, 1}) CHECK(amplitudes[static_cast<std::size_t>(k)] == Approx(first[static_cast<std::size_t>(k)]).epsilon(1e-8));
    // Low motion: |1 - w^2 + 3/4 A^2 + i c w| A = F up to the third harmonic, A^2 / 32 of the restoring force.
    const double A = amplitudes[0];
    CHECK(std::hypot(1.0 - 2.25 + 0.75 * A * A, 0.15) * A == Approx(0.3).epsilon(1e-2));
    CHECK(amplitudes[1] > 3.0 * A);
  }
}

TEST_CASE("a survey counts mirror images as one, and starts at rest leave the symmetric motion where it repels") {
  // x'' + .1 x' + (1 + .5 cos 2 t) x + x^3, inside its tongue: rest is unstable, +-x are one.
  ModalSystem<double> s;
  s.omega = 2.0;
  s.damping = {0.1};
  s.stiffness = {1.0};
  s.add_term(0, 0.5, {0}, 1);
  s.add_term(0, 1.0, {0, 0, 0});
  const std::vector<Reflection> mirror{{Eigen::Vector2d(-1.0, -1.0), "PF"}};
  const SurveyResult r = survey_attractors(s, mirror, {.starts = 6, .half_width = Eigen::Vector2d(1.0, 1.0), .settle = {}});
  REQUIRE(r.attractors.size() == 1);
  CHECK(r.attractors[0].motion.multiple == 2);
  CHECK(r.attractors[0].starts == 6);
}

TEST_CASE("decay and units of a system, and boxes that do not fit are refused") {
  ModalSystem<double> s = duffing(1.0, 1.0);
  CHECK(slowest_decay(s) == Approx(20.0 * 1.5 / 6.283185307179586));
  const auto u = in_units_of(s, 2.0);
  CHECK(u.omega == 1.0);
  CHECK(u.terms[0].coefficient == Approx(4.0 / 2.25));
  CHECK(u.forces[0].amplitude == Approx(0.3 / (2.0 * 2.25)));
  s.damping = {0.0};
  CHECK(std::isinf(slowest_decay(s)));
  CHECK_THROWS_AS(survey_attractors(s, {}, {.half_width = Eigen::Vector3d::Ones(), .settle = {}}), std::invalid_argument);
}
