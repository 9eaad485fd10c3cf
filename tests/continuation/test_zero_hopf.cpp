/// Zero-Hopf points: told on every curve through them, each leading to the others; without a coefficient on a branch. Each is checked by its
/// eigenvalues.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/continuation/chart_of.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::continuation::text_model;

namespace {

bool has_curve(const std::vector<DefiningCurve>& curves, EventType type, const std::function<double(const Vector&)>& relation) {
  return std::any_of(curves.begin(), curves.end(), [&](const DefiningCurve& c) {
    if (c.type != type || c.u.cols() < 5) return false;
    for (Eigen::Index i = 0; i < c.u.cols(); ++i)
      if (!(std::abs(relation(c.u.col(i))) < 1e-8)) return false;
    return true;
  });
}

// A zero eigenvalue and a pair on the axis.
void check_zero_hopf(const EquilibriumFlow& f2, const std::vector<CodimensionTwo>& points) {
  for (const auto& z : points) {
    auto e = eigenvalues(f2, z.u);
    std::sort(e.begin(), e.end(), [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); });
    CHECK(std::abs(e[0]) + std::abs(e[1].real()) + std::abs(e[2].real()) < 1e-7);
    CHECK(std::abs(e[1].imag()) + std::abs(e[2].imag()) > 1e-3);
  }
}

// x, y with the pair (y, z), or (x, y) with (s, t): a parameter each for the zero and for the pair
struct Form {
  const char* x;       // equation of the first variable
  const char* growth;  // of the pair
  EventType through;   // what crosses the Hopf curve
  const char* name;
};

}  // namespace

TEST_CASE("a zero-Hopf point is told on the Hopf curve of three variables and starts the other curve", "[slow]") {
  const Form forms[] = {{"a - b - x^2", "(b + x)", EventType::fold, "fold"},
                        {"a - b - x^2 + 0.3*(y^2 + z^2)", "(b - x)", EventType::fold, "fold, other unfolding"},
                        {"a*x - x^3", "(b + 0.3*a)", EventType::branch_point, "pitchfork"},
                        {"a*x + x^3 - 0.2*x*(y^2+z^2)", "(b + 0.3*a + x^2)", EventType::branch_point, "subcritical pitchfork"},
                        {"a*x - x^2", "(b + 0.3*a)", EventType::branch_point, "transcritical"},
                        {"a*x + x^2 - 0.1*(y^2+z^2)", "(b + 0.3*a + 0.5*x)", EventType::branch_point, "transcritical, coupled"}};
  for (const Form& form : forms)
    for (const double second : {-0.5, 0.45}) {  // on either side of the point
      const std::string g = form.growth;
      const bool fold = form.through == EventType::fold;
      const System s{{"x", "y", "z"}, {form.x, g + "*y - z - y*(y^2+z^2)", "y + " + g + "*z - z*(y^2+z^2)"}, {{"a", 1.0}, {"b", second}}};
      const double side = g == "(b - x)" && second < 0.0 ? -1.0 : 1.0;  // of the fold on which the pair crosses
      const auto curves = fold ? chart(s, {"a", "b"}, ranges(-0.4, 1.1, -0.7, 0.6), {side * std::sqrt(1.0 - second), 0.0, 0.0, 1.0})
                               : chart(s, {"a", "b"}, ranges(-1.0, 1.0, -0.7, 0.6), {0.0, 0.0, 0.0, -1.0});
      CAPTURE(form.name, second);
      const auto points = of_type(curves, "ZH");
      check_zero_hopf(s.flow({"a", "b"}), points);
      bool on_hopf = false, on_other = false;
      for (const auto& c : curves)
        for (const auto& z : c.special) {
          if (z.type != "ZH" || !(std::abs(z.u[3]) + std::abs(z.u[4]) < 1e-9)) continue;
          on_hopf = on_hopf || c.type == EventType::hopf;
          on_other = on_other || c.type == form.through;
        }
      CHECK(on_hopf);
      CHECK(on_other);
      CHECK(has_curve(curves, form.through, [&](const Vector& u) { return fold ? u[3] - u[4] : u[3]; }));
      if (!fold) CHECK(has_curve(curves, EventType::hopf, [](const Vector& u) { return std::abs(u[0]) + std::abs(u[4] + 0.3 * u[3]); }));
      CHECK(of_type(curves, "CP").empty());
    }
}

