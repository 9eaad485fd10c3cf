/// No branch is dropped and none is told twice: branches on which others end, seeds next to an end of the range, symmetric systems.

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "continuation/multiple_point.hpp"
#include "core/newton.hpp"
#include "tests/continuation/text_model.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::continuation::text_model;

namespace {

// s = 0 for all p, and the circle (s - m)^2 + p^2 = 1, are symmetric (x = 0) and lie apart. x^2 = g = p - q + t s leaves the first where g = 0 and
// ends on the circle, which nothing else leads to: c g = s ((s - m)^2 + p^2 - 1) on it.
System circle_apart(double m, double q, double t, double c) {
  return {{"s", "x"}, {"s*((s-m)^2 + p^2 - 1) - c*x^2", "x*(p - q + t*s) - x^3"}, {{"p", 0.0}, {"m", m}, {"q", q}, {"t", t}, {"c", c}}, {{"x"}}};
}

bool on_circle(const Branch& b, double m) {
  const Vector u = b.u(b.points() / 2);
  return u[1] == 0.0 && std::abs((u[0] - m) * (u[0] - m) + u[2] * u[2] - 1.0) < 1e-9;
}

// Values of p at which the line p = q - t s meets the circle.
std::vector<double> crossings(double m, double q, double t) {
  const double a = 1.0 + t * t, b = -m - q * t, c = m * m + q * q - 1.0, root = std::sqrt(b * b - a * c);
  return {q - t * (-b - root) / a, q - t * (-b + root) / a};
}

// On the branch between them, at this s: c (p - q + t s) = s ((s - m)^2 + p^2 - 1).
double halfway(double m, double q, double t, double c, double s) {
  const double constant = s * ((s - m) * (s - m) - 1.0) + c * q - c * t * s;
  return (c - std::sqrt(c * c - 4.0 * s * constant)) / (2.0 * s);
}

System cells(int n, double c) {  // all alike, each coupled with all
  System s;
  std::string sum;
  for (int i = 1; i <= n; ++i) sum += (i > 1 ? "+x" : "x") + std::to_string(i);
  for (int i = 1; i <= n; ++i) {
    const std::string x = "x" + std::to_string(i);
    s.variables.push_back(x);
    s.rhs.push_back("a*" + x + " - " + x + "^3 - c*(" + sum + ")");
  }
  s.parameters = {{"a", -1.0}, {"c", c}};
  return s;
}

// Different solutions at p over all branches.
std::vector<Vector> states(const Network& net, double p) {
  std::vector<Vector> found;
  for (const auto& [branch, u] : net.solutions_at(p))
    if (std::none_of(found.begin(), found.end(), [&u = u](const Vector& v) { return (v - u).norm() < 1e-7; })) found.push_back(u);
  return found;
}

}  // namespace

TEST_CASE("a branch that ends on an unknown symmetric one leads on to it") {
  std::mt19937 random(3);
  const auto between = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  for (int k = 0; k < 12; ++k) {
    const double m = between(1.7, 2.5), q = between(-0.3, 0.3), t = between(-0.15, 0.15), c = between(3.0, 9.0);
    CAPTURE(m, q, t, c);
    const auto all = branches(circle_apart(m, q, t, c), "p", -2.0, 2.0, {{0.0, 0.0, -2.0}});
    CHECK(sound(all));
    CHECK(std::count_if(all.begin(), all.end(), [&](const Branch& b) { return on_circle(b, m); }) == 1);
    // From its other branch point a further branch leaves: s = 0, to the circle, the circle, from the circle.
    CHECK(all.size() == 4);
    for (const auto& b : all) {
      if (!on_circle(b, m)) continue;
      CHECK(b.stop_reason == StopReason::closed_loop);
      CHECK_FALSE(b.isola);
      auto wanted = crossings(m, q, t);
      std::sort(wanted.begin(), wanted.end());
      const auto found = values({b}, EventType::branch_point);
      REQUIRE(found.size() == 2);
      for (std::size_t i = 0; i < 2; ++i) CHECK(std::abs(found[i] - wanted[i]) < 1e-10);
      CHECK(values({b}, EventType::fold).size() == 2);
    }
  }
}

