/// Points where a continuation easily goes wrong, at default options: branch points hit to the last digit, several events in one place, starts and
/// ends on singular points, several eigenvalues zero at once, curves more crooked than a step is long.

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/continuation/text_model.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::continuation::text_model;

namespace {

constexpr double located = 1e-10;  // relative, as events are told

System two_pitchforks(double d) {  // x breaks at p = 0, y at p = d; the mixed branch joins p = 2 d on the first and p = 3 d on the second
  return {{"x", "y"}, {"p*x - x^3 - 1.5*x*y^2", "(p-d)*y - y^3 - 0.5*y*x^2"}, {{"p", -1.0}, {"d", d}}};
}

System square_symmetry(std::vector<std::vector<std::string>> mirrors) {
  return {{"x", "y"}, {"p*x - x^3 - a*x*y^2", "p*y - y^3 - a*y*x^2"}, {{"p", -1.0}, {"a", 0.5}}, std::move(mirrors)};
}

System two_oscillators(double gap, double frequency) {  // pairs cross at p = 0 and p = gap
  return {{"x", "y", "z", "w"},
          {"p*x - y - x*(x^2+y^2)", "x + p*y - y*(x^2+y^2)", "(p-gap)*z - f*w - z^3", "f*z + (p-gap)*w - w^3"},
          {{"p", -1.0}, {"gap", gap}, {"f", frequency}}};
}

System lorenz(std::vector<std::vector<std::string>> mirrors) {
  return {{"x", "y", "z"},
          {"sigma*(y - x)", "x*(rho - z) - y", "x*y - beta*z"},
          {{"sigma", 10.0}, {"rho", 1.0}, {"beta", 8.0 / 3.0}},
          std::move(mirrors)};
}

void check_values(const std::vector<double>& found, const std::vector<double>& wanted) {
  CAPTURE(found, wanted);
  REQUIRE(found.size() == wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(std::abs(found[i] - wanted[i]) < located);
}

}  // namespace

TEST_CASE("branch points that a secant hits to the last digit") {
  for (const double d : {0.2, 0.3, 1e-5}) {
    const auto all = branches(two_pitchforks(d), "p", -1.0, 2.0, {{0.0, 0.0, -1.0}});
    CAPTURE(d);
    CHECK(sound(all));
    REQUIRE(all.size() == 4);  // rest, x, y and the mixed one
    check_values(values({all[0]}, EventType::branch_point), {0.0, d});
    check_values(values({all[1]}, EventType::branch_point), {2.0 * d, 2.0 * d});
    check_values(values({all[2]}, EventType::branch_point), {3.0 * d, 3.0 * d});
    CHECK(all[3].stop_reason == StopReason::closed_loop);  // once round, through the point it left from
    check_values(values({all[3]}, EventType::branch_point), {2.0 * d, 3.0 * d, 3.0 * d});
    CHECK(of_type(all, EventType::fold).empty());  // it turns at these points, but they are no folds
    for (const auto& b : all) CHECK_FALSE(b.mirror_image);
  }
}

TEST_CASE("a pitchfork on a fold is both, told or not told of the symmetry") {
  for (const std::vector<std::vector<std::string>>& mirrors : {std::vector<std::vector<std::string>>{}, {{"x"}}}) {
    const auto all = branches({{"s", "x"}, {"p - s^2", "s*x - x^3"}, {{"p", 1.0}}, mirrors}, "p", -1.0, 2.0, {{1.0, 0.0, 1.0}});
    CHECK(sound(all));
    CHECK(all.size() == 2);
    check_values(values({all[0]}, EventType::fold), {0.0});
    check_values(values({all[0]}, EventType::branch_point), {0.0});
  }
}

TEST_CASE("two pairs that cross at one value, or a ten-millionth apart") {
  for (const double gap : {0.0, 1e-7, 1e-4}) {
    const auto all = branches(two_oscillators(gap, 2.0), "p", -1.0, 1.1, {{0.0, 0.0, 0.0, 0.0, -1.0}});
    CAPTURE(gap);
    CHECK(sound(all));
    check_values(values(all, EventType::hopf), {0.0, gap});
    double lowest = 9.0, highest = 0.0;
    for (const auto& s : of_type(all, EventType::hopf)) {
      lowest = std::min(lowest, s.frequency);
      highest = std::max(highest, s.frequency);
    }
    CHECK(lowest == Approx(1.0).epsilon(1e-12));
    CHECK(highest == Approx(2.0).epsilon(1e-12));
  }
  // Pairs that share place and frequency cannot be told apart: one is located, the other reported.
  const auto same = branches(two_oscillators(0.0, 1.0), "p", -1.0, 1.1, {{0.0, 0.0, 0.0, 0.0, -1.0}});
  CHECK(of_type(same, EventType::hopf).size() == 1);
  CHECK(of_type(same, EventType::unresolved).size() == 1);
}

TEST_CASE("walks that start or end on a singular point") {
  for (const std::vector<std::vector<std::string>>& mirrors : {std::vector<std::vector<std::string>>{}, {{"x", "y"}}}) {
    for (const double lower : {0.0, 1.0}) {
      const auto all = branches(lorenz(mirrors), "rho", lower, 30.0, {{0.0, 0.0, 0.0, 1.0}});
      CAPTURE(lower, mirrors.size());
      CHECK(sound(all));
      REQUIRE(all.size() == 2);
      check_values(values({all[0]}, EventType::branch_point), {1.0});
      for (const double rho : values(all, EventType::hopf)) CHECK(std::abs(rho - 470.0 / 19.0) < 1e-9);
      CHECK(of_type(all, EventType::hopf).size() == (mirrors.empty() ? 2u : 1u));
      for (const auto& b : all) CHECK(b.parameter(b.points() - 1) == 30.0);
    }
  }
  const System fold{{"x"}, {"p - x^2"}, {{"p", 0.0}}};
  auto all = branches(fold, "p", -1.0, 1.0, {{0.0, 0.0}});
  CHECK(sound(all));
  REQUIRE(all.size() == 1);
  check_values(values(all, EventType::fold), {0.0});
  for (int i = 0; i < all[0].points(); ++i) CHECK(all[0].residual(i) < 1e-10);  // no walk off the curve
  all = branches({{"x"}, {"p*x - x^2"}, {{"p", 1.0}}}, "p", 0.0, 1.0, {{0.0, 1.0}, {1.0, 1.0}, {0.0, 0.0}});
  CHECK(sound(all));
  CHECK(all.size() == 2);  // the range ends on their branch point; no third
}

TEST_CASE("every fold of a crooked curve") {
  // p = x - a sin kx turns wherever a k cos kx = 1.
  for (const auto& [a, k] : {std::pair{4e-3, 300.0}, std::pair{3e-3, 400.0}, std::pair{0.05, 25.0}, std::pair{1.2e-3, 1000.0}}) {
    const auto all = branches({{"x"}, {"p - x + a*sin(k*x)"}, {{"p", 0.0}, {"a", a}, {"k", k}}}, "p", -1.0, 1.0, {{0.0, 0.0}}, 60000);
    std::size_t wanted = 0;
    const double phase = std::acos(1.0 / (a * k)), pi = std::acos(-1.0);
    for (const double sense : {1.0, -1.0})
      for (int turn = 0;; ++turn) {  // outwards, until the curve first leaves the range
        const double kx = turn % 2 == 0 ? pi * turn + phase : pi * (turn + 1) - phase, x = sense * kx / k;
        if (std::abs(x - a * std::sin(k * x)) > 1.0) break;
        ++wanted;
      }
    CAPTURE(a, k, wanted);
    CHECK(sound(all));
    CHECK(of_type(all, EventType::fold).size() == wanted);
  }
}

TEST_CASE("unknowns of very different size, and parameters in millions and millionths") {
  // y = 1e-14 x; p = -9e-5 x + 1e-12 x^3 has its folds where 9e-5 = 3e-12 x^2
  const auto all =
      branches({{"x", "y"}, {"p + 1e4*(x*1e-8) - (x*1e-8)^3*1e12 - y*1e9", "x*1e-8 - y*1e6"}, {{"p", 0.0}}}, "p", -1.0, 1.1, {{0.0, 0.0, 0.0}});
  CHECK(sound(all));
  REQUIRE(all.size() == 1);
  CHECK(all[0].points() < 200);
  const double x = std::sqrt(3e7), p = 9e-5 * x - 1e-12 * x * x * x;
  check_values(values(all, EventType::fold), {-p, p});
  for (const double size : {1e6, 1e-6}) {
    const System pitchfork{{"x"}, {"p/s*x - x^3"}, {{"p", -size}, {"s", size}}};
    const auto both = branches(pitchfork, "p", -size, 3.0 * size, {{0.0, -size}});
    CHECK(sound(both));
    CHECK(both.size() == 2);
    REQUIRE(values({both[0]}, EventType::branch_point).size() == 1);
    CHECK(std::abs(values({both[0]}, EventType::branch_point)[0]) < located * size);
  }
}

TEST_CASE("all branches of the square's symmetry leave a double zero") {
  // x = 0 or y = 0 or x = +-y: eight half-branches, x^2 = p on the axes and (1 + a) x^2 = p on the diagonals
  for (const std::vector<std::vector<std::string>>& mirrors : {std::vector<std::vector<std::string>>{}, {{"x"}, {"y"}}}) {
    const auto all = branches(square_symmetry(mirrors), "p", -1.0, 1.0, {{0.0, 0.0, -1.0}});
    CAPTURE(mirrors.size());
    CHECK(sound(all));
    for (const double at : values({all[0]}, EventType::branch_point)) CHECK(std::abs(at) < located);
    std::size_t axes = 0, diagonals = 0;
    for (const auto& b : all) {
      const Vector end = b.u(b.points() - 1);
      if (end.head(2).norm() < 0.1) continue;
      const double least = std::min(std::abs(end[0]), std::abs(end[1])), most = std::max(std::abs(end[0]), std::abs(end[1]));
      axes += least < 1e-12 && std::abs(most - 1.0) < 1e-9 ? 1 : 0;
      diagonals += std::abs(least - most) < 1e-9 && std::abs(most - std::sqrt(1.0 / 1.5)) < 1e-9 ? 1 : 0;
    }
    CHECK(axes == (mirrors.empty() ? 4u : 2u));  // of mirror images one each
    CHECK(diagonals == (mirrors.empty() ? 4u : 1u));
    CHECK(all.size() == 1 + axes + diagonals);
  }
}

TEST_CASE("user values met twice within a step that turns, and what is not followed") {
  const EquilibriumFlow cusp = System{{"x"}, {"mu + x - x^3"}, {{"mu", -1.0}}}.flow({"mu"});
  WalkOptions o;
  o.lower = -1.0;
  o.upper = 1.0;
  o.user_values = {0.3849, 0.3};  // the fold is at 0.38490018
  const std::vector<Branch> all{Walker(cusp, o).walk(Eigen::Vector2d(-1.3, -1.0))};
  check_values(values(all, EventType::user_value), {0.3, 0.3, 0.3, 0.3849, 0.3849, 0.3849});
  for (const auto& s : of_type(all, EventType::user_value)) CHECK(std::abs(s.u[1] + s.u[0] - std::pow(s.u[0], 3)) < 1e-11);

  const EquilibriumFlow cascade = System{{"x", "y"}, {"p*x - x^3", "(x^2 - 1/5)*y - y^3"}, {{"p", -1.0}}, {{"x"}, {"y"}}}.flow({"p"});
  NetworkOptions shallow;
  shallow.walk.lower = -1.0;
  shallow.depth = 1;
  Network net(cascade, shallow);
  (void)net.add_seed(Eigen::Vector3d(0.0, 0.0, -1.0), "start");
  net.switch_branches();
  REQUIRE(net.branches().size() == 2);
  REQUIRE(net.not_followed().size() == 1);
  CHECK(net.not_followed()[0] == "B2:BP1");
}

TEST_CASE("folds and Hopf points that cancel in pairs beside other events") {
  struct Case {
    std::vector<double> folds, hopfs;  // of s: p = g(s) with g' zero at the folds, the pair's real part zero at the hopfs
  };
  const std::vector<Case> cases = {{{0.1006365, 0.11481776}, {0.15141032}},
                                   {{-0.47927156, -0.47132054, -0.42334402}, {-0.14107171}},
                                   {{-0.17090705, -0.06622396, -0.02556636, 0.00417741}, {}},
                                   {{-0.2198509, 0.25052297}, {-0.20888716, -0.19966873}},
                                   {{-0.83590999, -0.83590715, 0.24462673}, {-0.81582207, -0.81317803, 0.26350438}}};
  for (const auto& c : cases) {
    const auto product = [](const std::vector<double>& roots) {
      std::string text = "1";
      for (const double root : roots) text += "*(s - (" + std::to_string(root) + "))";
      return text;
    };
    std::vector<double> g = {1.0};  // coefficients of g'
    for (const double root : c.folds) {
      const double exact = std::stod(std::to_string(root));
      std::vector<double> next(g.size() + 1, 0.0);
      for (std::size_t k = 0; k < g.size(); ++k) {
        next[k] -= exact * g[k];
        next[k + 1] += g[k];
      }
      g = next;
    }
    System s{{"s", "x", "y"}, {"p", product(c.hopfs) + "*x - y - x*(x^2+y^2)", "x + (" + product(c.hopfs) + ")*y - y*(x^2+y^2)"}, {{"p", 0.0}}};
    double low = 0.0, high = 0.0;
    const auto value = [&g](double at) {
      double sum = 0.0;
      for (std::size_t k = 0; k < g.size(); ++k) sum += g[k] / (static_cast<double>(k) + 1.0) * std::pow(at, static_cast<double>(k) + 1.0);
      return sum;
    };
    for (std::size_t k = 0; k < g.size(); ++k) {
      const std::string name = "g" + std::to_string(k);
      s.parameters[name] = g[k] / (static_cast<double>(k) + 1.0);
      s.rhs[0] += " - " + name + "*s^" + std::to_string(k + 1);
    }
    for (double at = -1.2; at <= 1.2; at += 0.01) {
      low = std::min(low, value(at));
      high = std::max(high, value(at));
    }
    const double margin = 0.01 * (high - low);  // the folds lie between the values looked at
    const auto all = branches(s, "p", low - margin, high + margin, {{-1.2, 0.0, 0.0, value(-1.2)}});
    CAPTURE(c.folds, c.hopfs);
    CHECK(of_type(all, EventType::unresolved).empty());
    CHECK(of_type(all, EventType::fold).size() == c.folds.size());
    CHECK(of_type(all, EventType::hopf).size() == c.hopfs.size());
  }
}

TEST_CASE("motion without damping is neutral all along and has no events") {
  const System prey{{"x", "y"}, {"a*x - b*x*y", "-c*y + d*x*y"}, {{"a", 1.0}, {"b", 0.1}, {"c", 1.5}, {"d", 0.075}}};
  for (const std::string lens : {"a", "d"}) {  // eigenvalues +-i sqrt(a c) at (c/d, a/b)
    const double lower = lens == "a" ? 0.3 : 0.02, upper = lens == "a" ? 2.0 : 0.3, start = lens == "a" ? 1.0 : 0.075;
    const auto all = branches(prey, lens, lower, upper, {{20.0, 10.0, start}});
    REQUIRE(all.size() == 1);
    CHECK(sound(all));
    CHECK(all[0].special.empty());
    for (int i = 0; i < all[0].points(); ++i) CHECK(all[0].n_unstable(i) == 0);
    CHECK(std::abs(all[0].eigenvalues(all[0].points() - 1)[0].imag()) > 0.5);
  }
}

TEST_CASE("slow eigenvalues beside one that is ten decades faster") {
  for (const double fast : {1e6, 1e8, 1e9, 1e10, 1e11, 1e12}) {
    const System s{{"x", "y", "z"}, {"mu*x-2*y-x*(x^2+y^2)", "2*x+mu*y-y*(x^2+y^2)", "-fast*(z-x^2)"}, {{"mu", -1.0}, {"fast", fast}}};
    const auto all = branches(s, "mu", -1.0, 1.0, {{0.0, 0.0, 0.0, -1.0}});
    CAPTURE(fast);
    CHECK(sound(all));
    CHECK(of_type(all, EventType::branch_point).empty());
    check_values(values(all, EventType::hopf), {0.0});
  }
}

TEST_CASE("a branch that goes to infinity at a finite parameter ends there") {
  // x = h m/(c - m) beside the pole at m = c, and x = -1/p
  const System pole{{"x"}, {"1 + p*x"}, {{"p", -1.0}}};
  const System prey{{"x", "y"}, {"x*(1-x)*(x-a) - x*y/(h+x)", "y*(c*x/(h+x) - m)"}, {{"a", 0.1}, {"m", 0.5}, {"h", 0.2}, {"c", 1.0}}};
  const auto simple = branches(pole, "p", -1.0, 1.0, {{1.0, -1.0}});
  CHECK(sound(simple));
  REQUIRE(simple.size() == 1);
  CHECK(simple[0].stop_reason == StopReason::unbounded);
  CHECK(simple[0].special.empty());
  const auto all = branches(prey, "m", 0.1, 1.0, {{1.0, 0.0, 0.5}});
  CHECK(sound(all));
  CHECK(std::any_of(all.begin(), all.end(),
                    [](const Branch& b) { return b.stop_reason == StopReason::unbounded || b.start_reason == StopReason::unbounded; }));
}

TEST_CASE("Bratu's problem down to the parameter at which its upper branch is infinite") {
  System s{{}, {}, {{"lam", 0.5}}};
  const int n = 30;
  std::vector<double> start(n + 1, 0.0);
  start[n] = 0.5;
  const auto x = [](int i) { return i < 0 || i >= n ? std::string("0") : "x" + std::to_string(i); };
  for (int i = 0; i < n; ++i) {
    s.variables.push_back(x(i));
    s.rhs.push_back("961*(" + x(i + 1) + "-2*" + x(i) + "+" + x(i - 1) + ") + lam*exp(" + x(i) + ")");
  }
  const auto all = branches(s, "lam", 0.0, 4.0, {start});
  CHECK(sound(all));
  check_values(values(all, EventType::fold), {3.51192782459});
}

TEST_CASE("a start far off that Newton brings to a known branch gives no second one") {
  const System s{{"x"}, {"p - x + x^3"}, {{"p", 0.0}}};
  const auto all = branches(s, "p", -1.0, 1.0, {{0.0, 0.0}, {1.0, 0.0}, {50.0, 0.0}, {-7.0, 0.3}});
  CHECK(all.size() == 1);
  check_values(values(all, EventType::fold), {-2.0 / (3.0 * std::sqrt(3.0)), 2.0 / (3.0 * std::sqrt(3.0))});
}