TEST_CASE("a pitchfork curve along which the second parameter stands still is followed from a zero-Hopf point") {
  for (const double start : {-0.5, 0.3, -0.9}) {
    const System s{{"x", "y", "s", "t"},
                   {"b*x - y - x^3 + 2*x", "0.5*x - 0.5*y", "a*s - t - s*(s^2+t^2)", "s + a*t - t*(s^2+t^2)"},
                   {{"a", -0.5}, {"b", start}}};
    const auto curves = chart(s, {"a", "b"}, ranges(-1.0, 1.0, -2.0, 1.0), {0.0, 0.0, 0.0, 0.0, -0.5});
    CAPTURE(start);
    CHECK(has_curve(curves, EventType::branch_point, [](const Vector& u) { return u[5] + 1.0; }));
    bool zero = false, pairs = false;
    for (const auto& c : curves)
      for (const auto& z : c.special) {
        if (c.type == EventType::hopf && z.type == "ZH" && std::abs(z.u[4]) + std::abs(z.u[5] + 1.0) < 1e-9) zero = true;
        if (z.type == "HH" && std::abs(z.u[4]) + std::abs(z.u[5] + 1.5) < 1e-9) pairs = true;
        if (c.type != EventType::branch_point) continue;  // b stands still along the pitchforks: no extremum, or one at each point
        CHECK(z.type != "MIN");
        CHECK(z.type != "MAX");
      }
    CHECK(zero);
    CHECK(pairs);
  }
}

TEST_CASE("zero-Hopf points of public models in three variables", "[published]") {
  const System lorenz_84{
      {"x", "y", "z"}, {"-y^2 - z^2 - a*x + a*F", "x*y - b*x*z - y + G", "b*x*y + x*z - z"}, {{"a", 0.25}, {"b", 4.0}, {"F", 0.0}, {"G", 1.0}}};
  const auto curves = chart(lorenz_84, {"F", "G"}, ranges(0.0, 4.0, 0.2, 3.0), {0.132858, 0.83834, 0.513781, 4.0});
  const auto points = of_type(curves, "ZH");
  REQUIRE(points.size() >= 2);  // on the fold curve and on the Hopf curve
  check_zero_hopf(lorenz_84.flow({"F", "G"}), points);
  for (const auto& z : points) CHECK(std::hypot(z.u[3] - 1.684051724, z.u[4] - 1.682968553) < 2e-9);
  for (const auto& z : of_type(curves, "GH")) CHECK(std::hypot(z.u[3] - 1.684, z.u[4] - 1.683) > 1e-3);  // the pole of l1 is no zero
  // Roessler: x = -a y, z = -y, fold c^2 = 4 a b with the pair on the axis where c = 2 a
  const System rossler{{"x", "y", "z"}, {"-y - z", "x + a*y", "b + z*(x - c)"}, {{"a", 0.3}, {"b", 0.2}, {"c", 4.0}}};
  const auto rossler_points = of_type(chart(rossler, {"c", "a"}, ranges(0.05, 6.0, 0.05, 1.2), {0.015, -0.05, 0.05, 4.0}), "ZH");
  REQUIRE(rossler_points.size() >= 2);
  check_zero_hopf(rossler.flow({"c", "a"}), rossler_points);
  for (const auto& z : rossler_points) CHECK(std::hypot(z.u[3] - 0.4, z.u[4] - 0.2) < 1e-8);
}

TEST_CASE("a Hopf point that is a fold as well is named and has no coefficient") {
  const System rossler{{"x", "y", "z"}, {"-y - z", "x + b*y", "b + z*(x - a)"}, {{"b", 0.2}, {"a", 4.0}}};
  const auto all = branches(rossler, "a", 0.1, 6.0, {{0.01, -0.05, 0.05, 4.0}});
  for (const auto& hopf : text_model::of_type(all, EventType::hopf)) {
    if (std::abs(hopf.u[3] - 0.4) > 1e-8) continue;
    CHECK(hopf.subtype == "ZH");
    CHECK_FALSE(hopf.has_coefficient);
  }
}
