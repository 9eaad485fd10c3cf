/// Resonance peaks and their curves, kinds of branch points, signs of coefficients, bounds in both parameters, isolas.
#include <catch2/catch.hpp>

#include "continuation/network.hpp"
#include "continuation/normal_form.hpp"
#include "continuation/two_parameter.hpp"
#include "core/dual_problem.hpp"

using namespace whirl;
using namespace whirl::continuation;

namespace {

template <class S>
using Args = std::span<const S>;
template <class S>
using Result = std::span<S>;

/// Averaged Duffing oscillator, u = (a, b, w | P): |Z|^2 ((1 - w^2 + 3/4 gamma |Z|^2)^2 + (c w)^2) = P^2 at rest.
struct Duffing {
  double c = 0.05, gamma = 0.1, load = 0.18;
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    const S a = u[0], b = u[1], w = u[2], P = u.size() > 3 ? u[3] : S(load);
    const S detuning = 1.0 - w * w + 0.75 * gamma * (a * a + b * b);
    r[0] = (-detuning * b - c * w * a) / (2.0 * w);
    r[1] = (detuning * a - P - c * w * b) / (2.0 * w);
  }
};

/// The largest amplitude and where it stands: dA/dw = 0 at fixed P gives 1 - w^2 + 3/4 gamma A^2 = c^2/2.
std::pair<double, double> peak(const Duffing& m, double P) {
  // c^2 A^2 (1 + 3/4 gamma A^2 - c^2/4) = P^2, a quadratic in A^2
  const double a = 0.75 * m.gamma, b = 1.0 - 0.25 * m.c * m.c, d = P * P / (m.c * m.c);
  const double A2 = 2.0 * d / (b + std::sqrt(b * b + 4.0 * a * d));
  return {std::sqrt(1.0 + a * A2 - 0.5 * m.c * m.c), std::sqrt(A2)};
}

Observable amplitude() { return {.name = "A", .form = QuadraticForm::square_sum(2, {0, 1})}; }

template <class Field>
struct Plain {
  Field field;
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    field(u, r);
  }
};

template <class Field>
DualProblem<Plain<Field>> flow(Field field, int n, int k = 1) {
  return DualProblem<Plain<Field>>({field}, n, k, true);
}

Vector vec(std::initializer_list<double> values) {
  Vector v(static_cast<int>(values.size()));
  std::copy(values.begin(), values.end(), v.data());
  return v;
}

WalkOptions range(double lower, double upper) {
  WalkOptions o;
  o.lower = lower;
  o.upper = upper;
  return o;
}

std::vector<SpecialPoint> events(const Branch& b, EventType type) {
  std::vector<SpecialPoint> list;
  for (const auto& s : b.special)
    if (s.type == type) list.push_back(s);
  return list;
}

std::vector<CodimensionTwo> of_type(const DefiningCurve& c, const std::string& type) {
  std::vector<CodimensionTwo> all;
  for (const auto& s : c.special)
    if (s.type == type) all.push_back(s);
  return all;
}

TwoParameterOptions ranges(double a, double b, double c, double d) {
  TwoParameterOptions t;
  t.range1[0] = a;
  t.range1[1] = b;
  t.range2[0] = c;
  t.range2[1] = d;
  return t;
}

}  // namespace

TEST_CASE("the resonance peak of a Duffing oscillator and its ridge in frequency and load", "[published]") {
  const Duffing m;
  const DualProblem<Duffing> f(m, 2, 1, true), f2(m, 2, 2, true);
  WalkOptions o = range(0.6, 1.6);
  o.peaks = {amplitude()};
  const Branch b = Walker(f, o).walk(vec({0.28, 0.0, 0.6}));
  const auto peaks = events(b, EventType::peak);
  REQUIRE(peaks.size() == 1);
  const auto [w, A] = peak(m, m.load);
  CHECK(peaks[0].u[2] == Approx(w).epsilon(1e-12));  // Newton on the peak's own system
  CHECK(peaks[0].u.head(2).norm() == Approx(A).epsilon(1e-12));
  CHECK(peaks[0].subtype == "A");
  CHECK(peaks[0].residual < 1e-12);

  TwoParameterOptions t = ranges(0.6, 1.35, 0.005, 0.3);
  t.walk.peaks = {amplitude()};
  const DefiningCurve ridge = follow(f2, peaks[0], m.load, t);
  REQUIRE(ridge.u.cols() > 10);
  for (Eigen::Index i = 0; i < ridge.u.cols(); ++i) {
    const auto [wi, Ai] = peak(m, ridge.u(3, i));
    CHECK(ridge.u(2, i) == Approx(wi).epsilon(1e-9));
    CHECK(ridge.u.col(i).head(2).norm() == Approx(Ai).epsilon(1e-9));
  }
  // One end on the lower load, the other on the upper frequency, both exactly.
  CHECK(ridge.start_reason == StopReason::parameter_bound);
  CHECK(ridge.stop_reason == StopReason::parameter_bound);
  const auto last = ridge.u.cols() - 1;
  CHECK(std::min(ridge.u(3, 0), ridge.u(3, last)) == 0.005);
  CHECK(std::max(ridge.u(2, 0), ridge.u(2, last)) == 1.35);

  SECTION("with hardly any damping the ridge is the backbone") {
    const Duffing thin{.c = 1e-4, .load = 1e-4};
    const DualProblem<Duffing> g(thin, 2, 1, true), g2(thin, 2, 2, true);
    const auto [w0, A0] = peak(thin, thin.load);
    WalkOptions near = range(w0 - 0.02, w0 + 0.02);
    near.peaks = {amplitude()};
    // on the ridge the motion lags by a quarter of a period
    const Branch resonance = Walker(g, near).walk(vec({0.0, -A0, w0}));
    const auto top = events(resonance, EventType::peak);
    REQUIRE(top.size() == 1);
    TwoParameterOptions u = ranges(1.0, 1.3, 1e-5, 3e-4);
    u.walk.peaks = {amplitude()};
    const DefiningCurve backbone = follow(g2, top[0], thin.load, u);
    for (Eigen::Index i = 0; i < backbone.u.cols(); ++i) {
      const double A2 = backbone.u.col(i).head(2).squaredNorm();
      CHECK(backbone.u(2, i) == Approx(std::sqrt(1.0 + 0.075 * A2)).epsilon(1e-8));  // c^2/2 = 5e-9
    }
  }
}

