/// Averaged stays of random size, damping and support motion, walked as `whirl run` does: every stay has branches, none is told twice, and where a
/// whirling branch ends an in-plane branch is known.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "continuation/network.hpp"
#include "core/kinsol.hpp"
#include "models/closed_forms.hpp"

using namespace whirl;
using namespace whirl::models;
using namespace whirl::continuation;

namespace {

struct RandomStay {
  StayParameters<double> stay;
  int order;
  double lower, upper;
};

// Sags of a ten-thousandth to a thirtieth, frequencies about the superharmonic resonance w1 / n, damping ratios 3e-4 .. 0.04.
RandomStay random_stay(unsigned number) {
  std::mt19937 random(number);
  const auto log_between = [&](double a, double b) { return std::exp(std::uniform_real_distribution<double>(std::log(a), std::log(b))(random)); };
  RandomStay r;
  auto& c = r.stay.cable;
  c.chord_length = log_between(10.0, 600.0);
  c.mass_per_length = log_between(0.1, 5000.0);
  c.inclination_deg = std::uniform_real_distribution<double>(-65.0, 65.0)(random);
  c.gravity = 9.81;
  const double sag = log_between(1e-4, 0.03);
  c.chord_tension = c.mass_per_length * c.gravity * c.chord_length * std::cos(c.inclination_deg * std::numbers::pi / 180.0) / (8.0 * sag);
  c.axial_stiffness = c.chord_tension / log_between(4e-5, 0.03);
  r.stay.damping_out_of_plane = log_between(3e-4, 0.04);
  r.stay.damping_in_plane = log_between(3e-4, 0.04);
  r.stay.support_amplitude = c.chord_length * log_between(1e-5, 2e-3);
  r.order = std::max(2, static_cast<int>(random() % 10) - 5);
  const double resonance = std::numbers::pi / c.chord_length * std::sqrt(c.chord_tension / c.mass_per_length) / r.order;
  r.lower = 0.6 * resonance;
  r.upper = 1.6 * resonance;
  return r;
}

using States = std::vector<Eigen::Vector4d> (*)(const SlowFlowCoefficients<double>&);

void seed(Network& net, const SuperharmonicFlow& flow, const RandomStay& r, States states, int grid = 61) {
  for (int i = 0; i < grid; ++i) {
    const double w = r.lower + (r.upper - r.lower) * i / (grid - 1);
    for (const auto& x : states(flow.model().coefficients<double>(std::array<double, 1>{w}))) {
      Vector u(5);
      u << x, w;
      (void)net.add_seed(u, "closed form");
    }
  }
}

bool is_told_twice(const std::vector<Branch>& all) {
  std::vector<const SpecialPoint*> points;
  for (const auto& b : all)
    for (const auto& s : b.special)
      if (s.type != EventType::branch_point && s.type != EventType::unresolved) points.push_back(&s);
  const auto same = [](const SpecialPoint& a, const SpecialPoint& b) {
    const Eigen::Vector4d mirror(-b.u[0], -b.u[1], b.u[2], b.u[3]);
    const double apart = std::min((a.u.head(4) - b.u.head(4)).norm(), (a.u.head(4) - mirror).norm());
    return a.type == b.type && std::abs(a.u[4] - b.u[4]) < 1e-8 * a.u[4] && apart < 1e-6 * a.u.head(4).norm();
  };
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (same(*points[i], *points[k])) return true;
  return false;
}

// Where a whirling branch ends, is there an in-plane branch?
bool landings_are_known(const SuperharmonicFlow& flow, const std::vector<Branch>& all, double range) {
  const auto on_in_plane = [&](In u) {
    return std::any_of(all.begin(), all.end(),
                       [&](const Branch& b) { return !b.active_reflections.empty() && lies_on(flow, b, BranchShape(b), u, {.range = range}); });
  };
  return std::all_of(all.begin(), all.end(), [&](const Branch& b) {
    return (b.stop_reason != StopReason::symmetric_branch || on_in_plane(b.u(b.points() - 1))) &&
           (b.start_reason != StopReason::symmetric_branch || on_in_plane(b.u(0)));
  });
}

void walk(unsigned number) {
  CAPTURE(number);
  const RandomStay r = random_stay(number);
  const SuperharmonicFlow flow(r.stay, {.order = r.order}, {Lens("omega")});
  NetworkOptions o;
  o.walk.lower = r.lower;
  o.walk.upper = r.upper;
  Network net(flow, o);
  Vector start = Vector::Zero(5);
  start[4] = r.lower;
  if (const NewtonResult first = line_search_solve(flow, start); first.ok()) (void)net.add_seed(first.x, "start");
  seed(net, flow, r, in_plane_states);
  net.switch_branches();
  seed(net, flow, r, coupled_states);
  net.switch_branches();
  CHECK_FALSE(net.branches().empty());
  CHECK(net.notes().empty());
  CHECK_FALSE(is_told_twice(net.branches()));
  CHECK(landings_are_known(flow, net.branches(), r.upper - r.lower));
  if (r.order > 3) CHECK(net.branches().size() == 1);  // no load at this order: zero

  // Only from whirling motion at one frequency: the in-plane branch is met where whirling ends.
  Network whirling(flow, o);
  seed(whirling, flow, r, coupled_states, 5);
  whirling.switch_branches();
  CHECK(landings_are_known(flow, whirling.branches(), r.upper - r.lower));
  CHECK_FALSE(is_told_twice(whirling.branches()));
}

}  // namespace

TEST_CASE("random averaged stays: nothing fails to start, nothing is told twice") {
  for (unsigned number = 1; number <= 60; ++number) walk(number);
}

TEST_CASE("seven hundred random averaged stays", "[slow]") {
  for (unsigned number = 1001; number <= 1700; ++number) walk(number);
}

TEST_CASE("closed forms: every state is polished and none is listed twice, next to folds and with the lightest damping") {
  for (unsigned number = 1; number <= 200; ++number) {
    const RandomStay r = random_stay(number);
    const SuperharmonicFlow flow(r.stay, {.order = r.order}, {Lens("omega")});
    for (int i = 0; i < 10; ++i) {
      const double w = r.lower + (r.upper - r.lower) * (i + 0.37) / 10.0;
      const auto c = flow.model().coefficients<double>(std::array<double, 1>{w});
      CAPTURE(number, w);
      const auto planar = in_plane_states(c), coupled = coupled_states(c);
      CHECK((r.order > 3 || planar.size() == 1 || planar.size() == 3));  // positive roots of a cubic with an odd number of changes of sign
      for (const auto& states : {planar, coupled})
        for (const auto& x : states) {
          Vector u(5);
          u << x, w;
          CHECK(newton_error(flow, u) <= 1e-9 * x.norm());
        }
    }
  }
}
