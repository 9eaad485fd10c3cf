// Frequencies and modes of hanging cables against tables computed apart from this program, and against the core system integrated step by step.
#include <boost/numeric/odeint.hpp>
#include <cmath>

#include "models/statics.hpp"
#include "tests/models/catenary/reference.hpp"

using namespace catenary_test;
using whirl::models::pi;
using whirl::models::symmetric_root;

namespace {

constexpr ModeOptions eight{.count = 8};

void check_row(const ModeSet& set, const Table& t, std::size_t row, double tolerance) {
  REQUIRE(set.modes.size() == 8);
  CHECK(set.complete());
  for (int k = 0; k < 8; ++k) CHECK(set.modes[std::size_t(k)].omega == Approx(t(row, "w" + std::to_string(k + 1))).epsilon(tolerance));
}

// Conjugate points of the core system at frequency w, [Gale1976, eqs (2.33), (2.34)]: how often U = V = 0 returns on the way from x1 to x2. By
// Morse's index theorem that is the number of natural frequencies below w.
int conjugate_points(const CoreCable& cable, double w) {
  using State = std::array<double, 8>;  // U, V, N, T of two motions
  State y{0, 0, 1, 0, 0, 0, 0, 1};
  const auto flow = [&](const State& s, State& d, double x) {
    const double c = std::cosh(x);
    for (std::size_t i = 0; i < 8; i += 4) {
      d[i] = s[i + 1] / c + cable.kappa * c * s[i + 3];
      d[i + 1] = s[i + 2] - s[i] / c;
      d[i + 2] = -w * w * c * s[i + 1] - s[i + 3] / c;
      d[i + 3] = -w * w * c * s[i] + s[i + 2] / c;
    }
  };
  boost::numeric::odeint::runge_kutta_fehlberg78<State> step;
  const int steps = 4000;
  const double h = (cable.x2 - cable.x1) / steps;
  int sign = 0, changes = 0;
  for (int i = 0; i < steps; ++i) {
    step.do_step(flow, y, cable.x1 + i * h, h);
    const double area = y[0] * y[5] - y[1] * y[4];
    const int now = area > 0.0 ? 1 : -1;
    if (sign != 0 && now != sign) ++changes;
    sign = now;
  }
  return changes;
}

}  // namespace

TEST_CASE("catenary modes: Table B-3 corrected, in plane, inextensible", "[published]") {
  const Table t = table("B3_verified");
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    INFO("h/b " << t(i, "h_over_b") << " sag " << t(i, "sag"));
    const Geometry g = by_sag(t(i, "sag"), t(i, "h_over_b"));
    CHECK(xi_of(g.x1) == Approx(t(i, "xi1")).epsilon(0).margin(0.51e-8));  // 8 decimals given
    CHECK(xi_of(g.x2) == Approx(t(i, "xi2")).epsilon(0).margin(0.51e-8));
    CHECK(g.length / g.span == Approx(t(i, "l_over_b")).epsilon(0).margin(0.51e-8));
    check_row(in_plane_modes(core(g), eight), t, i, 1e-10);
  }
}

TEST_CASE("catenary modes: Tables B-4 and B-5 corrected, out of plane", "[published]") {
  const Table t = table("B4_verified");
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    INFO("h/b " << t(i, "h_over_b") << " sag " << t(i, "sag"));
    check_row(out_of_plane_modes(core(by_sag(t(i, "sag"), t(i, "h_over_b"))), eight), t, i, 1e-10);
  }
  const Table b5 = table("B5_verified");
  for (std::size_t i = 0; i < b5.rows.size(); ++i) {
    const Geometry g = by_sag(b5(i, "sag"), b5(i, "h_over_b"));
    CHECK(out_of_plane_modes(core(g), {.count = 1}).modes[0].omega == Approx(b5(i, "exact_true")).epsilon(1e-10));
    CHECK(pendulum_estimate(g) == Approx(b5(i, "rayleigh_true")).epsilon(1e-10));
  }
}

TEST_CASE("catenary modes: the rigid pendulum about the chord bounds the first frequency out of plane") {
  for (const double h : {0.0, 0.5, 2.0})
    for (const double sag : {0.95, 0.8, 0.6}) {
      const Geometry g = by_sag(sag, h);
      const double exact = out_of_plane_modes(core(g), {.count = 1}).modes[0].omega, estimate = pendulum_estimate(g);
      CHECK(estimate > exact);  // Rayleigh: an upper bound; without b / sqrt(b^2 + h^2) it is half as much again at h = 2 b
      CHECK(estimate < 1.06 * exact);
    }
}

