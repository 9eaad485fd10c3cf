#include <catch2/catch.hpp>

#include "models/multimode/cable_model.hpp"
#include "models/shallow/resonances.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl::models;
using namespace whirl::models::shallow;

namespace {
bool has(const std::vector<Resonance>& list, const std::string& condition) {
  return std::any_of(list.begin(), list.end(), [&](const auto& r) { return r.condition == condition; });
}
}  // namespace

TEST_CASE("the Oresund stay: near 1:1, and what an excitation frequency meets") {
  const auto list = lowest_modes(oresund().cable, 4);
  const auto at = [&](double omega, double tolerance) { return resonances(list, {.omega = omega, .tolerance = tolerance}); };
  const auto half = at(1.6, 0.05);
  REQUIRE(half.size() >= 3);
  CHECK(has(half, "omega = w(z1)/2"));
  CHECK(has(half, "omega = w(y1)/2"));
  CHECK(has(half, "w(y1) = w(z1)"));
  CHECK_FALSE(has(half, "omega = w(z1)"));
  CHECK(has(at(3.2, 0.05), "omega = w(z1)"));
  CHECK(has(at(6.3, 0.05), "omega = 2 w(y1)"));
  CHECK(has(at(6.3, 0.05), "omega = w(y2)"));
  // 2 w(y1) = w(z2) exactly, but no term drives it: z2 is antisymmetric
  for (const auto& r : half)
    if (r.condition == "2 w(y1) = w(z2)") CHECK_FALSE(r.driven);
  const auto internal = std::find_if(half.begin(), half.end(), [](const auto& r) { return r.kind == ResonanceKind::internal; });
  const auto nearer = [](const auto& a, const auto& b) { return std::abs(a.detuning) < std::abs(b.detuning); };
  CHECK((std::is_sorted(half.begin(), internal, nearer) && std::is_sorted(internal, half.end(), nearer)));
  CHECK(at(1.6, 1e-6).size() >= 3);  // w(y2) = w(z2), w(y4) = w(z4), 2 w(y1) = w(z2) hold exactly
  CHECK_THROWS_AS(at(1.6, -1.0), std::invalid_argument);
}

// Where the table says that nothing drives a 1:2 resonance the model has no quadratic term p_a^2 p_b, and the other way round.
TEST_CASE("quadratic coupling of 1:2 pairs is what the N-mode model has") {
  CableModel m{.stay = oresund()};
  m.out_of_plane = m.in_plane = lowest_half_waves(4);
  const auto equations = cable_equations(m);
  const auto names = m.coordinates();
  for (double tension : {5.5e6, 1.5e6, 0.9e6}) {
    auto cable = m.stay.cable;
    cable.chord_tension = tension;
    int seen = 0;
    for (const auto& r : resonances(lowest_modes(cable, 4), {.tolerance = 0.6})) {
      if (r.condition.rfind("2 w(", 0) != 0) continue;
      const auto index = [&](const std::string& name) { return static_cast<short>(std::find(names.begin(), names.end(), name) - names.begin()); };
      const short a = index(r.first), b = index(r.second);
      if (a == 8 || b == 8) continue;
      bool coupled = false;
      for (const auto& t : equations.terms)
        coupled = coupled || (t.equation == b && t.degree == 2 && t.cos_harmonic == 0 && t.factor[0] == a && t.factor[1] == a);
      INFO(r.condition);
      CHECK(coupled == r.driven);
      ++seen;
    }
    CHECK(seen > 4);
  }
}

TEST_CASE("at the cross-over the first symmetric mode is in 1:2 resonance with the first out-of-plane mode") {
  Cable<double> c{200.0, 37.6e6, 37e3, 1.57, 0.0, 9.81};
  double low = 1e4, high = 37e3;  // lambda2 falls with the tension
  for (int i = 0; i < 200; ++i) {
    c.chord_tension = 0.5 * (low + high);
    (statics(c).lambda2 > cross_over(1) ? low : high) = c.chord_tension;
  }
  const auto list = resonances(lowest_modes(c, 2), {.tolerance = 1e-6});
  CHECK(has(list, "2 w(y1) = w(z1)"));
  CHECK(has(list, "w(z1) = w(z2)"));
}
