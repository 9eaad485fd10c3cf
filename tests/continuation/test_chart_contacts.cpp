/// Where curves of a chart touch, begin and end: contacts of folds with branch points, Bogdanov-Takens points as starts, curves of one value.

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "continuation/held_problem.hpp"
#include "core/newton.hpp"
#include "tests/continuation/chart_of.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::continuation::text_model;

TEST_CASE("a fold curve that touches transcritical points has no cusp there") {
  // x (p - q x - x^2): folds p = -q^2/4 at x = -q/2 touch p = 0. The second has an x-dependent factor and a slaved variable.
  const struct {
    System system;
    std::vector<double> start;
  } cases[] = {{{{"x"}, {"x*(p - q*x - x^2)"}, {{"p", -1.0}, {"q", 0.5}}}, {0.0, -1.0}},
               {{{"x", "y"}, {"x*(p - q*x - x^2)*(1 + 0.3*x) + x^2*y", "-y + 0.1*p"}, {{"p", -1.0}, {"q", 0.5}}}, {0.0, -0.1, -1.0}}};
  for (const auto& c : cases) {
    const auto curves = chart(c.system, {"p", "q"}, ranges(-1.0, 1.0, -1.0, 1.0), c.start);
    const int n = static_cast<int>(c.system.variables.size());
    CAPTURE(n);
    CHECK(of_type(curves, "CP").empty());
    CHECK(of_type(curves, "BT").empty());
    bool on_folds = false, on_branch_points = false;
    for (const auto& curve : curves)
      for (const auto& z : curve.special) {
        if (z.type != "FT") continue;
        CHECK(z.u.norm() < 1e-8);
        CHECK(z.subtype == (curve.type == EventType::fold ? "TC" : "LP"));
        (curve.type == EventType::fold ? on_folds : on_branch_points) = true;
      }
    CHECK(on_folds);
    CHECK(on_branch_points);
  }
}

TEST_CASE("a degenerate pitchfork in units of one and of a hundredth: no cusp beside it") {
  for (const double size : {1.0, 0.1, 0.01}) {  // x (p + q x^2/s^2 - x^4/s^4): folds p = -q^2/4, q > 0
    const System s{{"x"}, {"x*(p + q*x^2/s^2 - x^4/s^4)"}, {{"p", -1.0}, {"q", 0.5}, {"s", size}}};
    const auto curves = chart(s, {"p", "q"}, ranges(-1.0, 1.0, -1.0, 1.0), {0.0, -1.0});
    CAPTURE(size);
    CHECK(of_type(curves, "CP").empty());
    const auto degenerate = of_type(curves, "DP");
    REQUIRE(degenerate.size() >= 1);
    for (const auto& z : degenerate) CHECK(z.u.norm() < 1e-8);
    bool folds = false;
    for (const auto& c : curves) {
      if (c.type != EventType::fold) continue;
      folds = true;
      for (Eigen::Index i = 0; i < c.u.cols(); ++i) CHECK(std::abs(c.u(1, i) + 0.25 * c.u(2, i) * c.u(2, i)) < 1e-8);
    }
    CHECK(folds);
  }
}

TEST_CASE("a chart that starts on a Bogdanov-Takens point tells it, and the Hopf curve that begins there") {
  // x' = y, y' = m + n y + x^2 + x y: folds m = 0, Hopf points x = -n, m = -n^2, the point at the origin
  for (const double start : {0.0, 0.4, -0.3}) {
    const System s{{"x", "y"}, {"y", "m + n*y + x^2 + x*y"}, {{"m", -1.0}, {"n", start}}};
    const auto curves = chart(s, {"m", "n"}, ranges(-1.0, 0.5, -1.0, 1.0), {-1.0, 0.0, -1.0});
    CAPTURE(start);
    bool on_folds = false, on_hopf = false;
    for (const auto& c : curves)
      for (const auto& z : c.special) {
        if (z.type != "BT") continue;
        CHECK(z.u.norm() < 1e-8);
        on_folds = on_folds || c.type == EventType::fold;
        on_hopf = on_hopf || c.type == EventType::hopf;
      }
    CHECK(on_folds);
    CHECK(on_hopf);
    for (const auto& c : curves)
      for (Eigen::Index i = 0; i < c.u.cols(); ++i) CHECK(std::abs(c.type == EventType::fold ? c.u(2, i) : c.u(2, i) + c.u(3, i) * c.u(3, i)) < 1e-9);
  }
}

TEST_CASE("a generalised Hopf point however near to a Bogdanov-Takens point") {
  // x' = y, y' = m + n y + x^2 + e x y - y^3: Hopf points n = -e x, m = -x^2, x < 0, w^2 = -2 x. In x = u, y = -w v the planar formula of l1 leaves
  // w^2 f_yyy + f_xy f_xx / w^2 = 12 x - e / x: zero at x = -sqrt(e / 12), next to the point at the origin where e is small.
  for (const double e : {0.3, 0.03, 3e-3, 3e-4}) {
    const System s{{"x", "y"}, {"y", "m + n*y + x^2 + e*x*y - y^3"}, {{"m", -0.5}, {"n", 0.3}, {"e", e}}};
    const auto curves = chart(s, {"m", "n"}, ranges(-0.6, 0.3, -1.0, 1.0), {-std::sqrt(0.5), 0.0, -0.5});
    CAPTURE(e);
    const auto points = of_type(curves, "GH");
    REQUIRE(points.size() == 1);
    CHECK(points[0].u[0] == Approx(-std::sqrt(e / 12.0)).epsilon(1e-6));
    CHECK(points[0].u[3] == Approx(e * std::sqrt(e / 12.0)).epsilon(1e-6));
  }
}

