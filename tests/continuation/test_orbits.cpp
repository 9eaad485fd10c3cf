// Exact periodic motions of the Oresund stay (nk-reduced, exact coefficients, U = 0.5 m): all special points found by the walker at default settings.
// Reference: AUTO-07p and an extended Newton on the Poincare map, agreeing to 1e-9 .. 1e-11.
#include <catch2/catch.hpp>
#include <numbers>

#include "continuation/orbit_network.hpp"
#include "continuation/torus.hpp"
#include "continuation/two_parameter.hpp"
#include "core/kinsol.hpp"
#include "models/harmonic_balance.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::models;

namespace {

struct Expected {
  std::string branch, type, subtype;
  double omega;
  int before, after;
};

OrbitNetwork whole(const HarmonicBalance& hb, double lower, double upper, int doublings) {
  OrbitNetwork net(hb, {.walk = {.lower = lower, .upper = upper}, .depth = 2}, doublings);
  net.set_namer([](const Branch& b, int level) { return std::string(level == 0 ? "" : "D") + (b.active_reflections.empty() ? "W" : "IP"); });
  const NewtonResult start = line_search_solve(hb, hb.linear_response(Vector::Constant(1, lower)));
  REQUIRE(start.ok());
  net.add_seed(start.x, "start");
  net.switch_branches();
  return net;
}

void compare(const Network& net, const std::vector<Expected>& expected) {
  std::size_t next = 0;
  for (const auto& b : net.branches())
    for (const auto& s : b.special) {
      INFO(b.name << " " << to_string(s.type) << s.subtype << " at " << s.u[s.u.size() - 1]);
      REQUIRE(next < expected.size());
      const Expected& e = expected[next++];
      CHECK(b.name == e.branch);
      CHECK(to_string(s.type) == e.type);
      CHECK(s.subtype == e.subtype);
      CHECK(s.u[s.u.size() - 1] == Approx(e.omega).epsilon(0).margin(6e-11));  // the last digit of the references
      CHECK(s.unstable_before == e.before);
      CHECK(s.unstable_after == e.after);
      CHECK(s.residual < 1e-12);
      CHECK(s.bracket[0] <= s.u[s.u.size() - 1]);
      CHECK(s.bracket[1] >= s.u[s.u.size() - 1]);
    }
  CHECK(next == expected.size());
}

}  // namespace

TEST_CASE("orbits: every special point of the Oresund stay's exact motions, doubled ones included", "[published][slow]") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 20});
  const OrbitNetwork net = whole(hb, 1.05, 2.4, 1);
  compare(net.network(0), {{"IP1", "LP", "", 1.15867469377, 0, 1},
                           {"IP1", "LP", "", 1.11215361987, 1, 0},
                           {"IP1", "BP", "WH", 1.58096018215, 0, 1},
                           {"IP1", "BP", "WH", 1.76702117141, 1, 0},
                           {"IP1", "LP", "", 1.98244040998, 0, 1},
                           {"IP1", "LP", "", 1.70366257099, 1, 0},
                           {"IP1", "PD", "", 1.99835488392, 0, 1},
                           {"IP1", "PD", "", 2.0896029917, 1, 2},
                           {"IP1", "PD", "", 2.09239906453, 2, 1},
                           {"IP1", "PD", "", 2.18158882051, 1, 0},
                           {"W1", "LP", "", 1.82142291407, 0, 1},
                           {"W1", "LP", "", 1.74819639879, 1, 0},
                           {"W1", "TR", "", 1.74827864899, 0, 2},
                           {"W1", "TR", "", 1.82943396851, 2, 0},
                           {"W1", "LP", "", 1.82961925092, 0, 1},
                           {"W1", "BP", "WH", 1.76702117141, 1, 1}});  // arrives at the in-plane branch: counted on its own side
  // Period two: from the first doubling out of plane, from the first in plane, and the branch between them.
  compare(net.network(1), {{"DIP1", "BP", "SB", 2.20058902236, 0, 1},
                           {"DIP1", "LP", "", 2.35252829193, 1, 2},
                           {"DIP1", "BP", "PD", 2.09239906453, 2, 2},
                           {"DIP2", "BP", "WH", 2.09280869517, 1, 0},
                           {"DIP2", "LP", "", 2.37183171078, 0, 1},
                           {"DIP2", "BP", "PD", 2.18158882051, 1, 1},
                           {"DW1", "BP", "WH", 2.09280869517, 1, 1}});
  CHECK(net.network(1).branches()[0].born_at == "IP1:PD1");
  CHECK(net.network(1).branches()[1].born_at == "IP1:PD2");
  CHECK(net.network(1).branches()[2].born_at == "DIP1:BP1");
}

