/// Charts do not depend on the units of x, of either parameter or of t: the same curves with the same points of codimension two.

#include <catch2/catch.hpp>
#include <cmath>
#include <tuple>

#include "tests/continuation/chart_of.hpp"
#include "tests/continuation/rescaled.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::continuation::text_model;

namespace {

struct Study {
  System system;
  std::vector<std::string> lens;
  TwoParameterOptions ranges;
  std::vector<double> start;
  const char* name;
};

std::vector<Study> studies() {
  const System bogdanov_takens{{"x", "y"}, {"y", "m + n*y + x^2 + x*y"}, {{"m", -1.0}, {"n", 0.4}}};
  const System generalised{{"x", "y"}, {"y", "m + n*y + x^2 + 0.3*x*y - y^3"}, {{"m", -0.5}, {"n", 0.3}}};
  const System cusp{{"x"}, {"m + p*x - x^3"}, {{"m", -0.5}, {"p", 0.5}}};
  System degenerate{{"x"}, {"x*(p + q*x^2 - x^4)"}, {{"p", -1.0}, {"q", 0.5}}};
  degenerate.mirrors = {{"x"}};
  const System touching{{"x"}, {"x*(p - q*x - x^2)"}, {{"p", -1.0}, {"q", 0.5}}};
  const System zero_hopf{{"x", "y", "z"}, {"a - b - x^2", "(b+x)*y - z - y*(y^2+z^2)", "y + (b+x)*z - z*(y^2+z^2)"}, {{"a", 1.0}, {"b", -0.5}}};
  return {{bogdanov_takens, {"m", "n"}, ranges(-1.0, 0.5, -1.0, 1.0), {-1.0, 0.0, -1.0}, "Bogdanov-Takens"},
          {generalised, {"m", "n"}, ranges(-0.6, 0.3, -1.0, 1.0), {-std::sqrt(0.5), 0.0, -0.5}, "generalised Hopf"},
          {cusp, {"m", "p"}, ranges(-1.0, 1.0, -0.5, 1.0), {-1.0, -1.0}, "cusp"},
          {degenerate, {"p", "q"}, ranges(-1.0, 1.0, -1.0, 1.0), {0.0, -1.0}, "degenerate pitchfork"},
          {touching, {"p", "q"}, ranges(-1.0, 1.0, -1.0, 1.0), {0.0, -1.0}, "fold curve touching transcritical points"},
          {zero_hopf, {"a", "b"}, ranges(-0.4, 1.1, -0.7, 0.6), {std::sqrt(1.5), 0.0, 0.0, 1.0}, "zero-Hopf"}};
}

struct Units {
  double a, b1, b2, c;
};

using Point = std::tuple<std::string, double, double>;  // curve and type, parameters in the units of the study

// Curves (their number by kind) and points of codimension two.
std::vector<Point> chart_in(const Study& s, const Units& units) {
  const EquilibriumFlow f1 = s.system.flow({s.lens[0]}), f2 = s.system.flow(s.lens);
  const int n = f1.size();
  const Vector a = Vector::Constant(n, units.a), b = Eigen::Vector2d(units.b1, units.b2);
  const Rescaled one(f1, a, units.b1, units.c), two(f2, a, b, units.c);
  NetworkOptions walks;
  walks.walk.lower = units.b1 * s.ranges.range1[0];
  walks.walk.upper = units.b1 * s.ranges.range1[1];
  Network net(one, walks);
  Vector u = Eigen::Map<const Vector>(s.start.data(), n + 1);
  u.head(n) *= units.a;
  u[n] *= units.b1;
  (void)net.add_seed(u, "start");
  net.switch_branches();
  TwoParameterOptions o = s.ranges;
  for (double& end : o.range1) end *= units.b1;
  for (double& end : o.range2) end *= units.b2;
  Chart all(two, o);
  for (const auto& branch : net.branches())
    for (const auto& point : branch.special) all.follow_from(point, units.b2 * s.system.parameters.at(s.lens[1]), "start");
  all.follow_meetings();
  std::vector<Point> found;
  for (const auto& c : all.curves()) {
    found.emplace_back(to_string(c.type), 0.0, 0.0);
    for (const auto& z : c.special)
      if (z.type != "MIN" && z.type != "MAX") found.emplace_back(to_string(c.type) + (":" + z.type), z.u[n] / units.b1, z.u[n + 1] / units.b2);
  }
  std::sort(found.begin(), found.end(), [](const Point& p, const Point& q) {
    return std::get<0>(p) != std::get<0>(q) ? std::get<0>(p) < std::get<0>(q) : std::get<2>(p) < std::get<2>(q);
  });
  return found;
}

}  // namespace

TEST_CASE("the same chart in any units of x, of both parameters and of t") {
  constexpr double located = 1e-7;  // of the ranges: a point where curves touch is located to the root of the rounding
  for (const Study& s : studies()) {
    CAPTURE(s.name);
    const auto wanted = chart_in(s, {1.0, 1.0, 1.0, 1.0});
    REQUIRE(wanted.size() >= 2);
    for (const Units& unit : {Units{1e-12, 1.0, 1.0, 1.0}, Units{2e-7, 1.0, 1.0, 1.0}, Units{3e-3, 1.0, 1.0, 1.0}, Units{7e2, 1.0, 1.0, 1.0},
                              Units{1e6, 1.0, 1.0, 1.0}, Units{1e12, 1.0, 1.0, 1.0}, Units{1.0, 1e-12, 1.0, 1.0}, Units{1.0, 1e12, 1.0, 1.0},
                              Units{1.0, 1.0, 1e-12, 1.0}, Units{1.0, 1.0, 1e12, 1.0}, Units{1.0, 1.0, 1.0, 1e-12}, Units{1.0, 1.0, 1.0, 1e12},
                              Units{3e-8, 2e5, 7e-3, 1e4}, Units{5e6, 3e-9, 2e7, 4e-6}}) {
      CAPTURE(unit.a, unit.b1, unit.b2, unit.c);
      const auto found = chart_in(s, unit);
      CHECK(found.size() == wanted.size());
      for (std::size_t i = 0; i < std::min(found.size(), wanted.size()); ++i) {
        CHECK(std::get<0>(found[i]) == std::get<0>(wanted[i]));
        CHECK(std::abs(std::get<1>(found[i]) - std::get<1>(wanted[i])) < located);
        CHECK(std::abs(std::get<2>(found[i]) - std::get<2>(wanted[i])) < located);
      }
    }
  }
}
