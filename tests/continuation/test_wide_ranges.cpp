// Ranges over many lines of a cable's resonance table, lower ends far below the first frequency: no line is stepped over at default steps.
#include <catch2/catch.hpp>

#include "tests/continuation/random_tongues.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::tongues;

namespace {

struct Wide {
  double w1, lower, upper;  // [rad/s]
  CableModel model;
  std::unique_ptr<HarmonicBalance> balance;
};

// `modes` a plane of a random stay moved along its chord; multiples of the first frequency between `least` and `most`.
Wide wide(unsigned seed, int modes, double least, double most) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Wide w{0.0, 0.0, 0.0, random_stay(random, 40.0), nullptr};
  CableModel& m = w.model;
  m.out_of_plane = m.in_plane = lowest_half_waves(modes);
  w.w1 = std::sqrt(m.stay.cable.chord_tension / m.stay.cable.mass_per_length) * std::numbers::pi / m.stay.cable.chord_length;
  w.lower = w.w1 * (least + 1.5 * unit(random));
  w.upper = std::max(w.w1 * (2.5 + (most - 2.5) * unit(random)), w.lower + w.w1);
  m.stay.omega = w.w1;
  w.balance = std::make_unique<HarmonicBalance>(cable_system(m, {Lens("omega")}),
                                                HarmonicBalanceOptions{.harmonics = 8, .nu = 1, .reflections = cable_reflections(m), .floquet = {}});
  return w;
}

Branch walk(const Wide& w, double shorter) {
  WalkOptions o{.lower = w.lower, .upper = w.upper};
  o.max_step /= shorter;
  o.initial_step /= shorter;
  o.max_points = 100000;
  return Walker(*w.balance, o).walk(newton(*w.balance, w.balance->linear_response(Vector::Constant(1, w.lower))).x);
}

bool has(const Branch& b, EventType type, double omega) {
  return std::any_of(b.special.begin(), b.special.end(),
                     [&](const SpecialPoint& s) { return s.type == type && std::abs(s.u[s.u.size() - 1] - omega) < 1e-7 * omega; });
}

// Default steps find what shorter ones find, and nothing else; returns the number of events.
int compare_steps(unsigned seed, int modes, double least, double most) {
  const Wide w = wide(seed, modes, least, most);
  const Branch coarse = walk(w, 1.0), fine = walk(w, 15.0);
  CAPTURE(seed, modes, w.lower / w.w1, w.upper / w.w1);
  for (const auto& s : fine.special) {
    CAPTURE(to_string(s.type), s.u[s.u.size() - 1] / w.w1);
    CHECK(has(coarse, s.type, s.u[s.u.size() - 1]));
  }
  CHECK(coarse.special.size() == fine.special.size());
  return static_cast<int>(fine.special.size());
}

}  // namespace

TEST_CASE("wide ranges: twice the third frequency is not passed over, whatever lies around it") {
  for (const unsigned seed : {109u, 119u}) {  // steps of more than half the first frequency, in which multipliers of two modes pass each other
    const Wide w = wide(seed, 3, 1.6, 20.0);
    const Branch b = walk(w, 1.0);
    // The third mode of each plane alone is unstable there: det(M + I) = 0 of its period map, integrated.
    Case c{"2 w3", std::make_shared<ParametricSystem>(cable_system(w.model, {Lens("omega")})), {}, {{2}, {5}}, 6.0 * w.w1, 0.01, 8};
    c.blocks = {{0, 2}, {3, 5}, {1}, {4}};
    bool ok = true;
    const auto edges = Reference(c).edges(5.95 * w.w1, 6.05 * w.w1, 100, ok);
    CAPTURE(seed);
    REQUIRE(ok);
    CHECK(edges.size() == 4);
    for (const Edge& e : edges) CHECK(has(b, e.type, e.omega));
  }
}

TEST_CASE("wide ranges: steps fifteen times shorter find no more") {
  int events = 0;
  for (unsigned seed = 300; seed < 302; ++seed) events += compare_steps(seed, 3, 1.6, 20.0);
  CHECK(events > 20);
  CHECK(compare_steps(237, 1, 0.12, 5.0) == 4);  // damping ratio 1e-4: no step leads from one side of the primary resonance to the other
}

TEST_CASE("wide ranges: a hundred stays of two to four modes a plane", "[slow]") {
  int events = 0;
  for (unsigned seed = 400; seed < 460; ++seed) events += compare_steps(seed, 2, 1.6, 9.0);
  for (unsigned seed = 400; seed < 430; ++seed) events += compare_steps(seed, 3, 1.6, 20.0);
  for (unsigned seed = 400; seed < 410; ++seed) events += compare_steps(seed, 4, 1.6, 18.0);
  CHECK(events > 400);
}
