/// Nothing missed: on random cubic vector fields the walker at default options finds what steps forty times shorter find, and nothing else.

#include <catch2/catch.hpp>
#include <random>

#include "continuation/growth_rates.hpp"
#include "continuation/walker.hpp"
#include "core/dual_problem.hpp"
#include "core/newton.hpp"

using namespace whirl;
using namespace whirl::continuation;

namespace {

// x' = c0 + c1 p + (A + B p) x + Q(x, x) - 0.3 x^3
struct CubicField {
  std::size_t n;
  std::vector<double> a, b, q, c;

  CubicField(std::size_t size, double slope, double quadratic, std::mt19937& random) : n(size) {
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < n * n; ++i) {
      a.push_back(normal(random));
      b.push_back(slope * normal(random));
    }
    for (std::size_t i = 0; i < n * n * n; ++i) q.push_back(quadratic * normal(random));
    for (std::size_t i = 0; i < 2 * n; ++i) c.push_back(normal(random));
  }

  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    const S& p = u[n];
    for (std::size_t i = 0; i < n; ++i) {
      S sum = c[i] + c[n + i] * p - 0.3 * u[i] * u[i] * u[i];
      for (std::size_t j = 0; j < n; ++j) {
        sum = sum + (a[i * n + j] + b[i * n + j] * p) * u[j];
        for (std::size_t k = j; k < n; ++k) sum = sum + q[(i * n + j) * n + k] * u[j] * u[k];
      }
      r[i] = sum;
    }
  }
};

// (x - 2 p) (x + p) = -e: a transcritical point that a little e parts into two curves with a fold each.
struct Parted {
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    r[0] = -(u[0] - 2.0 * u[1]) * (u[0] + u[1]) - 1e-3;
  }
};

struct Parabola {  // a fold at p = 1 + e
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    r[0] = 1.0 + 1e-5 - u[1] - u[0] * u[0];
  }
};

bool is_bifurcation(const SpecialPoint& s) { return s.type == EventType::fold || s.type == EventType::hopf || s.type == EventType::branch_point; }

// A solution at p = 0, if Newton finds one soon.
bool find_start(const Problem& f, std::mt19937& random, Vector& u) {
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    for (int k = 0; k < f.size(); ++k) u[k] = normal(random);
    u[f.size()] = 0.0;
    const NewtonResult r = newton(f, u);
    if (r.ok()) {
      u = r.x;
      return true;
    }
  }
  return false;
}

// Special points of `of` without their like in `in`.
int without_like(const Branch& of, const Branch& in) {
  int count = 0;
  for (const auto& s : of.special)
    if (is_bifurcation(s))
      count +=
          std::none_of(in.special.begin(), in.special.end(), [&](const auto& t) { return t.type == s.type && (t.u - s.u).norm() < 1e-6; }) ? 1 : 0;
  return count;
}

// Where curves pass each other at a hair's breadth even short steps may change over: the ends tell.
bool same_curve(const Branch& a, const Branch& b) {
  const auto ends_meet = [](const Branch& s, const Branch& t) {
    return (s.u(s.points() - 1) - t.u(t.points() - 1)).norm() < 1e-6 && (s.u(0) - t.u(0)).norm() < 1e-6;
  };
  return ends_meet(a, b);
}

}  // namespace

TEST_CASE("random vector fields: every event that short steps find, none besides", "[slow]") {
  const struct {
    double slope, quadratic;
    std::size_t least;
    unsigned first, count;
  } families[] = {{0.4, 0.5, 2, 0, 120}, {1.5, 1.5, 3, 0, 140},  {1.5, 1.5, 3, 470, 2}, {1.5, 1.5, 3, 526, 1},
                  {1.5, 1.5, 3, 763, 1}, {0.4, 0.5, 2, 2944, 1}, {0.4, 0.5, 2, 1675, 1}};
  int systems = 0, events = 0;
  for (const auto& family : families)
    for (unsigned seed = family.first; seed < family.first + family.count; ++seed) {
      std::mt19937 random(seed);
      const DualProblem<CubicField> f({family.least + seed % 4, family.slope, family.quadratic, random}, static_cast<int>(family.least + seed % 4), 1,
                                      true);
      Vector start(f.size() + 1);
      if (!find_start(f, random, start)) continue;
      WalkOptions options{.lower = -3.0, .upper = 3.0};
      const Branch found = Walker(f, options).walk(start);
      options.max_step /= 40.0;
      options.initial_step /= 20.0;
      options.max_points = 400000;
      options.max_angle_deg = 1.0;
      const Branch reference = Walker(f, options).walk(start);
      CAPTURE(seed, family.slope, family.least);
      CHECK(same_curve(found, reference));
      CHECK(without_like(reference, found) == 0);
      CHECK(without_like(found, reference) == 0);
      CHECK(std::none_of(found.special.begin(), found.special.end(), [](const auto& s) { return s.type == EventType::unresolved; }));
      ++systems;
      events += static_cast<int>(reference.special.size());
    }
  CHECK(systems > 250);
  CHECK(events > 700);
}

TEST_CASE("two curves that nearly cross have no branch point, however long the steps") {
  const DualProblem<Parted> f({}, 1, 1, true);
  Vector start(2);
  start << -1.0, -1.0;
  const Branch b = Walker(f, {.lower = -1.0, .upper = 1.0}).walk(newton(f, start).x);
  REQUIRE(b.special.size() == 1);  // 9 p^2 = 4 e
  CHECK(b.special[0].type == EventType::fold);
  CHECK(b.special[0].u[1] == Approx(-std::sqrt(4e-3 / 9.0)).epsilon(1e-9));
  CHECK(b.u(0)[1] == -1.0);
  CHECK(b.u(b.points() - 1)[1] == -1.0);
}

TEST_CASE("a curve that leaves the range between two points ends there") {
  const DualProblem<Parabola> f({}, 1, 1, true);
  Vector start(2);
  start << 1.0, 1e-5;
  const Branch b = Walker(f, {.lower = -1.0, .upper = 1.0}).walk(newton(f, start).x);
  CHECK(b.special.empty());
  CHECK(b.stop_reason == StopReason::parameter_bound);
  const Vector end = b.u(0)[1] > b.u(b.points() - 1)[1] ? b.u(0) : b.u(b.points() - 1);
  CHECK(end[1] == 1.0);
  CHECK(end[0] == Approx(std::sqrt(1e-5)).epsilon(1e-8));
}

TEST_CASE("growth rates are ranked, and those far from zero forgotten") {
  GrowthRates r;
  for (const double rate : {-3.0, 0.5, -0.1, 2.0, 0.0, 7.0, 9.0, 11.0, -0.2, -8.0}) r.add(rate);
  CHECK(r.positive() == 5);
  CHECK(r.ranked(1) == std::numeric_limits<double>::infinity());  // 11 is the fifth from zero
  const double kept[] = {9.0, 7.0, 2.0, 0.5, 0.0, -0.1, -0.2, -3.0};
  for (int i = 0; i < 8; ++i) CHECK(r.ranked(i + 2) == kept[i]);
  CHECK(r.ranked(10) == -std::numeric_limits<double>::infinity());
  r.clear();
  CHECK(r.positive() == 0);
  CHECK(std::isinf(r.ranked(1)));
}