TEST_CASE("a branch walked from a seed may end on unknown symmetric ones at both ends") {
  const double m = 2.0, q = 0.1, t = 0.1;
  const System system = circle_apart(m, q, t, 5.0);
  const EquilibriumFlow f = system.flow({"p"});
  Network net(f, {.walk = {.lower = -2.0, .upper = 2.0}});
  const double s = 0.5, p = halfway(m, q, t, 5.0, s);
  (void)net.add_seed(Eigen::Vector3d(s, std::sqrt(p - q + t * s), p), "seed");
  net.switch_branches();
  CHECK(net.branches().size() == 4);
  CHECK(net.notes().empty());
  CHECK(std::count_if(net.branches().begin(), net.branches().end(), [&](const Branch& b) { return on_circle(b, m); }) == 1);
}

TEST_CASE("user values on the last step before a branch ends on a symmetric one are met") {
  const EquilibriumFlow f = System{{"x"}, {"x*(1 - p^2 - x^2)"}, {{"p", 0.0}}, {{"x"}}}.flow({"p"});
  for (const double value : {0.9, 0.99, 0.999, 0.9999, 0.99999}) {
    Network net(f, {.walk = {.lower = -2.0, .upper = 2.0, .user_values = {value}}});
    (void)net.add_seed(Eigen::Vector2d(0.0, -2.0), "start");
    net.switch_branches();
    CAPTURE(value);
    REQUIRE(net.branches().size() == 2);
    CHECK(values({net.branches()[1]}, EventType::user_value).size() == 1);
  }
}

TEST_CASE("seeds on the last digits of the range, on folds and on branch points start nothing twice") {
  const EquilibriumFlow f = System{{"x"}, {"p + x - x^3"}, {{"p", 0.0}}}.flow({"p"});
  for (const double upper : {0.7, 15.4, 0.5, 0.3849001794597506}) {
    Network net(f, {.walk = {.lower = -2.0, .upper = upper}});
    (void)net.add_seed(Eigen::Vector2d(-1.5, -2.0), "start");
    const auto count = net.branches().size();
    CAPTURE(upper);
    for (const double digits : {0.0, 1e-16, -1e-16, 3e-16, -3e-16, 1e-13, -1e-13, 1e-10})
      for (double x : {-2.0, -1.0, -1.0 / std::sqrt(3.0), 0.1, 0.6, 1.1, 2.0, 2.6}) {
        const NewtonResult at = newton(f, Eigen::Vector2d(x, upper * (1.0 + digits)), {.tolerance = 1e-13, .max_iterations = 50});
        if (at.ok()) (void)net.add_seed(at.x, "again");
      }
    for (const double s : {-1.0, 1.0}) (void)net.add_seed(Eigen::Vector2d(s / std::sqrt(3.0), -s * 2.0 / std::sqrt(27.0)), "fold");
    CHECK(net.branches().size() == count);
    CHECK(count == 1);
  }
}

TEST_CASE("what is known is a matter of distance on the curve, in any unit") {
  for (const double unit : {1e-3, 1.0, 1e5}) {
    EquilibriumModel m;
    m.variables = {"x"};
    m.rhs = {"p*x + a*x^2 - b*x^3"};
    m.parameters = {{"p", 0.0}, {"a", 1.0 / unit}, {"b", 1.0 / unit / unit}};
    m.initial = {0.0};
    const EquilibriumFlow f(m, {"p"});
    Network net(f, {.walk = {.lower = -1.0, .upper = 1.0}});
    const auto at = [&](double p, double sign) { return Eigen::Vector2d(unit * (0.5 + sign * std::sqrt(0.25 + p)), p); };
    (void)net.add_seed(at(0.9, 1.0), "start");
    net.switch_branches();
    const auto count = net.branches().size();
    CAPTURE(unit);
    CHECK(count == 2);  // and the line x = 0
    for (const double p : {-0.25, -0.2, -0.1, 0.3, 0.77, 1.0})
      for (const double sign : {1.0, -1.0}) CHECK(net.contains(at(p, sign)));
    for (const double p : {-0.2, 0.3, 0.77}) {
      Vector off = at(p, 1.0);
      off[0] += 1e-4 * unit;
      CHECK_FALSE(net.contains(off));
    }
    CHECK(net.branches().size() == count);
  }
}

