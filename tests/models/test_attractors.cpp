// Attractors of the stroboscopic map on systems whose motion is known.
#include "models/attractors.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <numbers>

#include "core/cvode.hpp"
#include "models/lyapunov.hpp"
#include "models/nielsen_kirkegaard.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

ModalSystem<double> stay(double omega, Terms terms = Terms::reduced) {
  const auto p = oresund(0.5, omega);
  return nielsen_kirkegaard(p, stay_model(p.cable, Coefficients::exact), terms);
}

std::vector<Reflection> whirling() { return {{point({-1, 1, -1, 1}), "WH"}}; }

// x'' + c x' + k x + a x^3 = F cos(omega t)
ModalSystem<double> duffing(double c, double k, double a, double F, double omega) {
  ModalSystem<double> s;
  s.omega = omega;
  s.damping = {c};
  s.stiffness = {k};
  s.add_term(0, a, {0, 0, 0});
  s.add_force(0, F, 1);
  return s;
}

Attractor settled(const ModalSystem<double>& system, const Vector& start, MotionKind kind) {
  AttractorFinder finder(system);
  const Settled s = finder.settle(start, AttractorSet());
  INFO(to_string(s.kind) << " " << s.why);
  REQUIRE(s.kind == kind);
  return s.fresh.value();
}

}  // namespace

TEST_CASE("the flat right-hand side is the modal system's, its tangents are the duals'") {
  ModalSystem<double> odd = stay(1.7, Terms::full);  // and terms of every sort
  odd.add_term(0, 0.3, {1, 0, 1, 1}, 3);
  odd.add_term(1, -0.2, {1}, 3);
  odd.add_term(1, 0.15, {}, 2);
  odd.add_term(1, 0.05, {});
  odd.add_force(0, 0.7, 5);
  odd.add_force(0, 0.11, 0);
  for (const auto& system : {stay(1.7), stay(1.7, Terms::full), odd, duffing(0.1, 1.0, 2.0, 3.0, 0.9)}) {
    const FlatFlow flat(system);
    const auto n = static_cast<std::size_t>(flat.size());
    using D = Dual<double, 1>;
    for (const double t : {0.0, 0.37, 2.9}) {
      std::vector<double> y(3 * n), d(3 * n), expected(n);
      for (std::size_t i = 0; i < 3 * n; ++i) y[i] = std::sin(3.0 + 2.0 * double(i) + t);
      flat.with_tangents(t, y.data(), d.data(), 2);
      system.flow<double>(system.omega * t, {y.data(), n}, expected);
      for (std::size_t i = 0; i < n; ++i) CHECK(d[i] == Approx(expected[i]).epsilon(1e-12).margin(1e-13));
      for (std::size_t m = 1; m <= 2; ++m) {
        std::vector<D> z(n), slope(n);
        for (std::size_t i = 0; i < n; ++i) {
          z[i] = D(y[i]);
          z[i].d[0] = y[m * n + i];
        }
        system.flow<D>(system.omega * t, z, slope);
        for (std::size_t i = 0; i < n; ++i) CHECK(d[m * n + i] == Approx(slope[i].d[0]).epsilon(1e-12).margin(1e-13));
      }
    }
  }
}

TEST_CASE("the fast integrator agrees with CVODE on the stay to 1e-9") {
  for (const Terms terms : {Terms::reduced, Terms::full})
    for (const double omega : {1.22, 1.65, 2.15}) {
      const auto system = stay(omega, terms);
      const Vector start = point({3.0, 1.0, 0.5, -2.0});
      Stroboscope strobe(system, {.relative_tolerance = 1e-13, .absolute_tolerance = 1e-14});
      Integrator cvode([&](double t, std::span<const double> y, std::span<double> d) { system.flow<double>(system.omega * t, y, d); }, 0.0, start,
                       {.relative_tolerance = 1e-13, .absolute_tolerance = 1e-14});
      Vector y = start;
      for (int k = 1; k <= 5; ++k) {
        REQUIRE(strobe.map(y));
        REQUIRE(cvode.advance(k * strobe.period()));
        CHECK((y - cvode.state()).norm() < 1e-9 * (1.0 + y.norm()));
      }
      // The default tolerances of ensembles hold what they say: a hundred times the tolerance per period.
      for (const double tolerance : {1e-7, 1e-8, 1e-9, 1e-10}) {
        Stroboscope coarse(system, {.relative_tolerance = tolerance, .absolute_tolerance = 0.01 * tolerance});
        Vector z = start, exact = start;
        for (int k = 0; k < 5; ++k) {
          REQUIRE(coarse.map(z));
          REQUIRE(strobe.map(exact));
          CHECK((z - exact).norm() < 100.0 * tolerance * (1.0 + exact.norm()));
          exact = z;
        }
      }
    }
}

