/// The Oresund stay in (omega, U): threshold of whirling, cusps of the fold curves, ends of the chart.
#include <catch2/catch.hpp>

#include "continuation/network.hpp"
#include "continuation/two_parameter.hpp"
#include "models/closed_forms.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;
using namespace whirl::continuation;

namespace {

struct Chart {
  SuperharmonicFlow f{oresund(0.5), {.order = 2}, {Lens("omega")}};
  SuperharmonicFlow f2{oresund(0.5), {.order = 2}, {Lens("omega"), Lens("support_amplitude")}};
  WalkOptions walk = [] {
    WalkOptions o;
    o.lower = 1.2;
    o.upper = 2.8;
    return o;
  }();
  TwoParameterOptions follow_options = [] {
    TwoParameterOptions t;
    t.range1[0] = 1.2;
    t.range1[1] = 2.8;
    t.range2[0] = 0.05;
    t.range2[1] = 0.8;
    return t;
  }();

  Branch planar() const {
    Vector start(5);
    start << in_plane_states(f.model().coefficients<double>(std::array<double, 1>{1.2})).front(), 1.2;
    return Walker(f, walk).walk(start);
  }
};

const CodimensionTwo* find(const DefiningCurve& c, const std::string& type) {
  for (const auto& s : c.special)
    if (s.type == type) return &s;
  return nullptr;
}

}  // namespace

TEST_CASE("the fold curve of the in-plane motion has its cusp where the amplitude cubic has a triple root", "[published]") {
  const Chart chart;
  Network net(chart.f, {.walk = chart.walk, .depth = 0});
  for (int i = 0; i <= 16; ++i) {
    const double p = 1.2 + 0.1 * i;
    for (const auto& x : in_plane_states(chart.f.model().coefficients<double>(std::array<double, 1>{p}))) {
      Vector u(5);
      u << x, p;
      net.add_seed(u, "closed form");
    }
  }
  Branch folded;
  for (const Branch& b : net.branches())
    if (std::any_of(b.special.begin(), b.special.end(), [](const auto& s) { return s.type == EventType::fold; })) folded = b;
  const auto fold = std::find_if(folded.special.begin(), folded.special.end(), [](const auto& s) { return s.type == EventType::fold; });
  REQUIRE(fold != folded.special.end());
  const DefiningCurve c = follow(chart.f2, *fold, 0.5, chart.follow_options);
  const CodimensionTwo* cusp = find(c, "CP");
  REQUIRE(cusp);
  CHECK(cusp->u[4] == Approx(1.63030925283).epsilon(1e-10));
  CHECK(cusp->u[5] == Approx(0.16181127737).epsilon(1e-10));
  // y = B^2: ((D + g y)^2 + d^2) y = P^2 with both slopes zero gives D = -sqrt(3) d, P^2 = 8 sqrt(3) d^3 / (9 g).
  const auto at = chart.f2.model().coefficients<double>(std::array<double, 2>{cusp->u[4], cusp->u[5]});
  const double d = at.damping2;
  CHECK(std::abs(at.detuning2) == Approx(std::sqrt(3.0) * d).epsilon(1e-8));
  CHECK(at.load_re * at.load_re + at.load_im * at.load_im == Approx(8.0 * std::sqrt(3.0) * d * d * d / (9.0 * std::abs(at.g4))).epsilon(1e-8));
}

TEST_CASE("the chart of the stay ends exactly on its bounds", "[published]") {
  const Chart chart;
  const Branch planar = chart.planar();
  const auto onset = std::find_if(planar.special.begin(), planar.special.end(), [](const auto& s) { return s.type == EventType::branch_point; });
  REQUIRE(onset != planar.special.end());
  TwoParameterOptions narrow = chart.follow_options;
  narrow.range1[1] = 1.8;
  const DefiningCurve c = follow(chart.f2, *onset, 0.5, narrow);
  const auto last = c.u.cols() - 1;
  CHECK(std::max(c.u(4, 0), c.u(4, last)) == 1.8);  // exactly
  CHECK(std::max(c.u(5, 0), c.u(5, last)) == 0.8);
  CHECK(c.start_reason == StopReason::parameter_bound);
  CHECK(c.stop_reason == StopReason::parameter_bound);
  const CodimensionTwo* least = find(c, "MIN");
  REQUIRE(least);
  CHECK(least->u[5] == Approx(0.3225487668).epsilon(1e-9));
}