TEST_CASE("catenary modes: elastic cables", "[published]") {
  const Table t = table("ext_undamped");
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    const double kappa = t(i, "kappa");
    INFO("h/b " << t(i, "h_over_b") << " b/2a " << t(i, "b_over_2a") << " kappa " << kappa);
    const Geometry g = unit_geometry(t(i, "b_over_2a"), t(i, "h_over_b"));
    CHECK(irvine_lambda2(g, kappa) == Approx(t(i, "lambda2_irvine")).epsilon(0).margin(0.51e-8));
    const ModeSet set = in_plane_modes(core(g, kappa), eight);
    check_row(set, t, i, 1e-10);
    if (t(i, "h_over_b") == 0.0)
      for (int k = 0; k < 8; ++k)
        CHECK(set.modes[std::size_t(k)].odd_share == Approx(t(i, "asymfrac" + std::to_string(k + 1))).epsilon(0).margin(1e-9));
  }
}

TEST_CASE("catenary modes: no digit is lost as the cable becomes inextensible") {
  const Geometry g = unit_geometry(1.0, 0.5);
  const ModeSet stiff = in_plane_modes(core(g), eight);
  const auto slope = [&](double kappa) {
    std::vector<double> s;
    const ModeSet set = in_plane_modes(core(g, kappa), eight);
    for (std::size_t k = 0; k < 8; ++k) s.push_back((stiff.modes[k].omega - set.modes[k].omega) / kappa);
    return s;
  };
  // Frequencies fall in proportion to kappa: the slopes at 1e-6 and 1e-8 agree to their curvature (1e-6) and to rounding over kappa (1e-14/1e-8).
  const auto a = slope(1e-6), b = slope(1e-8);
  for (std::size_t k = 0; k < 8; ++k) CHECK(a[k] == Approx(b[k]).epsilon(2e-3));
  for (std::size_t k = 0; k < 8; ++k) CHECK(slope(1e-13)[k] * 1e-13 < 1e-11);
}

TEST_CASE("catenary modes: damped") {
  const Table t = table("damped");
  DampedSet set;
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    const auto mode = static_cast<std::size_t>(t(i, "mode")) - 1;
    const Geometry g = unit_geometry(t(i, "b_over_2a"), t(i, "h_over_b"));
    CoreCable c = core(g, t(i, "kappa"));
    c.eta1 = t(i, "eta1");
    c.eta2 = t(i, "eta2");
    if (mode == 0) set = damped_modes(c, eight);
    INFO("row " << i);
    REQUIRE(set.modes.size() == 8);
    CHECK(set.resolved);
    const auto lambda = set.modes[mode].lambda;
    CHECK(std::abs(lambda - std::complex<double>(t(i, "Re_lambda"), t(i, "Im_lambda"))) < 1e-10 * std::abs(lambda));
  }
  // Equal drag shifts every root by -eta/2 alone.
  const Geometry g = unit_geometry(0.8, 0.3);
  CoreCable c = core(g, 1e-3);
  const ModeSet free = in_plane_modes(c, eight);
  c.eta1 = c.eta2 = 0.4;
  const DampedSet damped = damped_modes(c, eight);
  for (std::size_t k = 0; k < 8; ++k) CHECK(std::abs(damped.modes[k].lambda - damped_root(free.modes[k].omega, 0.4)) < 1e-11);
  c.eta1 = c.eta2 = 2.1 * free.modes[0].omega;  // the first mode no longer oscillates
  const DampedSet slow = damped_modes(c, {.count = 4});
  CHECK(slow.overdamped.size() == 2);
  CHECK(slow.overdamped[0] == Approx(damped_root(free.modes[0].omega, c.eta1).real()).epsilon(1e-9));
  CHECK(slow.modes[0].lambda.imag() == Approx(damped_root(free.modes[1].omega, c.eta1).imag()).epsilon(1e-10));
}

TEST_CASE("catenary modes: with much drag the lowest frequencies are those of short waves") {
  const Geometry g = unit_geometry(0.8, 0.3);
  for (const double kappa : {0.0, 1e-3}) {
    CoreCable c = core(g, kappa);
    const ModeSet free = in_plane_modes(c, {.count = 44});
    c.eta1 = c.eta2 = free.modes[34].omega + free.modes[35].omega;  // the first 35 do not oscillate
    const DampedSet set = damped_modes(c, {.count = 6});
    REQUIRE(set.resolved);
    REQUIRE(set.modes.size() == 6);
    for (std::size_t k = 0; k < 6; ++k) {
      const auto lambda = damped_root(free.modes[35 + k].omega, c.eta1);
      CHECK(std::abs(set.modes[k].lambda - lambda) < 1e-9 * std::abs(lambda));
    }
    CHECK(set.overdamped.size() >= 35);
    CHECK(set.overdamped[0] == Approx(damped_root(free.modes[0].omega, c.eta1).real()).epsilon(1e-9));
  }
  CoreCable c = core(g);
  c.eta2 = 1e12;  // no discretisation follows these waves: none is listed, and that is said
  const DampedSet none = damped_modes(c, {.count = 4});
  CHECK_FALSE(none.resolved);
  CHECK(none.modes.empty());
}

