// Basins of attraction and sweeps with their jumps.
#include "models/basins.hpp"

#include <catch2/catch.hpp>

#include "models/nielsen_kirkegaard.hpp"
#include "models/sweeps.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

ModalSystem<double> stay(double omega) {
  const auto p = oresund(0.5, omega);
  return nielsen_kirkegaard(p, stay_model(p.cable, Coefficients::exact), Terms::reduced);
}
std::vector<Reflection> whirling() { return {{point({-1, 1, -1, 1}), "WH"}}; }

// x'' + c x' + k x + a x^3 = F cos(omega t); for F = 0 two wells at +-sqrt(-k/a).
ModalSystem<double> duffing(double c, double k, double a, double F, double omega) {
  ModalSystem<double> s;
  s.omega = omega;
  s.damping = {c};
  s.stiffness = {k};
  s.add_term(0, a, {0, 0, 0});
  s.add_force(0, F, 1);
  return s;
}

}  // namespace

TEST_CASE("two wells: basins that energy decides, mirrored and not, with any number of threads") {
  // Strong damping, no force: a start at rest in x > 0 stays in the right-hand well. E < 0 never crosses the barrier.
  const auto wells = duffing(0.5, -1.0, 1.0, 0.0, 1.0);
  const std::vector<Reflection> mirror{{point({-1, -1}), "left-right"}};
  BasinOptions o;
  o.x = {0, -1.3, 1.3, 40};
  o.y = {1, -0.9, 0.9, 30};
  o.base = Vector::Zero(2);
  o.check_share = 0.1;
  std::vector<BasinMap> maps;
  for (const bool symmetry : {false, true})
    for (const unsigned threads : {1u, 3u}) {
      o.use_symmetry = symmetry;
      o.threads = threads;
      maps.push_back(basins(wells, mirror, o));
    }
  for (const auto& map : maps) {
    REQUIRE(map.complete);
    REQUIRE(map.attractors.size() == 2);
    CHECK(map.attractors[0].points(0, 0) == Approx(1.0).epsilon(1e-9));  // of mirror images the one to the right is first
    CHECK(map.attractors[1].points(0, 0) == Approx(-1.0).epsilon(1e-9));
    CHECK(map.attractors[0].mirror_of == 1);
    for (int j = 0; j < 30; ++j)
      for (int i = 0; i < 40; ++i) {
        const double x = o.x.at(i), v = o.y.at(j), energy = 0.5 * v * v - 0.5 * x * x + 0.25 * x * x * x * x;
        if (energy < 0.0) CHECK(map.cell(j, i) == (x > 0.0 ? 0 : 1));
        CHECK(map.cell(j, i) == 1 - map.cell(29 - j, 39 - i));
      }
    CHECK(map.cell == maps[0].cell);
    CHECK(map.checked >= 55);
    CHECK(map.disagreed == 0);
    CHECK(map.share(0) == Approx(0.5));
  }
  CHECK(maps[1].integrated == 1200);
  CHECK(maps[3].integrated == 600);
  CHECK(maps[3].symmetry == "left-right");
}

TEST_CASE("a basin map of the stay: every cell is where CVODE goes") {
  BasinOptions o;
  o.x = {0, -6, 6, 9};
  o.y = {1, -6, 6, 9};
  o.base = Vector::Zero(4);
  o.check_share = 1.0;
  const auto system = stay(2.15);
  const BasinMap map = basins(system, whirling(), o);
  REQUIRE(map.attractors.size() == 2);
  CHECK(map.disagreed == 0);
  CHECK(map.integrated == 45);
  CHECK(map.checked == 45);
  // In plane first: it extends less far. Coupled (3,2) motion beside it, both of period two.
  CHECK(map.attractors[0].points.row(0).cwiseAbs().maxCoeff() < 1e-8);
  CHECK(map.attractors[1].points.row(0).cwiseAbs().maxCoeff() > 0.3);
  for (const auto& a : map.attractors) CHECK(a.multiple == 2);
  for (const int cell : {3, 14, 40, 42, 61, 69}) {
    const int i = cell % 9, j = cell / 9;
    Vector y = point({o.x.at(i), o.y.at(j), 0, 0});
    if (y[0] == 0.0) y[0] = 1e-6;
    const SteadyMotion m = settle(system, y, {.tolerance = 1e-6});
    REQUIRE(m.kind == MotionKind::periodic);
    CHECK((map.attractors[static_cast<std::size_t>(map.cell(j, i))].points.colwise() - m.state).colwise().norm().minCoeff() < 1e-3);
  }
}

