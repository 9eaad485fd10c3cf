#include <catch2/catch.hpp>

#include "continuation/walker.hpp"
#include "models/modal_model.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

ModalModel duffing() { return {.frequency = {1.0}, .damping = {0.05}, .terms = {{0, 0.1, {3}}}, .forces = {{0, 0.18}}}; }

ModalModel whirling_string() {
  return {.frequency = {1.0, 1.0},
          .damping = {0.02, 0.02},
          .terms = {{0, 1.0, {3, 0}, 0, "k"}, {0, 1.0, {1, 2}, 0, "k"}, {1, 1.0, {2, 1}, 0, "k"}, {1, 1.0, {0, 3}, 0, "k"}},
          .forces = {{0, 0.01}},
          .mirror_subtype = "WH"};
}

std::vector<double> acceleration(const ModalSystem<double>& s, double phase, std::vector<double> y) {
  std::vector<double> dydt(y.size());
  s.flow<double>(phase, y, dydt);
  return {dydt.begin() + s.size(), dydt.end()};
}

ModalSystem<double> at(const ParametricSystem& system, std::vector<double> p) {
  ModalSystem<double> out;
  system.at(std::span<const double>(p), out);
  return out;
}

std::string complaint(const ModalModel& m) {
  try {
    m.validate();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("a modal model gives the accelerations written down by hand") {
  ModalModel m = whirling_string();
  m.terms.push_back({1, 0.3, {0, 1}, 2});  // parametric: 0.3 q2 cos 2 wt
  m.forces.push_back({1, 0.07, 3});
  const double y = 0.4, z = -0.7, dy = 0.2, dz = 0.9, phase = 0.35;
  const auto a = acceleration(modal_system(m), phase, {y, z, dy, dz});
  CHECK(a[0] == Approx(0.01 * std::cos(phase) - 0.02 * dy - y - y * (y * y + z * z)).epsilon(1e-14));
  CHECK(a[1] == Approx(0.07 * std::cos(3 * phase) - 0.02 * dz - z - z * (y * y + z * z) - 0.3 * z * std::cos(2 * phase)).epsilon(1e-14));
}

TEST_CASE("a stiffness matrix couples coordinates") {
  ModalModel m{.frequency = {}, .stiffness = {{2.0, -1.0}, {-0.5, 3.0}}, .damping = {0.1, 0.2}};
  const auto a = acceleration(modal_system(m), 0.0, {0.3, 0.8, 0.0, 1.0});
  CHECK(a[0] == Approx(-(2.0 * 0.3 - 0.8)).epsilon(1e-14));
  CHECK(a[1] == Approx(-(-0.5 * 0.3 + 3.0 * 0.8) - 0.2).epsilon(1e-14));
  const auto system = modal_system(m, {"stiffness[1][2]"});
  CHECK(acceleration(at(system, {0.0}), 0.0, {0.3, 0.8, 0.0, 0.0})[0] == Approx(-0.6).epsilon(1e-14));
}

TEST_CASE("every number of a modal model is a lens") {
  const ModalModel m = whirling_string();
  for (const auto& name : m.lens_names()) {
    CAPTURE(name);
    const auto system = modal_system(m, {name});
    CHECK(system.reference()[0] == m.lens_value(name));
    const auto base = acceleration(modal_system(m), 0.3, {0.5, 0.6, 0.7, 0.8}),
               same = acceleration(at(system, {m.lens_value(name)}), 0.3, {0.5, 0.6, 0.7, 0.8});
    CHECK(base == same);
    auto moved = at(system, {1.5 * m.lens_value(name)});
    const auto other = acceleration(moved, 0.3, {0.5, 0.6, 0.7, 0.8});
    CHECK((base != other) == (name != "omega"));
    if (name == "omega") CHECK(moved.omega == 1.5);
    CHECK(m.lens_value("modal_model." + name) == m.lens_value(name));
  }
  CHECK(m.lens_unit("force[1].amplitude") == "m/s^2");
  const auto k = at(modal_system(m, {"k", "damping"}), {2.0, 0.5});
  for (const auto& t : k.terms) CHECK(t.coefficient == 2.0);
  for (const double c : k.damping) CHECK(c == 0.5);
  CHECK_THROWS_WITH(modal_system(m, {"force[2].amplitude"}), Catch::StartsWith("no parameter 'force[2].amplitude'; accepted: omega, frequency[1]"));
  CHECK_THROWS_WITH(modal_system(m, {"k", "term[2].coefficient"}), "term[2].coefficient is free twice");
  ModalModel uneven = m;
  uneven.damping[1] = 0.03;
  CHECK_THROWS_WITH(modal_system(uneven, {"damping"}), "'damping' stands for numbers that differ: choose one, such as damping[1]");
}

TEST_CASE("damping ratios follow the frequencies") {
  ModalModel m{.frequency = {2.0}, .damping_ratio = {0.1}};
  const auto s = at(modal_system(m, {"frequency[1]"}), {3.0});
  CHECK(s.stiffness[0] == 9.0);
  CHECK(s.damping[0] == Approx(0.6).epsilon(1e-15));
}

TEST_CASE("sign symmetries come from the powers") {
  const auto signs = [](const ModalModel& m, const std::vector<std::string>& lenses = {}) {
    std::vector<std::vector<int>> all;
    for (const auto& r : mirrors(m, lenses)) all.push_back(r.signs);
    return all;
  };
  CHECK(signs(duffing()).empty());  // forced
  CHECK(signs(whirling_string()) == std::vector<std::vector<int>>{{1, -1}});
  CHECK(mirrors(whirling_string()).front().subtype == "WH");
  ModalModel free = whirling_string();
  free.forces[0].amplitude = 0.0;
  CHECK(signs(free) == std::vector<std::vector<int>>{{-1, 1}, {1, -1}});
  CHECK(signs(free, {"force[1].amplitude"}) == std::vector<std::vector<int>>{{1, -1}});  // it may become non-zero
  ModalModel internal{.frequency = {1.0, 2.0, 3.0}, .terms = {{0, 1.0, {1, 1, 0}}, {1, 1.0, {2, 0, 0}}, {2, 1.0, {1, 1, 0}}}};
  CHECK(signs(internal) == std::vector<std::vector<int>>{{-1, 1, -1}});  // q1 q2 drives q3: q1 and q3 change sign together
}

TEST_CASE("a modal model that contradicts itself gives one line") {
  ModalModel m = duffing();
  m.stiffness = {{1.0}};
  CHECK(complaint(m) == "give either frequency or stiffness");
  m = duffing();
  m.terms[0].powers = {3, 1};
  CHECK(complaint(m) == "term[1]: 2 powers for 1 coordinates");
  m = duffing();
  m.terms[0].powers = {9};
  CHECK(complaint(m) == "term[1]: powers sum to 9, at most 8");
  m = duffing();
  m.forces[0].equation = 1;
  CHECK(complaint(m) == "force[1]: equation must be in 1..1, got 2");
  m = duffing();
  m.damping = {0.1, 0.2};
  CHECK(complaint(m) == "damping has 2 values for 1 coordinates");
}

namespace {

std::vector<double> events(const continuation::Branch& b, continuation::EventType type) {
  std::vector<double> found;
  for (const auto& s : b.special)
    if (s.type == type) found.push_back(s.u[s.u.size() - 1]);
  std::sort(found.rbegin(), found.rend());
  return found;
}

continuation::Branch response(const ModalModel& m, double from, double to) {
  const HarmonicBalance hb(modal_system(m, {"omega"}), {.harmonics = 15, .reflections = mirrors(m, {"omega"})});
  Vector p(1);
  p << from;
  const NewtonResult start = newton(hb, hb.linear_response(p));
  REQUIRE(start.ok());
  continuation::WalkOptions o;
  o.lower = from;
  o.upper = to;
  return continuation::Walker(hb, o).walk(start.x);
}

}  // namespace

TEST_CASE("folds of exact periodic motions: Duffing", "[published]") {
  // NLvib's case, and a second one; both by shooting to 1e-9 elsewhere.
  ModalModel m = duffing();
  auto folds = events(response(m, 0.6, 1.6), continuation::EventType::fold);
  REQUIRE(folds.size() == 2);
  CHECK(folds[0] == Approx(1.269601956).epsilon(1e-9));  // printed to nine decimals
  CHECK(folds[1] == Approx(1.115700252).epsilon(1e-9));
  m = {.frequency = {1.0}, .damping = {0.04}, .terms = {{0, 1.0, {3}}}, .forces = {{0, 0.015}}};
  folds = events(response(m, 0.8, 1.3), continuation::EventType::fold);
  REQUIRE(folds.size() == 2);
  CHECK(folds[0] == Approx(1.049262399).epsilon(1e-9));
  CHECK(folds[1] == Approx(1.043913709).epsilon(1e-9));
}

TEST_CASE("the whirling string as a modal model: whirl onset and planar folds of exact periodic motions") {
  const continuation::Branch b = response(whirling_string(), 0.8, 1.3);
  const auto folds = events(b, continuation::EventType::fold), onset = events(b, continuation::EventType::branch_point);
  REQUIRE(folds.size() == 2);
  REQUIRE(onset.size() == 2);
  CAPTURE(folds, onset);
  // One-term averaging gives 1.0779949255, 1.0370229451 and 1.0728304789, 1.0180097647; the exact motion differs by its third harmonic.
  const double averaged[] = {1.0779949255, 1.0370229451, 1.0728304789, 1.0180097647};
  for (int i = 0; i < 2; ++i) {
    CHECK(folds[static_cast<std::size_t>(i)] == Approx(averaged[i]).epsilon(2e-3));
    CHECK(onset[static_cast<std::size_t>(i)] == Approx(averaged[i + 2]).epsilon(2e-3));
  }
  for (const auto& s : b.special)
    if (s.type == continuation::EventType::branch_point) CHECK(s.subtype == "WH");
}