TEST_CASE("branch points are told apart and so are their senses", "[published]") {
  const auto first_branch_point = [](const Problem& f, const Vector& u0) {
    const Branch b = Walker(f, range(-1.0, 1.0)).walk(u0);
    auto all = events(b, EventType::branch_point);
    REQUIRE(all.size() == 1);
    set_normal_form(f, all[0]);
    return all[0];
  };
  SECTION("transcritical") {
    const auto p = first_branch_point(flow([](auto u, auto r) { r[0] = u[1] * u[0] - u[0] * u[0]; }, 1), vec({0, -1}));
    CHECK(p.subtype == "TC");
    CHECK(std::abs(p.coefficient) == Approx(1.0).epsilon(1e-10));
    CHECK(criticality(p).empty());
  }
  SECTION("pitchforks that no symmetry was declared for") {
    const double sign = GENERATE(-1.0, 1.0);
    const auto p = first_branch_point(flow([sign](auto u, auto r) { r[0] = u[1] * u[0] + sign * 2.0 * (u[0] * u[0] * u[0]); }, 1), vec({0, -1}));
    CHECK(p.subtype == "PF");
    CHECK(p.coefficient == Approx(2.0 * sign).epsilon(1e-8));
    CHECK(criticality(p) == (sign < 0.0 ? "supercritical" : "subcritical"));
  }
  SECTION("two curves that cross with slopes of their own") {  // (x - p)(x + 2p) = 0
    const auto p = first_branch_point(flow([](auto u, auto r) { r[0] = (u[1] - u[0]) * (u[0] + 2.0 * u[1]); }, 1), vec({-1, -1}));
    CHECK(p.subtype == "TC");
  }
}

TEST_CASE("the quadratic coefficient of a fold keeps its sign along the curve and vanishes at the cusp only", "[published]") {
  const auto f = flow([](auto u, auto r) { r[0] = u[1] + u[0] - u[0] * u[0] * u[0]; }, 1);
  const auto f2 = flow([](auto u, auto r) { r[0] = u[1] + u[2] * u[0] - u[0] * u[0] * u[0]; }, 1, 2);
  const Branch b = Walker(f, range(-2.0, 2.0)).walk(vec({-1.6, -2.0}));
  Network net(f, {.walk = range(-2.0, 2.0)});
  net.add_seed(vec({-1.6, -2.0}), "start");
  const auto folds = events(net.branches()[0], EventType::fold);
  REQUIRE(folds.size() == 2);
  const DefiningCurve c = follow(f2, folds[0], 1.0, ranges(-1.0, 1.0, -1.0, 2.0));
  for (Eigen::Index i = 0; i < c.u.cols(); ++i)
    CHECK(c.coefficient[i] == Approx(folds[0].coefficient / folds[0].u[0] * c.u(0, i)).epsilon(0).margin(1e-9));
  // -3 x with v = 1, along the branch
  CHECK(std::abs(folds[0].coefficient / folds[0].u[0]) == Approx(3.0).epsilon(1e-10));
  // Both ends stand on a bound of the first parameter, 27 mu^2 = 4 lambda^3.
  CHECK(c.start_reason == StopReason::parameter_bound);
  CHECK(c.stop_reason == StopReason::parameter_bound);
  for (const Eigen::Index end : {Eigen::Index(0), c.u.cols() - 1}) {
    CHECK(std::abs(c.u(1, end)) == 1.0);
    CHECK(c.u(2, end) == Approx(std::cbrt(27.0 / 4.0)).epsilon(1e-10));
  }
}