TEST_CASE("three coordinates: states of any size") {
  ModalSystem<double> s;  // a chain with a cubic end, forced at the other
  s.omega = 1.3;
  s.damping = {0.1, 0.15, 0.2};
  s.stiffness = {2.0, 2.0, 1.0};
  for (int i = 0; i < 3; ++i)
    for (int j : {i - 1, i + 1})
      if (j >= 0 && j < 3) s.add_term(i, -0.5, {j});
  s.add_term(2, 0.8, {2, 2, 2});
  s.add_force(0, 1.5, 1);
  const Vector start = point({1, -1, 0.5, 0.2, 0, -0.7});
  Stroboscope strobe(s, {.relative_tolerance = 1e-12, .absolute_tolerance = 1e-13});
  Integrator cvode([&](double t, std::span<const double> y, std::span<double> d) { s.flow<double>(s.omega * t, y, d); }, 0.0, start,
                   {.relative_tolerance = 1e-12, .absolute_tolerance = 1e-13});
  Vector y = start;
  Matrix m;
  REQUIRE((strobe.map(y, m, 2) && cvode.advance(2.0 * strobe.period())));
  CHECK((y - cvode.state()).norm() < 1e-9);
  CHECK(m.determinant() == Approx(std::exp(-0.45 * 2.0 * strobe.period())).epsilon(1e-8));
  CHECK(settled(s, start, MotionKind::periodic).multiple == 1);
}

TEST_CASE("the monodromy matrix of the variational equations is the difference quotient's, its determinant Liouville's") {
  const auto system = stay(1.65);
  Stroboscope strobe(system, {.relative_tolerance = 1e-12, .absolute_tolerance = 1e-13});
  const Vector start = point({1.0, -0.4, 0.3, 2.0});
  Vector y = start;
  Matrix m;
  REQUIRE(strobe.map(y, m, 2));
  for (int i = 0; i < 4; ++i) {
    const double h = 1e-5;
    Vector a = start, b = start;
    a[i] += h;
    b[i] -= h;
    REQUIRE((strobe.map(a, 2) && strobe.map(b, 2)));
    CHECK(((a - b) / (2.0 * h) - m.col(i)).norm() < 1e-6 * (1.0 + m.norm()));  // h^2 and 1e-12/h
  }
  CHECK(m.determinant() == Approx(std::exp(-(system.damping[0] + system.damping[1]) * 2.0 * strobe.period())).epsilon(1e-9));
}

TEST_CASE("a damped linear oscillator settles on its only motion, with the exponent of its damping") {
  const double c = 0.1, k = 2.0, F = 1.5, omega = 1.1;
  const Attractor a = settled(duffing(c, k, 0.0, F, omega), point({5.0, -3.0}), MotionKind::periodic);
  const std::complex<double> Q = F / std::complex<double>(k - omega * omega, c * omega);
  CHECK(a.multiple == 1);
  CHECK(a.points(0, 0) == Approx(Q.real()).epsilon(1e-9));
  CHECK(a.points(1, 0) == Approx(-omega * Q.imag()).epsilon(1e-9));
  CHECK(a.lyapunov == Approx(-0.5 * c).epsilon(1e-8));
  AttractorFinder finder(duffing(c, k, 0.0, F, omega));
  const SteadyMotion m = finder.motion(a, 64, 4);
  // The harmonic counts phase from the recorded start, omega t = 0.
  CHECK(std::abs(m.harmonic(0, 1.0) - Q) < 1e-9);
  CHECK(std::abs(m.harmonic(0, 2.0)) < 1e-9);
}

TEST_CASE("subharmonic of order three: the exact motion of x'' + x^3 = F cos(3 w t) and its neighbour with damping") {
  // x = A cos(w t), w^2 = 3 A^2/4, F = A^3/4. Damping shifts it; the motion stays of period three with the third of the frequency.
  const double A = 2.0, w = std::sqrt(0.75) * A;
  const auto undamped = duffing(0.0, 0.0, 1.0, 0.25 * A * A * A, 3.0 * w);
  AttractorFinder exact(undamped);
  const auto found = exact.refine(point({A + 1e-3, 1e-3}), 3);
  REQUIRE(found);
  CHECK(found->multiple == 3);
  CHECK(found->points(0, 0) == Approx(A).epsilon(1e-8));
  CHECK(std::abs(found->multipliers[0]) == Approx(1.0).epsilon(1e-6));  // a centre or a saddle of an undamped system: product one
  const Attractor a = settled(duffing(0.02, 0.0, 1.0, 0.25 * A * A * A, 3.0 * w), point({A, 0.0}), MotionKind::periodic);
  CHECK(a.multiple == 3);
  AttractorFinder finder(duffing(0.02, 0.0, 1.0, 0.25 * A * A * A, 3.0 * w));
  const SteadyMotion m = finder.motion(a, 64, 3);
  CHECK(std::abs(m.harmonic(0, 1.0 / 3.0)) == Approx(A).epsilon(0.02));
  CHECK((m.harmonic(0, 1.0 / 3.0) - std::conj(m.harmonic(0, -1.0 / 3.0))).real() == Approx(0.0).epsilon(0).margin(1e-12));
}

