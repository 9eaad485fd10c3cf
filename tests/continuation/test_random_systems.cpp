/// Nothing missed: on random cubic vector fields the walker at default options finds what steps forty times shorter find, and nothing else.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
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

// p = g(s) with g' zero at the folds; beside it an oscillator whose damping -alpha(s) is zero at the Hopf points.
struct FoldsAndPairs {
  std::vector<double> g, hopfs;
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    const S &s = u[0], &x = u[1], &y = u[2], &p = u[3];
    S value = g.back() * s, alpha = S(1.0);
    for (std::size_t k = g.size() - 1; k-- > 0;) value = (value + g[k]) * s;
    for (const double z : hopfs) alpha = alpha * (s - z);
    const S square = x * x + y * y;
    r[0] = p - value;
    r[1] = alpha * x - y - x * square;
    r[2] = x + alpha * y - y * square;
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

int bifurcations(const Branch& b) { return static_cast<int>(std::count_if(b.special.begin(), b.special.end(), is_bifurcation)); }

// No jump on the way: both ends are the same.
bool same_ends(const Branch& a, const Branch& b) {
  return (a.u(a.points() - 1) - b.u(b.points() - 1)).norm() < 1e-6 && (a.u(0) - b.u(0)).norm() < 1e-6;
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
      CHECK(same_ends(found, reference));
      CHECK(bifurcations(found) == bifurcations(reference));
      CHECK(without_like(reference, found) == 0);
      CHECK(without_like(found, reference) == 0);
      CHECK(std::none_of(found.special.begin(), found.special.end(), [](const auto& s) { return s.type == EventType::unresolved; }));
      ++systems;
      events += static_cast<int>(reference.special.size());
    }
  CHECK(systems > 250);
  CHECK(events > 700);
}

TEST_CASE("folds and Hopf points in close pairs, beside each other and within a step", "[slow]") {
  // Pairs 3e-5 to 0.3 apart on a way of 1.4, left out where they are less than 1e-9 of the range apart in the parameter, or in the damping.
  int systems = 0, events = 0, missed = 0, extra = 0;
  for (unsigned seed = 0; seed < 1500; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-0.5, 0.5), exponent(-4.5, -0.5);
    const auto pair = [&](std::vector<double>& to) {
      const double centre = place(random), half = 0.5 * std::pow(10.0, exponent(random));
      to.insert(to.end(), {centre - half, centre + half});
    };
    FoldsAndPairs model;
    std::vector<double> folds, slope = {1.0};
    for (unsigned i = 0; i < 1 + seed % 2; ++i) pair(folds);
    if (seed % 3 == 0) folds.push_back(place(random));
    if (seed % 4 != 0) pair(model.hopfs);
    if (seed % 5 < 2) model.hopfs.push_back(place(random));
    std::sort(folds.begin(), folds.end());
    std::sort(model.hopfs.begin(), model.hopfs.end());
    for (const double root : folds) {
      slope.push_back(0.0);
      for (std::size_t k = slope.size() - 1; k > 0; --k) slope[k] = slope[k - 1] - root * slope[k];
      slope[0] *= -root;
    }
    for (std::size_t k = 0; k < slope.size(); ++k) model.g.push_back(slope[k] / (static_cast<double>(k) + 1.0));
    const auto parameter = [&](double s) {
      double sum = 0.0;
      for (std::size_t k = model.g.size(); k-- > 0;) sum = (sum + model.g[k]) * s;
      return sum;
    };
    double low = parameter(-0.7), high = low;
    for (double s = -0.7; s < 0.7; s += 1e-3) {
      low = std::min(low, parameter(s));
      high = std::max(high, parameter(s));
    }
    bool resolved = true;
    for (std::size_t i = 0; i + 1 < folds.size(); ++i)
      resolved = resolved && std::abs(parameter(folds[i]) - parameter(folds[i + 1])) > 1e-9 * (high - low);
    for (std::size_t i = 0; i + 1 < model.hopfs.size(); ++i) {
      double alpha = 1.0;
      for (const double z : model.hopfs) alpha *= 0.5 * (model.hopfs[i] + model.hopfs[i + 1]) - z;
      resolved = resolved && std::abs(alpha) > 1e-9;
    }
    if (!resolved) continue;
    const double margin = 0.01 * (high - low);
    WalkOptions options{.lower = low - margin, .upper = high + margin};
    options.bounds = {{0, -0.71, 0.71}};
    Vector start = Vector::Zero(4);
    start << -0.7, 0.0, 0.0, parameter(-0.7);
    const DualProblem<FoldsAndPairs> f(model, 3, 1, true);
    const Branch b = Walker(f, options).walk(start);
    const auto count = [&](EventType type) {
      return static_cast<int>(std::count_if(b.special.begin(), b.special.end(), [type](const auto& s) { return s.type == type; }));
    };
    CAPTURE(seed);
    CHECK(count(EventType::unresolved) == 0);
    for (const int difference :
         {static_cast<int>(folds.size()) - count(EventType::fold), static_cast<int>(model.hopfs.size()) - count(EventType::hopf)}) {
      missed += std::max(0, difference);
      extra += std::max(0, -difference);
    }
    events += static_cast<int>(folds.size() + model.hopfs.size());
    ++systems;
  }
  CAPTURE(systems, events, missed);
  CHECK(systems > 500);
  CHECK(extra == 0);
  CHECK(missed <= events / 400);  // what the README says of it
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
