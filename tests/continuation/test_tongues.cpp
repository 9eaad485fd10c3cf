// Tongues of parametric instability narrower than a step: both of their edges, or none.
#include <catch2/catch.hpp>

#include "core/dual_problem.hpp"
#include "tests/continuation/random_tongues.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::tongues;

namespace {

struct Family {
  std::function<Case(std::mt19937&)> draw;
  int grid;     // of the reference
  double most;  // widths of the tongue that a range may have
};

const Family mathieu{mathieu_duffing, 40, 1e4}, sums{sum_resonance, 60, 1e3};
const Family two_modes{[](std::mt19937& random) { return cable(random, 1); }, 80, 100.0};
const Family four_modes{[](std::mt19937& random) { return cable(random, 2); }, 80, 100.0};

// Walks at default steps beside the reference; returns the number of edges there are.
int check_family(const Family& family, unsigned first, unsigned last) {
  int edges = 0;
  for (unsigned seed = first; seed < last; ++seed) {
    std::mt19937 random(seed);
    const Case c = family.draw(random);
    bool ok = true;
    const auto all = Reference(c).edges(c.resonance * (1.0 - c.window), c.resonance * (1.0 + c.window), family.grid, ok);
    if (!ok) continue;  // a fold of the planar motion
    const auto [lower, upper] = stretch(c, all, random, family.most);
    const Comparison result = compare(c, lower, upper, family.grid);
    if (!result.ok) continue;
    CAPTURE(c.family, seed, lower, upper);
    CHECK(result.missed == 0);
    CHECK(result.unresolved == 0);
    CHECK(result.extra == 0);
    edges += result.edges;
  }
  return edges;
}

std::vector<double> places(const Branch& b, EventType type) {
  std::vector<double> found;
  for (const auto& s : b.special)
    if (s.type == type) found.push_back(s.u[s.u.size() - 1]);
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

TEST_CASE("tongues: a hundred random ones at default steps, both edges of each and nothing else") {
  CHECK(check_family(mathieu, 0, 60) > 80);
  CHECK(check_family(sums, 0, 22) > 20);
  CHECK(check_family(two_modes, 0, 15) > 20);
  CHECK(check_family(four_modes, 13, 16) >= 6);
  CHECK(check_family(four_modes, 1119, 1120) == 4);  // two of them: the antisymmetric mode in plane at its own frequency, a multiplier of 1
}

TEST_CASE("tongues: two thousand random ones at default steps, both edges of each and nothing else", "[slow]") {
  CHECK(check_family(mathieu, 1000, 2000) > 1500);
  CHECK(check_family(sums, 1000, 1300) > 400);
  CHECK(check_family(two_modes, 1000, 1550) > 900);
  CHECK(check_family(four_modes, 1000, 1150) > 150);
}

TEST_CASE("tongues: the Mathieu-Duffing oscillator far from its tongue on either side", "[published]") {
  ModalSystem<double> s;
  s.omega = 2.0;
  s.damping = {0.004};
  s.stiffness = {1.0};
  s.add_term(0, 0.02, {0}, 1);
  s.add_term(0, 1.0, {0, 0, 0});
  const HarmonicBalance hb(ParametricSystem::over_omega(s), {.harmonics = 10});
  for (const double upper : {2.1, 3.0, 9.0}) {
    const Branch b = Walker(hb, {.lower = 1.2, .upper = upper}).walk(hb.linear_response(Vector::Constant(1, 1.2)));
    const auto found = places(b, EventType::period_doubling);
    REQUIRE(found.size() == 2);
    CHECK(found[0] == Approx(1.99081841920354).epsilon(0).margin(1e-11));  // Floquet theory, monodromy matrix by a method of order 8
    CHECK(found[1] == Approx(2.00914858419246).epsilon(0).margin(1e-11));
    CHECK(b.special.size() == 2);
  }
}

TEST_CASE("tongues: a stay under deck motion at twice its first frequencies, whatever the range", "[published]") {
  CableModel m{.stay = {{220.0, 2.0e9, 7.115e6, 85.0, 22.5, 9.81}, 0.001, 0.001, 0.015, 8.0}, .end = End::lower, .direction = Direction::vertical};
  // Shooting with a Runge-Kutta method of order 8, and again with an extrapolation integrator.
  const double edges[2][4] = {{8.25101240262, 8.27488961171, 8.30668244109, 8.32712331192},
                              {8.24903514981, 8.27687306179, 8.30440260284, 8.32940938797}};
  for (const int half : {0, 1}) {
    m.stay.damping_out_of_plane = m.stay.damping_in_plane = half == 0 ? 0.001 : 0.0005;
    const HarmonicBalance hb(cable_system(m, {Lens("omega")}), {.harmonics = 10, .nu = 1, .reflections = cable_reflections(m), .floquet = {}});
    const std::pair<double, double> ranges[] = {{8.2, 8.36}, {7.6, 9.0}, {7.0, 9.5}, {6.0, 10.0}};
    for (const auto& [lower, upper] : ranges) {
      CAPTURE(half, lower, upper);
      const NewtonResult start = newton(hb, hb.linear_response(Vector::Constant(1, lower)));
      REQUIRE(start.ok());
      const Branch b = Walker(hb, {.lower = lower, .upper = upper}).walk(start.x);
      const auto found = places(b, EventType::period_doubling);
      REQUIRE(found.size() == 4);
      for (std::size_t i = 0; i < 4; ++i) CHECK(found[i] == Approx(edges[half][i]).epsilon(0).margin(1e-9));
    }
  }
}

TEST_CASE("tongues: no step passes over the sharp resonance of a coordinate that is hardly driven") {
  ModalSystem<double> s;
  const double zeta = 1e-4, w = 2.2, force = 1e-3;
  s.omega = 1.0;
  s.damping = {0.1, 2.0 * zeta * w};
  s.stiffness = {1.0, w * w};
  s.add_force(0, 1.0, 1);
  s.add_force(1, force, 1);
  const HarmonicBalance hb(ParametricSystem::over_omega(s), {.harmonics = 3});
  const Branch b = Walker(hb, {.lower = 0.2, .upper = 4.0}).walk(newton(hb, hb.linear_response(Vector::Constant(1, 0.2))).x);
  double highest = 0.0;
  for (int i = 0; i < b.points(); ++i) highest = std::max(highest, std::hypot(b.u(i)[hb.index(1, 1)], b.u(i)[hb.index(1, 1) + 1]));
  CHECK(highest > 0.9 * force / (2.0 * zeta * w * w));
  CHECK(b.special.empty());
}

TEST_CASE("multipliers in pairs: angles go on through 0 and pi, and past each other") {
  using std::numbers::pi;
  CHECK(folded(1.2 * pi) == Approx(0.8 * pi));
  CHECK(folded(-0.3) == Approx(0.3));
  CHECK(folded(7.0 * pi + 0.1) == Approx(pi - 0.1));
  bool turned = false;
  CHECK(unfolded(0.9 * pi, 1.08 * pi, turned) == Approx(1.1 * pi));
  CHECK(turned);
  CHECK(unfolded(0.9 * pi, 2.88 * pi, turned) == Approx(2.9 * pi));
  CHECK_FALSE(turned);
  MultiplierPairs pairing;
  const auto at = [&](std::initializer_list<double> angles) {
    Eigen::VectorXcd mu(2 * static_cast<Eigen::Index>(angles.size()));
    Eigen::Index i = 0;
    for (const double a : angles) {
      mu[i++] = std::polar(0.99, a);
      mu[i++] = std::polar(0.99, -a);
    }
    std::vector<MultiplierPair> pairs;
    pairing.list(mu, Eigen::VectorXi::Zero(mu.size()), pairs);
    return pairs;
  };
  auto a = at({2.8, 1.0}), b = at({2.9, 0.9}), c = at({3.0, 0.8}), d = at({2.0 * pi - 3.2, 0.6});  // the last step twice as long
  pairing.follow(a, 0.0, b);
  pairing.follow(b, 1.0, c);
  pairing.follow(c, 2.0, d);
  const auto& last = d.back();
  CHECK(last.angle == Approx(2.0 * pi - 3.2));
  CHECK(last.reached == Approx(3.2));
  CHECK(last.last_turn == Approx(-0.2));
  // A real pair within another: the largest with the smallest.
  Eigen::VectorXcd mu(4);
  mu << -0.99 * std::exp(0.02), -0.99 * std::exp(-0.02), -0.99 * std::exp(0.005), -0.99 * std::exp(-0.005);
  std::vector<MultiplierPair> real;
  pairing.list(mu, Eigen::VectorXi::Zero(4), real);
  REQUIRE(real.size() == 2);
  for (const auto& p : real) {
    CHECK(p.angle == pi);
    CHECK(p.growth == Approx(std::log(0.99)));
  }
  CHECK(std::max(real[0].split, real[1].split) == Approx(0.02));
}

namespace {

// x'' + 2 a x' + ((p - p0)^2 + b) x = x^3 about rest: eigenvalues -a +- sqrt(a^2 - b - (p - p0)^2), real next to p0; for b < 0 one of them is zero
// at p0 -+ sqrt(-b).
struct MeetingPair {
  double a, bottom, place;
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    const S distance = u[2] - place, stiffness = distance * distance + bottom;
    r[0] = u[1];
    r[1] = u[0] * u[0] * u[0] - u[0] * stiffness - u[1] * (2.0 * a);
  }
};

}  // namespace

TEST_CASE("equilibria: a pair that meets the real axis and passes zero twice within a step, or not quite") {
  for (const double half : {1e-2, 1e-3, 1e-4, 1e-5})
    for (const double place : {0.0, 0.137, -0.61803, 0.99})
      for (const double a : {0.3, 0.02, 1e-3})
        for (const double sign : {-1.0, 1.0}) {
          const DualProblem<MeetingPair> f({a, sign * half * half, place}, 2, 1, true);
          const Branch b = Walker(f, {.lower = -2.0, .upper = 3.0}).walk(Vector::Unit(3, 2) * -2.0);
          CAPTURE(half, place, a, sign);
          const auto found = places(b, EventType::branch_point);
          REQUIRE(found.size() == (sign < 0.0 ? 2 : 0));
          CHECK(b.special.size() == found.size());
          if (found.empty()) continue;
          CHECK(found[0] == Approx(place - half).epsilon(0).margin(1e-10));
          CHECK(found[1] == Approx(place + half).epsilon(0).margin(1e-10));
        }
}