TEST_CASE("coupled cells: all states that leave a multiple zero, images included") {
  struct Case {
    int n;
    double c;
    std::size_t states;  // at a = 0.3, by Newton from 20000 starts; 81: by the roots of x^3 - a x + s, s = c sum(x), in all numbers of each
  };
  for (const auto& [n, c, count] : std::vector<Case>{{3, 1.0, 13}, {3, 0.5, 13}, {3, 4.0, 13}, {4, 1.0, 27}, {5, 1.0, 81}}) {
    const EquilibriumFlow f = cells(n, c).flow({"a"});
    Network net(f, {.walk = {.lower = -1.0, .upper = 0.5}});
    Vector start = Vector::Zero(n + 1);
    start[n] = -1.0;
    (void)net.add_seed(start, "start");
    net.switch_branches();
    CAPTURE(n, c);
    CHECK(sound(net.branches()));
    CHECK(states(net, 0.3).size() == count);
    CHECK(net.solutions_at(0.3).size() == count);  // none twice
    CHECK(net.branches().size() == count);         // half a branch each, and zero
    REQUIRE(net.notes().size() == 1);
    CHECK_THAT(net.notes()[0],
               Catch::Contains("B1:BP1") && Catch::Contains(std::to_string(n - 1) + " eigenvalues") && Catch::Contains("does not prove"));
    for (const auto& s : net.branches()[0].special) {
      CHECK(s.subtype == "multiple");
      CHECK(std::abs(s.u[n]) < 1e-12);
    }
  }
}

TEST_CASE("images under symmetries that are found: of seeds, of isolas, of secondary branches") {
  // x -> -x moves the circle (x - 2)^2 + p^2 = 1, which nothing leads to
  const EquilibriumFlow isola = System{{"x"}, {"x*((x^2-4)^2 + 16*p^2 - 4)"}, {{"p", 0.0}}}.flow({"p"});
  Network one(isola, {.walk = {.lower = -1.0, .upper = 1.0}});
  (void)one.add_seed(Eigen::Vector2d(std::sqrt(2.0), 0.0), "seed");
  one.switch_branches();
  REQUIRE(one.branches().size() == 2);
  CHECK(one.branches()[1].born_at == "B1 by symmetry");
  CHECK(one.branches()[1].u(3)[0] == -one.branches()[0].u(3)[0]);
  CHECK(one.branches()[1].special.size() == one.branches()[0].special.size());

  // a ring of three: only rotations
  const System ring{{"x", "y", "z"}, {"1 - x + p*x^2*y", "1 - y + p*y^2*z", "1 - z + p*z^2*x"}, {{"p", 0.0}}};
  const EquilibriumFlow f = ring.flow({"p"});
  const auto group = symmetries(f, {.size = 1.0, .lower = -1.0, .upper = 1.0});
  REQUIRE(group.size() == 2);
  for (const auto& g : group) CHECK(g.signs == Eigen::Vector3d::Ones());
  // nearly one
  const EquilibriumFlow broken = System{{"x", "y"}, {"p*x - x^3 + y", "p*y - y^3*(1+1e-7) + x"}, {{"p", 0.0}}}.flow({"p"});
  const auto left = symmetries(broken, {.size = 1.0, .lower = -1.0, .upper = 1.0});
  REQUIRE(left.size() == 1);  // the common change of sign
  CHECK(left[0].signs == Eigen::Vector2d(-1.0, -1.0));
}

TEST_CASE("a point where several eigenvalues vanish is located on its own equations") {
  // shifted, so that no coordinate is zero there: p = 0.3, x = y = 1
  const EquilibriumFlow f =
      System{{"x", "y"}, {"(p-0.3)*(x-1) - (x-1)^3 - 0.5*(x-1)*(y-1)^2", "(p-0.3)*(y-1) - (y-1)^3 - 0.5*(y-1)*(x-1)^2"}, {{"p", 0.0}}}.flow({"p"});
  const auto at = multiple_point_near(f, Eigen::Vector3d(1.0, 1.0, 0.30000003));
  REQUIRE(at);
  CHECK(at->dimension == 2);
  CHECK((at->u - Eigen::Vector3d(1.0, 1.0, 0.3)).norm() < 1e-13);
  // with quadratic terms the equations fix x, too
  const EquilibriumFlow g = System{{"x", "y"}, {"(p-0.3)*x - x^2 + x*y", "(p-0.3)*y - y^2 + x*y"}, {{"p", 0.0}}}.flow({"p"});
  const auto there = multiple_point_near(g, Eigen::Vector3d(1e-7, -2e-7, 0.30000003));
  REQUIRE(there);
  CHECK((there->u - Eigen::Vector3d(0.0, 0.0, 0.3)).norm() < 1e-12);
  // two zeros next to each other are not one
  const EquilibriumFlow apart = System{{"x", "y"}, {"p*x - x^3", "(p-1e-5)*y - y^3"}, {{"p", 0.0}}}.flow({"p"});
  CHECK_FALSE(multiple_point_near(apart, Eigen::Vector3d(0.0, 0.0, 1e-6)));
}