TEST_CASE("catenary modes: a mode and what drag makes of it") {
  // Drag across the cable damps the fourth mode, which it brings below the third: that is a longitudinal wave and feels nothing of it.
  const Geometry g = unit_geometry(0.05, 0.0);
  CoreCable c = core(g, 0.1134);
  const ModeSet free = in_plane_modes(c, {.count = 4});
  c.eta2 = 30.0;
  const DampedSet damped = damped_modes(c, {.count = 4});
  REQUIRE(free.modes[2].elastic_share > 0.9);
  REQUIRE(free.modes[3].elastic_share < 0.1);
  CHECK(partners(free.modes, damped.modes) == std::vector<int>{0, 1, 3, 2});
  CHECK(-damped.modes[3].lambda.real() < 0.1);
  CHECK(-damped.modes[2].lambda.real() > 10.0);
  CHECK(partners(free.modes, {}) == std::vector<int>(4, -1));
}

TEST_CASE("catenary modes: a mode satisfies the core system") {
  for (const double kappa : {0.0, 1e-6, 3e-3}) {
    const Geometry g = unit_geometry(1.2, 0.7);
    const ModeSet set = in_plane_modes(core(g, kappa), {.count = 6});
    for (const Mode& mode : set.modes) {
      const auto& f = mode.field;
      const double d = 1e-3, L = -mode.omega * mode.omega;
      for (double x = g.x1 + 0.11; x < g.x2 - 0.11; x += 0.37) {
        const auto slope = [&](Quantity k) {  // sixth order: d^6 times the seventh derivative, w^7 at most
          const auto at = [&](double s) { return f.at(x + s, k); };
          return (45.0 * (at(d) - at(-d)) - 9.0 * (at(2 * d) - at(-2 * d)) + at(3 * d) - at(-3 * d)) / (60.0 * d);
        };
        const double c = std::cosh(x), U = f.at(x, Quantity::U), V = f.at(x, Quantity::V), N = f.at(x, Quantity::N), T = f.at(x, Quantity::T);
        const double scale = mode.omega * mode.omega * std::cosh(g.x2);
        CHECK(slope(Quantity::U) == Approx(V / c + kappa * c * T).epsilon(0).margin(1e-9));
        CHECK(slope(Quantity::V) == Approx(N - U / c).epsilon(0).margin(1e-8));
        CHECK(slope(Quantity::N) == Approx(L * c * V - T / c).epsilon(0).margin(1e-8 * scale));
        CHECK(slope(Quantity::T) == Approx(L * c * U + N / c).epsilon(0).margin(1e-8 * scale));
      }
      for (const double x : {g.x1, g.x2}) CHECK(std::hypot(f.at(x, Quantity::U), f.at(x, Quantity::V)) < 1e-10);
    }
  }
}

TEST_CASE("catenary modes: none is missing, counted by conjugate points of the core system") {
  for (const auto& [m, h, kappa] : {std::tuple{0.3, 0.0, 0.0}, {1.0, 0.5, 0.0}, {1.0, 0.5, 2e-3}, {2.0, 0.3, 1e-4}, {0.05, 0.0, 1e-3}}) {
    const Geometry g = unit_geometry(m, h);
    const ModeSet set = in_plane_modes(core(g, kappa), {.count = 20});
    for (const std::size_t k : {0, 3, 7, 18}) {
      INFO("m " << m << " h " << h << " kappa " << kappa << " mode " << k);
      CHECK(conjugate_points(core(g, kappa), set.modes[k].omega * (1.0 - 1e-6)) == int(k));
      CHECK(conjugate_points(core(g, kappa), set.modes[k].omega * (1.0 + 1e-6)) == int(k) + 1);
    }
  }
}