TEST_CASE("values of the second parameter asked for are listed on every curve that takes them") {
  const System s{{"x"}, {"m + p*x - x^3"}, {{"m", -0.5}, {"p", 0.5}}};
  TwoParameterOptions o = ranges(-1.0, 1.0, -0.5, 1.0);
  o.walk.user_values = {0.25, 0.75};
  const auto points = of_type(chart(s, {"m", "p"}, o, {-1.0, -1.0}), "UZ");
  REQUIRE(points.size() == 4);  // 27 m^2 = 4 p^3, both signs of m
  for (const auto& z : points) {
    CHECK((z.u[2] == 0.25 || z.u[2] == 0.75));
    CHECK(27.0 * z.u[1] * z.u[1] == Approx(4.0 * std::pow(z.u[2], 3)).epsilon(1e-9));
  }
}

TEST_CASE("a chart of a pair that leaves the branches' parameter, which is held") {
  // x' = p + m + q x - x^3 at p = p0 of a fold found at m = 0: 27 (p0 + m)^2 = 4 q^3
  const System s{{"x"}, {"p + m + q*x - x^3"}, {{"p", -1.0}, {"m", 0.0}, {"q", 0.75}}};
  const auto folds = text_model::of_type(branches(s, "p", -1.0, 1.0, {{-1.2, -1.0}}), EventType::fold);
  REQUIRE(folds.size() == 2);
  const EquilibriumFlow three = s.flow({"m", "q", "p"});
  const double p0 = folds[0].u[1];
  const HeldProblem f2(three, p0);
  SpecialPoint point = folds[0];
  point.u[1] = 0.0;  // m
  const DefiningCurve curve = follow(f2, point, 0.75, ranges(-1.0, 1.0, -0.5, 1.0));
  REQUIRE(curve.u.cols() > 20);
  for (Eigen::Index i = 0; i < curve.u.cols(); ++i) CHECK(std::abs(27.0 * std::pow(p0 + curve.u(1, i), 2) - 4.0 * std::pow(curve.u(2, i), 3)) < 1e-9);
}

TEST_CASE("a linear system has its curves, and a walk that leads nowhere none without a point") {
  // Routh-Hurwitz: branch points q = -p, Hopf points a2 a1 = a0
  const System s{{"x", "y", "z"}, {"(-(q+p)*x + q*y)/0.6", "q*x - (q-0.6)*y - z", "y"}, {{"p", -0.9}, {"q", 0.5}}};
  const auto curves = chart(s, {"p", "q"}, ranges(-1.5, 0.4, 0.2, 1.2), {0.0, 0.0, 0.0, -0.9});
  int branch_points = 0, hopf = 0;
  for (const auto& c : curves) {
    REQUIRE(c.u.cols() > 0);
    for (Eigen::Index i = 0; i < c.u.cols(); ++i) {
      const double p = c.u(3, i), q = c.u(4, i), a0 = (q + p) / 0.6, a1 = 1.0 + (q + p) * (q - 0.6) / 0.6 - q * q / 0.6, a2 = a0 + q - 0.6;
      CHECK(std::abs(c.type == EventType::branch_point ? p + q : a2 * a1 - a0) < 1e-8);
    }
    (c.type == EventType::branch_point ? branch_points : hopf) += 1;
  }
  CHECK(branch_points == 1);
  CHECK(hopf >= 1);
}

// Generalised Hopf points of a chart at default steps and at steps an eighth as long, beside Bogdanov-Takens points too: random networks
// x_i' = -x_i + sum_j w_ij tanh(g x_j) + h_i in gain and bias.
TEST_CASE("no generalised Hopf point is missed on random networks", "[slow]") {
  int points = 0, charts = 0;
  for (unsigned seed = 0; seed < 24; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const int n = 2 + static_cast<int>(seed % 3);
    System s;
    s.parameters = {{"g", 1.5}, {"h", 0.1}};
    for (int i = 0; i < n; ++i) s.variables.push_back("x" + std::to_string(i));
    for (int i = 0; i < n; ++i) {
      std::string rhs = "-x" + std::to_string(i) + (i == 0 ? " + h" : " + (" + std::to_string(0.5 * normal(random)) + ")");
      for (int j = 0; j < n; ++j) rhs += " + (" + std::to_string(2.0 * normal(random)) + ")*tanh(g*x" + std::to_string(j) + ")";
      s.rhs.push_back(rhs);
    }
    const EquilibriumFlow f = s.flow({"h"});
    Vector start = Vector::Zero(n + 1);
    start[n] = 0.1;
    const NewtonResult at = newton(f, start);
    if (!at.ok()) continue;
    TwoParameterOptions o = ranges(-3.0, 3.0, 0.2, 3.0);
    const std::vector<double> from(at.x.begin(), at.x.end());
    const auto found = of_type(chart(s, {"h", "g"}, o, from), "GH");
    o.walk.max_step /= 8.0;
    o.walk.initial_step /= 8.0;
    const auto reference = of_type(chart(s, {"h", "g"}, o, from), "GH");
    CAPTURE(seed, n);
    for (const auto& z : reference)
      CHECK(std::any_of(found.begin(), found.end(), [&](const CodimensionTwo& k) { return (k.u - z.u).norm() < 1e-6 * (1.0 + z.u.norm()); }));
    points += static_cast<int>(reference.size());
    ++charts;
  }
  CHECK(charts > 15);
  CHECK(points > 2);
}