TEST_CASE("starts in an invariant plane are pushed off it, axes may be velocities, misuse throws") {
  BasinOptions o;
  o.x = {1, -2, 2, 3};
  o.y = {3, -2, 2, 3};  // q2, q2': q1 = 0 throughout
  o.base = Vector::Zero(4);
  const BasinMap map = basins(stay(1.65), whirling(), o);  // in-plane motion is unstable there
  CHECK(map.symmetry.empty());
  REQUIRE(map.attractors.size() == 2);
  for (const auto& a : map.attractors) CHECK(a.points.row(0).cwiseAbs().maxCoeff() > 0.5);
  CHECK((map.cell.array() >= 0).all());
  o.y.state = 1;
  CHECK_THROWS_AS(basins(stay(1.65), whirling(), o), std::invalid_argument);
  o.y = {3, 2, -2, 3};
  CHECK_THROWS_AS(basins(stay(1.65), whirling(), o), std::invalid_argument);
  o.y = {3, -2, 2, 3};
  o.base = Vector::Zero(3);
  CHECK_THROWS_AS(basins(stay(1.65), whirling(), o), std::invalid_argument);
}

TEST_CASE("diverging starts and an interrupted map") {
  // Soft spring: beyond the potential's hill at |x| = 1 the motion leaves for good.
  const auto soft = duffing(0.1, 1.0, -1.0, 0.0, 1.0);
  BasinOptions o;
  o.x = {0, -1.5, 1.5, 16};
  o.y = {1, -0.05, 0.05, 2};
  o.base = Vector::Zero(2);
  const BasinMap map = basins(soft, {}, o);
  for (int i = 0; i < 16; ++i)
    if (std::abs(std::abs(o.x.at(i)) - 1.0) > 0.1) CHECK(map.cell(0, i) == (std::abs(o.x.at(i)) < 1.0 ? 0 : BasinMap::diverging));
  const std::atomic<bool> stop{true};
  o.settle.interrupted = &stop;
  const BasinMap none = basins(soft, {}, o);
  CHECK_FALSE(none.complete);
  CHECK((none.cell.array() == BasinMap::not_computed).all());
}

TEST_CASE("sweeps jump at the folds, up at one and down at the other", "[published][slow]") {
  // In plane: folds 1.98244040998 (up) and 1.70366257099 (down). Whirling: fold 1.82142291407 on the way up, whirling points 1.58096018215.
  const auto at = [](double p) { return stay(p); };
  SweepOptions o;
  o.tolerance = 1e-4;
  o.settle.max_periods = 1500;
  std::vector<double> values;
  for (int i = 0; i <= 16; ++i) values.push_back(1.5 + 0.02 * i);
  const Sweep up = sweep(at, values, Vector::Zero(4), o);
  REQUIRE(up.points.size() == values.size());
  REQUIRE(up.transitions.size() >= 1);
  CHECK_FALSE(up.transitions[0].jump);
  CHECK(up.transitions[0].what.find("q1 starts") != std::string::npos);
  CHECK(up.transitions[0].before < 1.58096018215 + 1e-3);  // critically slow there: the bracket may be wider than asked for
  CHECK(up.transitions[0].after > 1.58096018215 - 1e-3);
  // The whirling motion at 1.79 rad/s, and from there over its fold.
  const Sweep over = sweep(at, {1.79, 1.80, 1.81, 1.82, 1.83}, point({-3.18821, 1.119354, 6.146217, 12.20493}), o);
  REQUIRE(over.transitions.size() == 1);
  CHECK(over.transitions[0].jump);
  CHECK(over.transitions[0].before < 1.82142291407);
  CHECK(over.transitions[0].after > 1.82142291407);
  CHECK(over.transitions[0].after - over.transitions[0].before < 1e-4);
  CHECK(over.transitions[0].what.find("q1 stops") != std::string::npos);
  // The low motion in plane at 1.78 rad/s, and down over its fold.
  AttractorFinder low(stay(1.78));
  const Settled start = low.settle(point({0.01, 0, 0, 0}), AttractorSet());
  REQUIRE(start.kind == MotionKind::periodic);
  const Sweep down = sweep(at, {1.78, 1.76, 1.74, 1.72, 1.70, 1.68}, start.state, o);
  REQUIRE(down.transitions.size() == 1);
  CHECK(down.transitions[0].jump);
  CHECK(down.transitions[0].before > 1.70366257099);
  CHECK(down.transitions[0].after < 1.70366257099);
  CHECK_THROWS_AS(sweep(at, {1.7}, Vector::Zero(4), {.tolerance = 0.0}), std::invalid_argument);
}