TEST_CASE("a pitchfork without a declared symmetry degenerates where its cubic term vanishes", "[published]") {
  const auto field = [](auto u, auto lambda, auto r) {
    const auto x = u[0];
    const auto x3 = x * x * x;
    r[0] = u[1] * x + lambda * x3 - x3 * x * x;
  };
  const auto f = flow([field](auto u, auto r) { field(u, -0.5, r); }, 1);
  const auto f2 = flow([field](auto u, auto r) { field(u, u[2], r); }, 1, 2);
  const Branch b = Walker(f, range(-1.0, 1.0)).walk(vec({0, -1}));
  const auto points = events(b, EventType::branch_point);
  REQUIRE(points.size() == 1);
  const DefiningCurve c = follow(f2, points[0], -0.5, ranges(-1.0, 1.0, -0.6, 0.7));
  const auto degenerate = of_type(c, "DP");
  REQUIRE(degenerate.size() == 1);
  CHECK(degenerate[0].u.norm() < 1e-9);
}

TEST_CASE("pairs that cross on curves of branch points and of Hopf points", "[published]") {
  // Growth rates p1 and p2 + 0.3 of two parts that know nothing of each other.
  const auto oscillator = [](auto a, auto x, auto y, double w, auto& rx, auto& ry) {
    rx = a * x - w * y - x * (x * x + y * y);
    ry = w * x + a * y - y * (x * x + y * y);
  };
  SECTION("zero-Hopf on a curve of pitchforks") {
    const auto field = [oscillator](auto u, auto p2, auto r) {
      r[0] = u[3] * u[0] - u[0] * u[0] * u[0];
      oscillator(p2 + 0.3, u[1], u[2], 2.0, r[1], r[2]);
    };
    const auto f = flow([field](auto u, auto r) { field(u, 0.5 + 0.0 * u[3], r); }, 3);
    const auto f2 = flow([field](auto u, auto r) { field(u, u[4], r); }, 3, 2);
    const Branch b = Walker(f, range(-1.0, 1.0)).walk(vec({0, 0, 0, -1}));
    const auto points = events(b, EventType::branch_point);
    REQUIRE(points.size() == 1);
    const auto zero_hopf = of_type(follow(f2, points[0], 0.5, ranges(-1.0, 1.0, -1.0, 1.0)), "ZH");
    REQUIRE(zero_hopf.size() == 1);
    CHECK(zero_hopf[0].u[4] == Approx(-0.3).epsilon(1e-9));
  }
  SECTION("double Hopf") {
    const auto field = [oscillator](auto u, auto p2, auto r) {
      oscillator(u[4], u[0], u[1], 1.0, r[0], r[1]);
      oscillator(p2 + 0.3, u[2], u[3], 2.0, r[2], r[3]);
    };
    const auto f = flow([field](auto u, auto r) { field(u, 0.5 + 0.0 * u[4], r); }, 4);
    const auto f2 = flow([field](auto u, auto r) { field(u, u[5], r); }, 4, 2);
    const Branch b = Walker(f, range(-1.0, 1.0)).walk(vec({0, 0, 0, 0, -1}));
    const auto points = events(b, EventType::hopf);
    REQUIRE(points.size() == 1);
    CHECK(points[0].frequency == Approx(1.0).epsilon(1e-10));
    const auto both = of_type(follow(f2, points[0], 0.5, ranges(-1.0, 1.0, -1.0, 1.0)), "HH");
    REQUIRE(both.size() == 1);
    CHECK(both[0].u[5] == Approx(-0.3).epsilon(1e-9));
  }
}

TEST_CASE("an isola is told as such, a closed curve with a branch point on a known branch is none") {
  const auto f = flow([](auto u, auto r) { r[0] = u[0] * (0.25 - u[1] * u[1] - (u[0] - 2.0) * (u[0] - 2.0)); }, 1);
  Network net(f, {.walk = range(-1.0, 1.0)});
  REQUIRE(net.add_seed(vec({0, -1}), "start"));
  REQUIRE(net.add_seed(vec({2.5, 0}), "seed 1"));
  CHECK_FALSE(net.add_seed(vec({1.5, 0}), "seed 2"));  // the same closed curve
  REQUIRE(net.branches().size() == 2);
  CHECK_FALSE(net.branches()[0].isola);
  CHECK(net.branches()[1].isola);
  const auto g = flow([](auto u, auto r) { r[0] = u[0] * (0.25 - u[1] * u[1] - u[0] * u[0]); }, 1);
  Network touching(g, {.walk = range(-1.0, 1.0)});
  REQUIRE(touching.add_seed(vec({0, -1}), "start"));
  REQUIRE(touching.add_seed(vec({0.5, 0}), "seed 1"));
  REQUIRE(touching.branches().size() == 2);
  CHECK_FALSE(touching.branches()[1].isola);
}