TEST_CASE("orbits: special points of the full coupling, each with its multiplier integrated", "[slow]") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 24}, Terms::full);
  const OrbitNetwork net = whole(hb, 1.05, 2.4, 0);
  compare(net.network(0), {{"IP1", "LP", "", 1.11978558563, 0, 1},
                           {"IP1", "LP", "", 1.11048571515, 1, 0},
                           {"IP1", "BP", "WH", 1.57654831708, 0, 1},
                           {"IP1", "BP", "WH", 1.72611194326, 1, 0},
                           {"IP1", "LP", "", 1.80515694788, 0, 1},
                           {"IP1", "LP", "", 1.67472790081, 1, 0},
                           {"IP1", "PD", "", 2.02671983324, 0, 1},
                           {"IP1", "PD", "", 2.11021117128, 1, 0},
                           {"IP1", "PD", "", 2.18212356118, 0, 1},
                           {"IP1", "PD", "", 2.23197839079, 1, 0},
                           {"W1", "LP", "", 1.72029046449, 0, 1},
                           {"W1", "LP", "", 1.69568613413, 1, 0},
                           {"W1", "TR", "", 1.69593259680, 0, 2},
                           {"W1", "TR", "", 1.75923079282, 2, 0},
                           {"W1", "LP", "", 1.75992834342, 0, 1},
                           {"W1", "BP", "WH", 1.72611194326, 1, 1}});
  for (const auto& b : net.network(0).branches())
    for (const auto& s : b.special) {
      INFO(to_string(s.type) << " at " << s.u[hb.size()]);
      const IntegratedPeriod period = monodromy_by_integration(hb.system_at(s.u), hb.state_at(s.u, 0.0), 1, 1e-12);
      REQUIRE(period.ok);
      const double angle = s.type == EventType::period_doubling ? std::numbers::pi : 2.0 * std::numbers::pi * s.frequency / s.u[hb.size()];
      double nearest = 1.0;
      for (const auto& mu : Eigen::VectorXcd(period.monodromy.eigenvalues())) nearest = std::min(nearest, std::abs(mu - std::polar(1.0, angle)));
      CHECK(nearest < 1e-6);  // at a fold a multiplier moves with the root of every error
    }
}

namespace {

// Distance of start and end of the motion carried by CVODE over `periods`, the signs applied at the end, and how far that map's derivative is from
// having the multiplier mu: unknowns (q, q', omega), as many equations.
Vector integrated_defect(const ParametricSystem& stay, const Vector& z, const Vector& signs, int periods, double mu) {
  const auto n = signs.size();
  ModalSystem<double> system;
  stay.at(std::span<const double>(&z[n], 1), system);
  const IntegratedPeriod run = monodromy_by_integration(system, z.head(n), periods);
  REQUIRE(run.ok);
  const Matrix derivative = signs.asDiagonal() * run.monodromy;
  Vector defect(n + 1);
  defect << signs.cwiseProduct(run.end) - z.head(n), (derivative - mu * Matrix::Identity(n, n)).determinant();
  return defect;
}

// Newton on the above with differences: nothing of harmonic balance, collocation or walker is in it.
Vector integrated_point(const ParametricSystem& stay, Vector z, const Vector& signs, int periods, double mu) {
  const auto m = z.size();
  for (int i = 0; i < 8; ++i) {
    const Vector r = integrated_defect(stay, z, signs, periods, mu);
    Matrix j(m, m);
    for (int k = 0; k < m; ++k) {
      const double h = 1e-5 * (1.0 + std::abs(z[k]));
      j.col(k) = (integrated_defect(stay, z + h * Vector::Unit(m, k), signs, periods, mu) - r) / h;
    }
    const Vector step = j.partialPivLu().solve(r);
    z -= step;
    if (step.norm() < 1e-10) break;
  }
  return z;
}

}  // namespace