TEST_CASE("catenary modes: deep cables, counted by conjugate points too") {
  for (const auto& [m, h, kappa] : {std::tuple{5.0, 0.3, 0.0}, {5.0, 0.0, 1e-3}, {6.5, 1.0, 1e-4}}) {
    const Geometry g = unit_geometry(m, h);
    const ModeSet set = in_plane_modes(core(g, kappa), {.count = 8});
    CHECK(set.complete());
    CHECK(set.functions < 90);  // polynomials in x itself: over 100
    for (const std::size_t k : {0, 3, 7}) {
      INFO("m " << m << " h " << h << " kappa " << kappa << " mode " << k);
      CHECK(conjugate_points(core(g, kappa), set.modes[k].omega * (1.0 - 1e-6)) == int(k));
      CHECK(conjugate_points(core(g, kappa), set.modes[k].omega * (1.0 + 1e-6)) == int(k) + 1);
    }
  }
}

TEST_CASE("catenary modes: the largest displacement is 1 on the continuous cable") {
  for (const auto& [m, h, kappa] : {std::tuple{0.05, 0.0, 0.0}, {1.0, 0.5, 1e-3}, {3.0, 0.2, 0.0}}) {
    const CoreCable cable = core(unit_geometry(m, h), kappa);
    const Vector x = Vector::LinSpaced(20001, cable.x1, cable.x2);
    for (const Mode& mode : in_plane_modes(cable, {.count = 12}).modes)
      CHECK((mode.field.at(x, Quantity::U).cwiseAbs2() + mode.field.at(x, Quantity::V).cwiseAbs2()).maxCoeff() == Approx(1.0).epsilon(2e-6));
    for (const Mode& mode : out_of_plane_modes(cable, {.count = 12}).modes)
      CHECK(mode.field.at(x, Quantity::W).cwiseAbs().maxCoeff() == Approx(1.0).epsilon(2e-6));  // sampled: waves / 20001
  }
}

TEST_CASE("catenary modes: a hundred, none missed", "[slow]") {
  for (const double kappa : {0.0, 1e-3}) {
    const Geometry g = unit_geometry(1.0, 0.5);
    const ModeSet set = in_plane_modes(core(g, kappa), {.count = 100});
    REQUIRE(set.modes.size() == 100);
    CHECK(set.complete());
    CHECK(conjugate_points(core(g, kappa), set.modes[99].omega * (1.0 - 1e-7)) == 99);
    CHECK(conjugate_points(core(g, kappa), set.modes[99].omega * (1.0 + 1e-7)) == 100);
    const ModeSet lateral = out_of_plane_modes(core(g), {.count = 100});
    CHECK(lateral.complete());
  }
}

TEST_CASE("catenary modes: too few functions are not called complete") {
  const ModeSet set = in_plane_modes(core(unit_geometry(1.0, 0.5)), {.count = 20, .functions = 22});
  CHECK_FALSE(set.resolved);
  CHECK_FALSE(set.complete());
  CHECK_THROWS_AS(in_plane_modes({.x1 = 1.0, .x2 = 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(in_plane_modes({.x1 = 0.0, .x2 = 1.0, .kappa = -1.0}), std::invalid_argument);
  CHECK_THROWS_AS(in_plane_modes({.x1 = 0.0, .x2 = 1.0}, {.count = 0}), std::invalid_argument);
}

TEST_CASE("catenary modes: shallow limit, Irvine's frequency equation", "[published]") {
  const Table t = table("shallow_limit_vs_eq19");
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    const double m = t(i, "b_over_2a");
    const std::string& label = t.text(i, "lambda2");  // "100" or "4pi^2"
    const double lambda2 = std::stod(label) * (label.ends_with("pi^2") ? pi * pi : 1.0);
    const Geometry g = unit_geometry(m, 0.0);
    const double kappa = irvine_lambda2(g, 1.0) / lambda2;
    CHECK(kappa == Approx(t(i, "kappa")).epsilon(1e-9));  // 10 digits given
    const ModeSet set = in_plane_modes(core(g, kappa), {.count = 24});
    std::vector<double> symmetric, antisymmetric;
    for (const Mode& mode : set.modes) (mode.odd_share < 0.5 ? symmetric : antisymmetric).push_back(2.0 * m * mode.omega);
    INFO("row " << i);
    const auto s = std::size_t(t(i, "sym_mode")) - 1, a = std::size_t(t(i, "antisym_mode")) - 1;
    CHECK(symmetric.at(s) == Approx(t(i, "beta_l_full")).epsilon(1e-10));
    CHECK(antisymmetric.at(a) == Approx(t(i, "beta_l_full_anti")).epsilon(1e-10));
    // Irvine's root is the limit with an error of order (b/a)^2, at most a twentieth of it.
    CHECK(std::abs(symmetric.at(0) / symmetric_root(lambda2) - 1.0) < 0.05 * 4.0 * m * m);
  }
}