TEST_CASE("the stay at 1.65 rad/s: integrated harmonics of the whirling motion, both mirror images", "[published]") {
  AttractorSet set(whirling());
  AttractorFinder finder(stay(1.65));
  for (const auto& start : {point({3, 0, 0, 0}), point({-3, 0, 0, 0}), point({10, 10, 0, 0}), point({0.01, 0, 0, 0})}) {
    const Settled s = finder.settle(start, set);
    REQUIRE(s.kind == MotionKind::periodic);
    if (s.fresh) set.add(*s.fresh, s.capture);
  }
  REQUIRE(set.size() == 2);
  CHECK(set[0].mirror_of == 1);
  CHECK(set[1].mirror_of == 0);
  CHECK(set[1].mirror == "WH");
  CHECK(same_motion(set[1], reflected(set[0], whirling()[0].signs)));
  const SteadyMotion m = finder.motion(set[0], 128, 1);
  const double q1[] = {0.10, 0.756, 2.059, 0.437}, q2[] = {0.33, 1.567, 2.459, 0.511};
  for (int k = 0; k < 4; ++k) {
    CHECK(std::abs(m.harmonic(0, k)) == Approx(q1[k]).epsilon(0).margin(k == 0 ? 0.005 : 0.0006));  // quoted to so many digits
    CHECK(std::abs(m.harmonic(1, k)) == Approx(q2[k]).epsilon(0).margin(k == 0 ? 0.005 : 0.0006));
  }
  const SteadyMotion by_cvode = settle(stay(1.65), point({3, 0, 0, 0}));
  CHECK(by_cvode.kind == MotionKind::periodic);
  CHECK(std::abs(by_cvode.harmonic(1, 2.0)) == Approx(std::abs(m.harmonic(1, 2.0))).epsilon(1e-8));
}

TEST_CASE("period two out of plane and in plane, the low motion is unstable between 1.998 and 2.182 rad/s", "[published]") {
  AttractorFinder finder(stay(2.15));
  const Settled coupled = finder.settle(point({3, 0, 0, 0}), AttractorSet()), planar = finder.settle(point({10, 10, 0, 0}), AttractorSet());
  REQUIRE((coupled.fresh && planar.fresh));
  CHECK(coupled.fresh->multiple == 2);
  CHECK(planar.fresh->multiple == 2);
  CHECK(coupled.fresh->points.row(0).cwiseAbs().maxCoeff() > 0.1);
  CHECK(planar.fresh->points.row(0).cwiseAbs().maxCoeff() < 1e-8);
  AttractorSet set(whirling());
  set.add(*coupled.fresh, coupled.capture);
  set.add(*planar.fresh, planar.capture);
  REQUIRE(set.size() == 2);  // each is its own mirror image: the coupled one half a period later
  CHECK(set[0].symmetries == std::vector<std::string>{"WH"});
  const auto stability = [](double omega) {
    AttractorFinder f(stay(omega));
    const auto low = f.refine(point({0, -1.39, 0, 0}), 1);
    REQUIRE(low);
    return std::abs(low->multipliers[0]);
  };
  CHECK(stability(1.9983) < 1.0);
  CHECK(stability(1.9984) > 1.0);  // period doubling out of plane at 1.99835488392
  CHECK(stability(2.1815) > 1.0);
  CHECK(stability(2.1817) < 1.0);  // in plane at 2.18158882051
}

TEST_CASE("quasi-periodic motion beyond the torus points of the whirling branch", "[published]") {
  const Vector first = point({-1.89449484911, -1.77214160921, -12.3486747475, 6.20250461}),
               second = point({-2.81099341538, 0.844586984572, -9.9956226644, 8.44267645207});
  // Torus points 1.74827864899 and 1.82943396851 rad/s; the angles of their multipliers from the published real and imaginary parts.
  struct Case {
    Vector start;
    double periodic, torus, angle;
  };
  for (const Case& c : {Case{first, 1.74823, 1.748282, std::atan2(0.278892293401, 0.960322387889)},
                        Case{second, 1.8295, 1.82943, std::atan2(0.223082896904, 0.974799477384)}}) {
    CHECK(settled(stay(c.periodic), c.start, MotionKind::periodic).multiple == 1);
    const Attractor a = settled(stay(c.torus), c.start, MotionKind::quasi_periodic);
    CHECK(a.second_frequency == Approx(c.angle / (2.0 * std::numbers::pi)).epsilon(0.02));  // beyond the point it drifts
    CHECK(std::abs(a.lyapunov) < a.lyapunov_error);
  }
}