TEST_CASE("orbits: special points of the full coupling's doubled branches, found again by integration alone", "[slow]") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 24}, Terms::full);
  const OrbitNetwork net = whole(hb, 1.05, 2.4, 1);
  compare(net.network(1), {{"DIP1", "BP", "SB", 2.21128023858, 0, 1},
                           {"DIP1", "LP", "", 2.32317588952, 1, 2},
                           {"DIP1", "BP", "SB", 2.16641846345, 2, 1},
                           {"DIP1", "BP", "PD", 2.11021117128, 1, 1},
                           {"DIP2", "LP", "", 2.17804875823, 1, 0},
                           {"DIP2", "LP", "", 2.31635178937, 0, 1},
                           {"DIP2", "LP", "", 2.22509666846, 1, 0},
                           {"DIP2", "BP", "PD", 2.23197839079, 0, 0},
                           {"DW1", "BP", "SB", 2.16641846345, 1, 1}});
  const ParametricSystem stay = stay_system(oresund(), {Lens("omega")}, Terms::full, Coefficients::exact);
  const auto& doubled = dynamic_cast<const HarmonicBalance&>(net.problem(1));
  const Vector same = Vector::Ones(4), mirrored = (Vector(4) << -1.0, 1.0, -1.0, 1.0).finished();
  for (const auto& b : net.network(1).branches())
    for (const auto& s : b.special) {
      const double omega = s.u[doubled.size()];
      INFO(b.name << " " << to_string(s.type) << s.subtype << " at " << omega);
      // Started beside the point: what the root owes to the balance is no more than which root it is.
      Vector z(5);
      z << doubled.state_at(s.u, 0.0).array() + 1e-5, omega + 1e-6;
      // One period takes a motion that is its own mirror image half of its period later to that image, there a doubling of the map: a simple root.
      // The end on the motion of one period is that one's doubling.
      if (s.subtype == "SB") z = integrated_point(stay, z, mirrored, 1, -1.0);
      else if (s.subtype == "PD") z = integrated_point(stay, z, same, 1, -1.0);
      else z = integrated_point(stay, z, same, 2, 1.0);
      CHECK(z[4] == Approx(omega).epsilon(0).margin(2e-11));  // CVODE at 1e-13 a step; the balance leaves 2e-12 at 24 harmonics
    }
}

TEST_CASE("orbits: two doublings 0.003 rad/s apart are told apart by their directions") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 12});
  Walker walker(hb, {.lower = 2.02, .upper = 2.15});  // steps of up to 0.005 rad/s
  const NewtonResult start = newton(hb, hb.linear_response(Vector::Constant(1, 2.15)));
  REQUIRE(start.ok());
  const Branch b = walker.walk(start.x);
  REQUIRE(b.special.size() == 2);
  CHECK(to_string(b.special[0].type) == std::string("PD"));
  CHECK(to_string(b.special[1].type) == std::string("PD"));
  CHECK(b.special[0].block == 0);  // in plane
  CHECK(b.special[1].block == 1);  // out of plane
  CHECK(b.special[0].u[hb.size()] == Approx(2.0896029917).epsilon(0).margin(1e-9));
  CHECK(b.special[1].u[hb.size()] == Approx(2.09239906453).epsilon(0).margin(1e-9));
}

TEST_CASE("orbits: the multipliers at a torus point stand on the unit circle at the angle of its frequency") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 20});
  const OrbitNetwork net = whole(hb, 1.5, 1.9, 0);
  int tori = 0;
  for (const auto& b : net.network(0).branches())
    for (const auto& s : b.special) {
      if (s.type != EventType::torus) continue;
      ++tori;
      const double angle = s.frequency * 2.0 * 3.14159265358979323846 / s.u[hb.size()];
      double nearest = 1.0;
      for (const auto& mu : hb.floquet(s.u).multipliers) nearest = std::min(nearest, std::abs(mu - std::polar(1.0, angle)));
      CHECK(nearest < 1e-8);  // Hill's exponents and the integrated multipliers, two ways to one number
    }
  CHECK(tori == 2);
}

