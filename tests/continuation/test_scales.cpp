/// What is found does not depend on the units of x, p and t, nor on how near to a branch point a branch turns; closed branches turn at their branch
/// points without folds.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "continuation/natural_size.hpp"
#include "core/problem_in_units.hpp"
#include "tests/continuation/rescaled.hpp"
#include "tests/continuation/text_model.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::continuation::text_model;

namespace {

constexpr double located = 1e-10;  // relative, as events are reported

struct Study {
  System system;
  std::string lens;
  double lower, upper;
  std::vector<double> start;
};

// Closed forms or published; at least a pitchfork, a transcritical point, folds and Hopf points, with and without a reflection.
std::vector<Study> studies() {
  const System quintic{{"x"}, {"x*(p + x^2 - x^4)"}, {{"p", -0.9}}};
  System mirrored = quintic;
  mirrored.mirrors = {{"x"}};
  const System brusselator{{"x", "y"}, {"1 - (B+1)*x + x^2*y", "B*x - x^2*y"}, {{"B", 1.0}}};
  const System predator{{"x", "y"}, {"x*(1-x) - 3*x*y/(1+5*x)", "-m*y + 3*x*y/(1+5*x)"}, {{"m", 0.7}}};
  const System lorenz{{"x", "y", "z"}, {"10*(y - x)", "x*(r - z) - y", "x*y - 8*z/3"}, {{"r", 0.5}}};  // products alone are not linear
  System turned = lorenz;
  turned.mirrors = {{"x", "y"}};
  const System cells{{"x", "y"}, {"p*x - x^3 - 0.5*x*y^2", "p*y - y^3 - 0.5*y*x^2"}, {{"p", -1.0}}};  // two eigenvalues zero at once
  return {{quintic, "p", -1.0, 1.0, {0.0, -0.9}},      {mirrored, "p", -1.0, 1.0, {0.0, -0.9}},        {brusselator, "B", 1.0, 4.0, {1.0, 1.0, 1.0}},
          {predator, "m", 0.05, 0.7, {1.0, 0.0, 0.7}}, {lorenz, "r", 0.5, 30.0, {0.0, 0.0, 0.0, 0.5}}, {turned, "r", 0.5, 30.0, {0.0, 0.0, 0.0, 0.5}},
          {cells, "p", -1.0, 1.0, {0.0, 0.0, -1.0}}};
}

// Kinds and parameter values, in the units of the study.
std::vector<std::pair<std::string, double>> events(const Problem& f, const Study& s, double a, double b) {
  NetworkOptions o;
  o.walk.lower = b * s.lower;
  o.walk.upper = b * s.upper;
  Network net(f, o);
  const int n = f.size();
  Vector u = Eigen::Map<const Vector>(s.start.data(), n + 1);
  u.head(n) *= a;
  u[n] *= b;
  CHECK(net.add_seed(u, "start"));
  net.switch_branches();
  CHECK(sound(net.branches()));
  std::vector<std::pair<std::string, double>> found;
  for (const auto& branch : net.branches())
    for (const auto& e : branch.special) found.emplace_back(to_string(e.type) + e.subtype, e.u[n] / b);
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<Branch> turning_near_birth(const std::string& rhs) { return branches({{"x"}, {rhs}, {{"p", -0.9}}}, "p", -1.0, 1.0, {{0.0, -0.9}}); }

}  // namespace

TEST_CASE("the same events in any units of x, p and t") {
  for (const auto& s : studies()) {
    const auto f = s.system.flow({s.lens});
    const auto wanted = events(f, s, 1.0, 1.0);
    CAPTURE(s.system.rhs);
    REQUIRE(wanted.size() >= 1);
    const struct {
      double a, b, c;
    } units[] = {{1.7e-4, 1.0, 1.0}, {3e3, 1.0, 1.0},   {1e12, 1.0, 1.0}, {1e-7, 1.0, 1.0}, {1e-12, 1.0, 1.0}, {1.0, 1e-12, 1.0},
                 {1.0, 1e12, 1.0},   {1.0, 1.0, 1e-12}, {1.0, 1.0, 1e12}, {5e9, 2e-7, 3e8}, {3e-9, 7e6, 2e-5}};
    for (const auto& unit : units) {
      CAPTURE(unit.a, unit.b, unit.c);
      const Rescaled other(f, Vector::Constant(f.size(), unit.a), unit.b, unit.c);
      const auto found = events(other, s, unit.a, unit.b);
      CHECK(found.size() == wanted.size());
      for (std::size_t i = 0; i < std::min(found.size(), wanted.size()); ++i) {
        CHECK(found[i].first == wanted[i].first);
        CHECK(std::abs(found[i].second - wanted[i].second) < located * (s.upper - s.lower));
      }
    }
  }
}

TEST_CASE("a fold however near to the transcritical point at which its branch is born") {
  for (const double e : {0.1, 1e-2, 1e-3, 1e-4, 1e-5}) {  // p = (x - e)^2 - e^2
    CAPTURE(e);
    const auto all = turning_near_birth(fmt::format("x*(p - (x - {0:.17g})^2 + {0:.17g}^2)", e));
    CHECK(sound(all));
    const auto folds = of_type(all, EventType::fold);
    REQUIRE(folds.size() == 1);
    CHECK(folds[0].u[1] == Approx(-e * e).epsilon(1e-6));
    CHECK(folds[0].u[0] == Approx(e).epsilon(1e-6));
    CHECK(of_type(all, EventType::branch_point).size() == 1);
  }
}

TEST_CASE("folds however near to a pitchfork") {
  for (const double e : {0.1, 1e-2, 2e-3}) {  // p = x^4 - 2 e^2 x^2
    CAPTURE(e);
    const auto all = turning_near_birth(fmt::format("x*(p + 2*{0:.17g}^2*x^2 - x^4)", e));
    CHECK(sound(all));
    const auto folds = of_type(all, EventType::fold);
    REQUIRE(folds.size() == 2);
    for (const auto& fold : folds) CHECK(std::abs(fold.u[0]) == Approx(e).epsilon(1e-6));
  }
}

TEST_CASE("closed branches between two pitchforks have no folds") {
  for (const std::string square : {"x^2", "x^2/9", "1e4*x^2", "1e-6*x^2", "1e8*x^2"})
    for (const bool told : {false, true}) {
      System s{{"x"}, {"x*(1 - p^2 - " + square + ")"}, {{"p", -2.0}}};
      if (told) s.mirrors = {{"x"}};
      const auto all = branches(s, "p", -2.0, 2.0, {{0.0, -2.0}});
      CAPTURE(square, told);
      CHECK(sound(all));
      CHECK(all.size() == 2);
      CHECK(of_type(all, EventType::fold).empty());
      for (const double p : values(all, EventType::branch_point)) CHECK(std::abs(std::abs(p) - 1.0) < located);
    }
}

TEST_CASE("the size of x that a problem has of its own") {
  const System s{{"x", "y"}, {"x*(p + 1e6*x^2)", "-y + y^2/1000"}, {{"p", 0.0}}};
  const auto f = s.flow({"p"});
  const Vector sizes = natural_sizes(f, Vector::Zero(3), -1.0, 1.0);
  CHECK(sizes[0] > 1e-4);
  CHECK(sizes[0] < 0.1);
  CHECK(sizes[1] > 1e2);
  CHECK(sizes[1] < 1e4);
  CHECK(natural_size(f, Vector::Zero(3), -1.0, 1.0) < 0.1);
  const System linear{{"x"}, {"p - x"}, {{"p", 0.0}}};
  CHECK(natural_size(linear.flow({"p"}), Vector::Zero(2), -1.0, 1.0) == 1.0);
}

TEST_CASE("Newton's tolerance is in the units of the unknowns") {
  const System s{{"x"}, {"x - 1e-9 + 1e6*(x-1e-9)^2 - p"}, {{"p", 0.0}}};
  const auto f = s.flow({"p"});
  Vector start(2);
  start << 2e-7, 0.0;
  const NewtonResult r = newton_in_units(f, start, Vector::Constant(1, 1e-9));
  CHECK(r.ok());
  CHECK(r.x[0] == Approx(1e-9).epsilon(1e-12));
}
