// Exact periodic motions of the Oresund stay (nk-reduced, exact coefficients, U = 0.5 m): all special points found by the walker at default settings.
// Reference: AUTO-07p and an extended Newton on the Poincare map, agreeing to 1e-9 .. 1e-11.
#include <catch2/catch.hpp>

#include "continuation/orbit_network.hpp"
#include "continuation/torus.hpp"
#include "core/newton.hpp"
#include "models/harmonic_balance.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::models;

namespace {

struct Expected {
  std::string branch, type, subtype;
  double omega;
  int before, after;
};

OrbitNetwork whole(const HarmonicBalance& hb, double lower, double upper, int doublings) {
  OrbitNetwork net(hb, {.walk = {.lower = lower, .upper = upper}, .depth = 2}, doublings);
  net.set_namer([](const Branch& b, int level) { return std::string(level == 0 ? "" : "D") + (b.active_reflections.empty() ? "W" : "IP"); });
  const NewtonResult start = newton(hb, hb.linear_response(Vector::Constant(1, lower)));
  REQUIRE(start.ok());
  net.add_seed(start.x, "start");
  net.switch_branches();
  return net;
}

void compare(const Network& net, const std::vector<Expected>& expected) {
  std::size_t next = 0;
  for (const auto& b : net.branches())
    for (const auto& s : b.special) {
      INFO(b.name << " " << to_string(s.type) << s.subtype << " at " << s.u[s.u.size() - 1]);
      REQUIRE(next < expected.size());
      const Expected& e = expected[next++];
      CHECK(b.name == e.branch);
      CHECK(to_string(s.type) == e.type);
      CHECK(s.subtype == e.subtype);
      CHECK(s.u[s.u.size() - 1] == Approx(e.omega).margin(6e-11));  // the last digit of the references
      CHECK(s.unstable_before == e.before);
      CHECK(s.unstable_after == e.after);
      CHECK(s.residual < 1e-12);
      CHECK(s.bracket[0] <= s.u[s.u.size() - 1]);
      CHECK(s.bracket[1] >= s.u[s.u.size() - 1]);
    }
  CHECK(next == expected.size());
}

}  // namespace

TEST_CASE("orbits: every special point of the Oresund stay's exact motions, doubled ones included", "[published][slow]") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 20});
  const OrbitNetwork net = whole(hb, 1.05, 2.4, 1);
  compare(net.network(0), {{"IP1", "LP", "", 1.15867469377, 0, 1},
                           {"IP1", "LP", "", 1.11215361987, 1, 0},
                           {"IP1", "BP", "WH", 1.58096018215, 0, 1},
                           {"IP1", "BP", "WH", 1.76702117141, 1, 0},
                           {"IP1", "LP", "", 1.98244040998, 0, 1},
                           {"IP1", "LP", "", 1.70366257099, 1, 0},
                           {"IP1", "PD", "", 1.99835488392, 0, 1},
                           {"IP1", "PD", "", 2.0896029917, 1, 2},
                           {"IP1", "PD", "", 2.09239906453, 2, 1},
                           {"IP1", "PD", "", 2.18158882051, 1, 0},
                           {"W1", "LP", "", 1.82142291407, 0, 1},
                           {"W1", "LP", "", 1.74819639879, 1, 0},
                           {"W1", "TR", "", 1.74827864899, 0, 2},
                           {"W1", "TR", "", 1.82943396851, 2, 0},
                           {"W1", "LP", "", 1.82961925092, 0, 1},
                           {"W1", "BP", "WH", 1.76702117141, 1, 1}});  // arrives at the in-plane branch: counted on its own side
  // Period two: from the first doubling out of plane, from the first in plane, and the branch between them.
  compare(net.network(1), {{"DIP1", "BP", "SB", 2.20058902236, 0, 1},
                           {"DIP1", "LP", "", 2.35252829193, 1, 2},
                           {"DIP1", "BP", "PD", 2.09239906453, 2, 2},
                           {"DIP2", "BP", "WH", 2.09280869517, 1, 0},
                           {"DIP2", "LP", "", 2.37183171078, 0, 1},
                           {"DIP2", "BP", "PD", 2.18158882051, 1, 1},
                           {"DW1", "BP", "WH", 2.09280869517, 1, 1}});
  CHECK(net.network(1).branches()[0].born_at == "IP1:PD1");
  CHECK(net.network(1).branches()[1].born_at == "IP1:PD2");
  CHECK(net.network(1).branches()[2].born_at == "DIP1:BP1");
}

TEST_CASE("orbits: two doublings 0.003 rad/s apart are told apart by their directions") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 12});
  Walker walker(hb, {.lower = 2.02, .upper = 2.15});  // steps of up to 0.005 rad/s
  const NewtonResult start = newton(hb, hb.linear_response(Vector::Constant(1, 2.15)));
  REQUIRE(start.ok());
  const Branch b = walker.walk(start.x);
  REQUIRE(b.special.size() == 2);
  CHECK(to_string(b.special[0].type) == std::string("PD"));
  CHECK(to_string(b.special[1].type) == std::string("PD"));
  CHECK(b.special[0].block == 0);  // in plane
  CHECK(b.special[1].block == 1);  // out of plane
  CHECK(b.special[0].u[hb.size()] == Approx(2.0896029917).margin(1e-9));
  CHECK(b.special[1].u[hb.size()] == Approx(2.09239906453).margin(1e-9));
}

TEST_CASE("orbits: the multipliers at a torus point stand on the unit circle at the angle of its frequency") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 20});
  const OrbitNetwork net = whole(hb, 1.5, 1.9, 0);
  int tori = 0;
  for (const auto& b : net.network(0).branches())
    for (const auto& s : b.special) {
      if (s.type != EventType::torus) continue;
      ++tori;
      const double angle = s.frequency * 2.0 * 3.14159265358979323846 / s.u[hb.size()];
      double nearest = 1.0;
      for (const auto& mu : hb.floquet(s.u).multipliers) nearest = std::min(nearest, std::abs(mu - std::polar(1.0, angle)));
      CHECK(nearest < 1e-8);  // Hill's exponents and the integrated multipliers, two ways to one number
    }
  CHECK(tori == 2);
}

TEST_CASE("orbits: Jacobian of the torus system against differences") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega"), Lens("support_motion.amplitude")}, {.harmonics = 4});
  const int n = hb.size();
  Vector u(n + 2);
  for (int i = 0; i < n; ++i) u[i] = 0.3 * std::sin(1.0 + 1.7 * i) / (1.0 + i % 9);
  u[n] = 1.8;
  u[n + 1] = 0.5;
  Indices all(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) all[static_cast<std::size_t>(i)] = i;
  const TorusSystem system(hb, all, all, u, 0.3);
  Vector y(system.size() + system.parameters());
  y << system.unknowns(u).head(n + 2), 0.5;
  y[n + 1] = 0.31;
  Matrix j(system.size(), y.size());
  system.jacobian(y, j);
  for (int c = 0; c < y.size(); ++c) {
    const double h = 1e-6;
    Vector up = y, down = y, ru(system.size()), rd(system.size());
    up[c] += h;
    down[c] -= h;
    system.residual(up, ru);
    system.residual(down, rd);
    CHECK((j.col(c) - (ru - rd) / (2.0 * h)).lpNorm<Eigen::Infinity>() <
          1e-6 * (1.0 + j.col(c).lpNorm<Eigen::Infinity>()));  // differences hold 7 digits
  }
}