TEST_CASE("orbits: Jacobian of the torus system against differences") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega"), Lens("support_motion.amplitude")}, {.harmonics = 4});
  const int n = hb.size();
  Vector u(n + 2);
  for (int i = 0; i < n; ++i) u[i] = 0.3 * std::sin(1.0 + 1.7 * i) / (1.0 + i % 9);
  u[n] = 1.8;
  u[n + 1] = 0.5;
  Indices all(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) all[static_cast<std::size_t>(i)] = i;
  const TorusSystem system(hb, all, all, u, 0.3);
  Vector y(system.size() + system.parameters());
  y << system.unknowns(u).head(n + 2), 0.5;
  y[n + 1] = 0.31;
  Matrix j(system.size(), y.size());
  system.jacobian(y, j);
  for (int c = 0; c < y.size(); ++c) {
    const double h = 1e-6;
    Vector up = y, down = y, ru(system.size()), rd(system.size());
    up[c] += h;
    down[c] -= h;
    system.residual(up, ru);
    system.residual(down, rd);
    CHECK((j.col(c) - (ru - rd) / (2.0 * h)).lpNorm<Eigen::Infinity>() <
          1e-6 * (1.0 + j.col(c).lpNorm<Eigen::Infinity>()));  // differences hold 7 digits
  }
}

TEST_CASE("orbits: thresholds in (omega, U) of whirling, folds and both period doublings", "[published][slow]") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 16});
  const HarmonicBalance hb2 = stay_harmonic_balance(oresund(), {Lens("omega"), Lens("support_motion.amplitude")}, {.harmonics = 16});
  const OrbitNetwork net = whole(hb, 1.2, 2.3, 0);
  TwoParameterOptions o;
  o.range1[0] = 1.2;
  o.range1[1] = 2.3;
  o.range2[0] = 0.1;
  o.range2[1] = 0.52;
  const auto least = [&](EventType type, double near) -> CodimensionTwo {
    for (const auto& s : net.network(0).branches()[0].special) {
      if (s.type != type || std::abs(s.u[hb.size()] - near) > 1e-3) continue;
      const DefiningCurve curve = follow(hb2, s, 0.5, o);
      CHECK(curve.type == type);
      for (const auto& z : curve.special)
        if (z.type == "MIN") return z;
    }
    return {};
  };
  // Quoted values come from a parabola through points of the curve (see below): they lie up to 2.2e-5 rad/s beside the minimum and so above it.
  struct Row {
    EventType type;
    double near, omega, U, quoted_omega, quoted_U, multiplier;
  };
  for (const Row& row : {Row{EventType::branch_point, 1.581, 1.6003560996, 0.318111203383, 1.6003780, 0.318111237, 1.0},
                         Row{EventType::fold, 1.9824, 1.6255230, 0.165257300, 1.6255230, 0.165257300, 1.0},
                         Row{EventType::period_doubling, 1.9984, 2.0694014157, 0.3769875115, 2.0693798, 0.376987576, -1.0},
                         Row{EventType::period_doubling, 2.0896, 2.1301191312, 0.389172376, 2.1301219, 0.389172376, -1.0}}) {
    const CodimensionTwo z = least(row.type, row.near);
    INFO(to_string(row.type) << " from " << row.near);
    REQUIRE(z.u.size() > 0);
    const double U = z.u[z.u.size() - 1], omega = z.u[z.u.size() - 2];
    CHECK(U == Approx(row.U).epsilon(0).margin(1e-9));
    CHECK(omega == Approx(row.omega).epsilon(0).margin(1e-7));  // at a minimum omega is known to the root of U's rounding
    CHECK(omega == Approx(row.quoted_omega).epsilon(0).margin(2.3e-5));
    CHECK(U <= row.quoted_U + 5e-10);
    const bool doubled = row.type == EventType::period_doubling;
    const HarmonicBalance& own = doubled ? dynamic_cast<const HarmonicBalance&>(hb2.doubled()) : hb2;
    const Vector u = doubled ? hb2.from_doubled(z.u) : z.u;
    REQUIRE(z.u.size() == own.size() + 2);
    // Of the motion as it is: at the least U of a fold curve, a cusp, three motions meet and a Newton iteration finds any of them.
    const IntegratedPeriod integrated = monodromy_by_integration(hb2.system_at(u), hb2.state_at(u, 0.0), 1);
    double nearest = 1.0;
    for (const auto& mu : Eigen::VectorXcd(integrated.monodromy.eigenvalues())) nearest = std::min(nearest, std::abs(mu - row.multiplier));
    CHECK(nearest < 1e-7);  // 16 harmonics, CVODE at 1e-13
  }
}