TEST_CASE("Ueda's attractor is chaotic with the published exponent", "[published][slow]") {
  // x'' + 0.05 x' + x^3 = 7.5 cos t: 0.1034 in [Sprott2003]. Another published run has 0.0999, which longer runs do not confirm.
  const auto ueda = duffing(0.05, 0.0, 1.0, 7.5, 1.0);
  const Attractor a = settled(ueda, point({2.5, 0.0}), MotionKind::chaotic);
  CHECK(a.lyapunov == Approx(0.1034).epsilon(0).margin(3.0 * a.lyapunov_error));
  Stroboscope strobe(ueda, {.relative_tolerance = 1e-9, .absolute_tolerance = 1e-10});
  Vector y = point({2.5, 0.0});
  const LyapunovResult r = largest_lyapunov(strobe, y, {.periods = 12000, .skip = 200});
  REQUIRE(r.ok);
  CHECK(r.error < 0.003);
  CHECK(r.exponent == Approx(0.1034).epsilon(0).margin(2.0 * r.error));
  AttractorSet set;
  const int first = set.add(a, Capture(a));
  const Attractor again = settled(ueda, point({-1.0, 3.0}), MotionKind::chaotic);
  CHECK(set.find(again) == first);  // one attractor, not one per start
}

TEST_CASE("a motion that grows without bound is diverging, misuse throws") {
  const auto soft = duffing(0.05, 1.0, -1.0, 0.1, 0.5);
  AttractorFinder finder(soft);
  CHECK(finder.settle(point({5.0, 0.0}), AttractorSet()).kind == MotionKind::diverging);
  CHECK(finder.settle(point({0.1, 0.0}), AttractorSet()).kind == MotionKind::periodic);
  CHECK_THROWS_AS(finder.settle(point({1.0}), AttractorSet()), std::invalid_argument);
  AttractorOptions bad;
  bad.max_periods = 0;
  CHECK_THROWS_AS(AttractorFinder(soft, bad), std::invalid_argument);
}

TEST_CASE("settle: a motion that decays more slowly than it is given time is told with its rate, not called quasi-periodic") {
  const auto oscillator = [](double c) {
    ModalSystem<double> s;
    s.omega = 1.0;
    s.damping = {c};
    s.stiffness = {2.0};
    s.add_force(0, 1.0, 1);
    return s;
  };
  const SettleOptions o{.max_periods = 400, .samples = 16, .record_periods = 8, .lyapunov_periods = 64};
  const double c = 3e-4;  // over the periods given the free part falls by a third
  const SteadyMotion decaying = settle(oscillator(c), point({2.0, 0.0}), o);
  CHECK(decaying.kind == MotionKind::unsettled);
  // The largest of 50 distances at either end, between which the beat leaves 1 %; the decay between them is 14 %.
  CHECK(decaying.decay_rate == Approx(0.5 * c).epsilon(0.1));
  CHECK(decaying.why.find("still decaying after 400 periods") == 0);
  const SteadyMotion growing = settle(oscillator(-c), point({2.0, 0.0}), o);
  CHECK(growing.kind == MotionKind::unsettled);
  CHECK(growing.decay_rate == Approx(-0.5 * c).epsilon(0.1));
  CHECK(growing.why.find("still growing") == 0);
  // Without damping the free part lasts: two frequencies for ever.
  const SteadyMotion lasting = settle(oscillator(0.0), point({2.0, 0.0}), o);
  CHECK(lasting.kind == MotionKind::quasi_periodic);
  CHECK(lasting.why.empty());
  CHECK(lasting.decay_rate == 0.0);
  // With more time the slow one settles.
  CHECK(settle(oscillator(0.05), point({2.0, 0.0}), o).kind == MotionKind::periodic);
}

TEST_CASE("settle: between the torus points of the 1:2 pair the motion lasts without a period") {
  ModalSystem<double> s;
  s.omega = 0.99;
  s.damping = {0.005, 0.01};
  s.stiffness = {1.0, 4.0};
  s.add_term(0, 1.0, {0, 1});
  s.add_term(1, 1.0, {0, 0});
  s.add_force(0, 0.01, 1);
  const SteadyMotion m = settle(s, point({0.1, 0.0, 0.0, 0.0}), {.max_periods = 2000, .samples = 16, .record_periods = 8});
  INFO(m.why);
  CHECK(m.kind == MotionKind::quasi_periodic);
}