TEST_CASE("orbits: the least whirling amplitude, its curve solved for U at held omega and its multipliers integrated") {
  // A value of 0.318111237 m at 1.6003780 rad/s is in circulation: it is the curve at the vertex of a parabola through three points 1e-3 rad/s apart.
  // The vertex tends to our minimum with the square of that distance, and the multiplier integrated there is 1.
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("support_motion.amplitude"), Lens("omega")}, {.harmonics = 16});
  const int n = hb.size();
  const NewtonResult orbit = newton(hb, hb.linear_response(point({0.318, 1.6})));
  REQUIRE(orbit.ok());
  const Blocks blocks = make_blocks(hb, active_reflections(hb, orbit.x.head(n)));
  const auto threshold = [&](double omega) -> Vector {
    Vector u = orbit.x;
    u[n + 1] = omega;
    SingularSystem system(hb, blocks.indices[0], blocks.indices[1], u);
    return system.base_point(newton(system, system.unknowns(u), {.tolerance = 1e-13}).x);
  };
  const double ours = 1.6003560996, least = threshold(ours)[n];
  CHECK(least == Approx(0.318111203383).epsilon(0).margin(2e-12));
  CHECK(threshold(1.6003780)[n] == Approx(0.318111237).epsilon(0).margin(5e-10));  // the quoted pair lies on the curve
  const auto vertex = [&](double h) {
    const double left = threshold(ours - h)[n], right = threshold(ours + h)[n];
    return -0.5 * h * (right - left) / (left - 2.0 * least + right);
  };
  CHECK(vertex(1e-3) == Approx(1.6003780 - ours).epsilon(0).margin(1e-7));
  CHECK(vertex(1e-4) == Approx(vertex(1e-3) / 100.0).epsilon(0.01));
  const Vector u = threshold(ours);
  const IntegratedOrbit integrated = periodic_by_integration(hb.system_at(u), hb.state_at(u, 0.0), 1);
  REQUIRE(integrated.ok);
  double nearest = 1.0;
  for (const auto& mu : Vector(integrated.monodromy.eigenvalues().real())) nearest = std::min(nearest, std::abs(mu - 1.0));
  CHECK(nearest < 1e-10);  // CVODE at 1e-13 over a period
}

TEST_CASE("orbits: a curve of torus points in (omega, damping)", "[slow]") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 14});
  const HarmonicBalance hb2 = stay_harmonic_balance(oresund(), {Lens("omega"), Lens("damping")}, {.harmonics = 14});
  const OrbitNetwork net = whole(hb, 1.5, 1.9, 0);
  TwoParameterOptions o;
  o.range1[0] = 1.5;
  o.range1[1] = 1.9;
  o.range2[0] = 0.009;
  o.range2[1] = 0.012;
  for (const auto& s : net.network(0).branches().at(1).special) {
    if (s.type != EventType::torus) continue;
    const DefiningCurve curve = follow(hb2, s, 0.01, o);
    REQUIRE(curve.u.cols() > 5);
    for (Eigen::Index i = 0; i < curve.u.cols(); i += 5) {
      const Vector u = curve.u.col(i);
      double nearest = 1.0;
      for (const auto& mu : hb2.floquet(u).multipliers)
        nearest = std::min(nearest, std::abs(mu - std::polar(1.0, curve.frequency[i] * 6.283185307179586 / u[hb.size()])));
      CHECK(nearest < 1e-7);  // 14 harmonics
    }
  }
}
