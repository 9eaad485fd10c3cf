// Limit cycles of classic systems against closed forms and against values of collocation (AUTO-07p) and multiple shooting that agree with each other.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include "continuation/network.hpp"
#include "core/newton.hpp"
#include "models/closed_forms.hpp"
#include "models/dynamics/periodic/cyclic_eigenvalues.hpp"
#include "models/dynamics/periodic/settle_on_cycle.hpp"
#include "models/equilibrium_model.hpp"
#include "models/superharmonic.hpp"
#include "studies/cycle_branches.hpp"

using namespace whirl;
using namespace whirl::models;
using namespace whirl::continuation;
using namespace whirl::studies;

namespace {

struct Point {
  std::string type;
  double p, period;
};

/// Families of all Hopf points that a walk from `initial` meets: special points of cycles, level by level.
struct Diagram {
  Diagram(const EquilibriumModel& model, const std::string& lens, double lower, double upper, CycleOptions options) : flow(model, {lens}) {
    options.network.walk.lower = lower;
    options.network.walk.upper = upper;
    cycles = std::make_unique<CycleBranches>(flow, options);
    Network net(flow, {.walk = {.lower = lower, .upper = upper}});
    Vector u(model.size() + 1);
    u << Eigen::Map<const Vector>(model.initial.data(), model.size()), model.parameter(lens);
    net.add_seed(u, "start");
    net.switch_branches();
    for (const Branch& b : net.branches())
      for (const SpecialPoint& s : b.special)
        if (s.type == EventType::hopf) why.push_back(cycles->add_hopf(s, "HB"));
  }
  std::vector<Point> points(int level = 0) const {
    std::vector<Point> all;
    for (const auto& f : cycles->families())
      for (const Branch& b : f->net->network(level).branches())
        for (const SpecialPoint& s : b.special) all.push_back({to_string(s.type), s.u[s.u.size() - 1], f->problem(level).period(s.u)});
    return all;
  }
  EquilibriumFlow flow;
  std::unique_ptr<CycleBranches> cycles;
  std::vector<std::string> why;
};

void require_point(const std::vector<Point>& points, const std::string& type, double p, double period, double within = 1e-9) {
  INFO(type << " " << p);
  for (const Point& q : points)
    if (q.type == type && std::abs(q.p - p) <= within * std::max(1.0, std::abs(p)) && std::abs(q.period / period - 1.0) <= 1e-7) return;
  FAIL("is missing");
}

int count(const std::vector<Point>& points, const std::string& type) {
  return static_cast<int>(std::count_if(points.begin(), points.end(), [&](const Point& p) { return p.type == type; }));
}

EquilibriumModel string_model() {
  return {.variables = {"a", "b", "c", "e"},
          .parameters = {{"d", -7.0}, {"f", 4.0}},
          .rhs = {"-a - (d + 0.75*(a^2 + b^2) + 0.5*(c^2 + e^2))*b - 0.25*(2*c*e*a - (c^2 - e^2)*b)",
                  "-b + (d + 0.75*(a^2 + b^2) + 0.5*(c^2 + e^2))*a + 0.25*((c^2 - e^2)*a + 2*c*e*b) - f",
                  "-c - (d + 0.75*(c^2 + e^2) + 0.5*(a^2 + b^2))*e - 0.25*(2*a*b*c - (a^2 - b^2)*e)",
                  "-e + (d + 0.75*(c^2 + e^2) + 0.5*(a^2 + b^2))*c + 0.25*((a^2 - b^2)*c + 2*a*b*e)"},
          .initial = {1.9135, -2.582, 0.0, 0.0},  // the upper planar branch
          .mirrors = {{{"c", "e"}, "WH"}}};
}

EquilibriumModel langford() {
  return {.variables = {"x", "y", "z"},
          .parameters = {{"lam", -0.45}, {"al", 0.95}, {"be", 0.7}, {"om", 3.5}, {"rho", 0.25}},
          .rhs = {"(z - be)*x - om*y", "om*x + (z - be)*y", "lam + al*z - z^3/3 - (x^2 + y^2)*(1 + rho*z)"},
          .initial = {0.0, 0.0, 0.5},
          .mirrors = {}};
}

}  // namespace

TEST_CASE("van der Pol: period, multiplier, and the mean divergence", "[cycles]") {
  const EquilibriumModel model{
      .variables = {"x", "y"}, .parameters = {{"mu", 1.0}}, .rhs = {"y", "mu*(1 - x^2)*y - x"}, .initial = {0.0, 0.0}, .mirrors = {}};
  EquilibriumFlow flow(model, {"mu"});
  // Half-period shooting with tolerances 1e-12 and 1e-13; ln mu2 is mu times the integral of 1 - x^2.
  struct Row {
    double mu, period, ln_mu2;
  };
  for (const Row& row : {Row{0.1, 6.287111272289, -0.629103921}, Row{1.0, 6.663286859323, -7.058932809}, Row{5.0, 11.61223066772, -85.45201854}}) {
    LimitCycle cycle(flow, Vector::Unit(2, 0), {.segments = 4, .tolerance = 1e-12});
    const auto met = settle_on_cycle(flow, Vector::Constant(2, 1.0), Vector::Constant(1, row.mu), {.transient = 100.0});
    REQUIRE(met);
    const auto orbit = [&](double s) { return Vector(met->x.col(static_cast<Eigen::Index>(s * 512.0) % 512)); };
    const NewtonResult at = newton(cycle, cycle.guess(orbit, met->period, Vector::Constant(1, row.mu)), {.tolerance = 1e-12, .max_iterations = 30});
    REQUIRE(at.ok());
    CHECK(cycle.period(at.x) == Approx(row.period).epsilon(1e-11));
    CHECK(cycle.divergence(at.x) == Approx(row.ln_mu2).epsilon(1e-8));
    CHECK(cycle.trivial_error(at.x) < (row.mu < 2.0 ? 1e-10 : 1e-7));  // the fast stretches magnify the error of the points
    Eigen::VectorXcd mu(1);
    Eigen::VectorXi group(1);
    REQUIRE(cycle.multipliers(at.x, mu, group));
    if (row.ln_mu2 > -20.0) CHECK(std::log(mu[0].real()) == Approx(row.ln_mu2).epsilon(1e-7));
    else CHECK(std::abs(mu[0]) < 1e-12);
  }
}

TEST_CASE("derivatives of the collocation system are those of its residual", "[cycles]") {
  EquilibriumFlow flow(langford(), {"lam"});
  LimitCycle single(flow, Vector::Unit(3, 0), {.segments = 3, .tolerance = 1e-8});
  Vector p = Vector::Constant(1, 1.0);
  const auto orbit = [](double s) {
    Vector x(3);
    x << std::cos(2.0 * std::numbers::pi * s), std::sin(2.0 * std::numbers::pi * s), 0.7 + 0.1 * std::sin(2.0 * std::numbers::pi * s);
    return x;
  };
  const Vector u1 = single.guess(orbit, 2.0, p);
  const auto& doubled = static_cast<const LimitCycle&>(single.doubled());
  Vector u2 = single.in_doubled(u1);
  u2.segment(LimitCycle::scalars + 9, 9) = 0.02 * Vector::LinSpaced(9, -1.0, 1.0);
  for (const auto& [cycle, u] : {std::pair<const LimitCycle*, Vector>(&single, u1), {&doubled, u2}}) {
    const int n = cycle->size(), columns = n + 1;
    Matrix j(n, columns), h(n, columns), ahead(n, columns), behind(n, columns);
    Vector plus(n), minus(n);
    cycle->jacobian(u, j);
    REQUIRE(j.allFinite());
    for (int i = 0; i < columns; ++i) {
      const double step = 1e-6;
      const Vector shift = step * Vector::Unit(columns, i);
      cycle->residual(u + shift, plus);
      cycle->residual(u - shift, minus);
      CHECK(((plus - minus) / (2.0 * step) - j.col(i)).norm() < 1e-7 * (1.0 + j.col(i).norm()));
    }
    const Vector v = Vector::LinSpaced(columns, -1.0, 0.7);
    cycle->second(u, v, h);
    cycle->jacobian(u + 1e-5 * v, ahead);
    cycle->jacobian(u - 1e-5 * v, behind);
    CHECK(((ahead - behind) / 2e-5 - h).norm() < 1e-6 * h.norm());
    const Vector a = Vector::LinSpaced(columns, 0.4, -0.9), b = Vector::LinSpaced(columns, 0.2, 1.0);
    Vector third(n);
    cycle->third(u, a, b, v, third);
    cycle->second(u + 1e-5 * v, a, ahead);
    cycle->second(u - 1e-5 * v, a, behind);
    CHECK(((ahead - behind) * b / 2e-5 - third).norm() < 1e-6 * third.norm());
  }
}

TEST_CASE("eigenvalues of products that span many decades", "[cycles]") {
  // Similar to diagonal matrices with powers of 1e4 an interval: the product has 1e16, 0.5 and 1e-16.
  const Matrix frame = (Matrix(3, 3) << 1.0, 0.3, -0.2, 0.1, 1.0, 0.4, -0.3, 0.2, 1.0).finished();
  std::vector<Matrix> factors;
  for (int i = 0; i < 4; ++i) {
    Vector d(3);
    d << 1e4, i == 0 ? -0.5 : 1.0, 1e-4;
    const Matrix turn = frame + 0.1 * i * Matrix::Identity(3, 3), next = frame + 0.1 * ((i + 1) % 4) * Matrix::Identity(3, 3);
    factors.push_back(next * d.asDiagonal() * turn.inverse());
  }
  const Eigen::VectorXcd mu = cyclic_eigenvalues(factors);
  CHECK(mu[0].real() == Approx(1e16).epsilon(1e-9));
  CHECK(mu[1].real() == Approx(-0.5).epsilon(1e-9));
  CHECK(mu[1].imag() == 0.0);
  CHECK(std::abs(mu[2]) < 1e-8);
}

// x^2 + y^2 = (lam + al be - be^3/3)/(1 + rho be), z = be, T = 2 pi/om; multipliers e^{T s}, s^2 - (al - be^2 - rho r^2) s + 2 r^2 (1 + rho be) = 0.
TEST_CASE("Langford: closed forms of the cycle, its multipliers and its torus point", "[cycles]") {
  const double al = 0.95, be = 0.7, om = 3.5, rho = 0.25;
  const double torus = (1.0 + rho * be) * (al - be * be) / rho - al * be + be * be * be / 3.0;
  Diagram d(langford(), "lam", -0.7, 2.0, {.network = {.walk = {.user_values = {0.6, 1.0, 1.5}}}, .period_doublings = 0});
  REQUIRE(d.cycles->families().size() == 1);
  const auto points = d.points();
  require_point(points, "TR", torus, 2.0 * std::numbers::pi / om);
  CHECK(count(points, "TR") == 1);
  CHECK(count(points, "LP") == 0);
  CHECK(count(points, "unresolved") == 0);
  const auto& family = *d.cycles->families().front();
  int seen = 0;
  for (const Branch& b : family.net->network(0).branches())
    for (const SpecialPoint& s : b.special) {
      const double lam = s.u[s.u.size() - 1], r2 = (lam + al * be - be * be * be / 3.0) / (1.0 + rho * be);
      CHECK(family.problem(0).period(s.u) == Approx(2.0 * std::numbers::pi / om).epsilon(1e-10));
      CHECK(s.u[LimitCycle::first_harmonic] == Approx(std::sqrt(r2)).epsilon(1e-9));
      Eigen::VectorXcd mu(2);
      Eigen::VectorXi group(2);
      const OrbitProblem& orbit = family.problem(0);
      REQUIRE(orbit.multipliers(s.u, mu, group));
      const double half = 0.5 * (al - be * be - rho * r2);
      const std::complex<double> root = std::sqrt(std::complex<double>(half * half - 2.0 * r2 * (1.0 + rho * be)));
      const std::complex<double> exact = std::exp(2.0 * std::numbers::pi / om * (half + root));
      CHECK(std::min(std::abs(mu[0] - exact), std::abs(mu[1] - exact)) < 1e-8);
      ++seen;
    }
  CHECK(seen == 4);
}

TEST_CASE("whirling string: doublings and folds up to the period 5.5, and the doubled families", "[cycles][slow]") {
  Diagram d(string_model(), "d", -12.0, 0.0, {.cycle = {.tolerance = 1e-11}, .period_doublings = 1, .longest_period = 5.5});
  REQUIRE(d.cycles->families().size() == 2);
  const auto single = d.points(0), doubled = d.points(1);
  require_point(single, "PD", -5.85121783572, 3.69428555421);
  require_point(single, "PD", -6.42042478567, 4.02141328533);
  require_point(single, "LP", -6.59495464809, 4.2832448112);
  require_point(single, "LP", -6.21048777742, 5.01828393014);
  require_point(single, "PD", -6.27951959458, 5.25709311763);
  require_point(doubled, "PD", -6.15891652821, 7.97462056603);
  require_point(doubled, "PD", -6.19613332404, 7.99200328185);
  CHECK(count(single, "unresolved") == 0);
}

TEST_CASE("Roessler: the cascade from a motion met by integration", "[cycles][slow]") {
  const EquilibriumModel model{.variables = {"x", "y", "z"},
                               .parameters = {{"c", 2.6}},
                               .rhs = {"-y - z", "x + 0.2*y", "0.2 + z*(x - c)"},
                               .initial = {0.0, 0.0, 0.0},
                               .mirrors = {}};
  EquilibriumFlow flow(model, {"c"});
  CycleOptions options{.cycle = {.tolerance = 1e-11}, .period_doublings = 1};
  options.network.walk.lower = 2.0;
  options.network.walk.upper = 5.0;
  options.network.walk.user_values = {3.0};
  CycleBranches cycles(flow, options);
  REQUIRE(cycles.add_motion(Vector::Constant(3, 0.5), 2.6, 300.0, "start").empty());
  CHECK_FALSE(cycles.add_motion(Vector::Constant(3, 1.0), 2.6, 300.0, "again").empty());  // the same family
  REQUIRE(cycles.families().size() == 1);
  std::vector<Point> single, doubled;
  const auto& f = *cycles.families().front();
  for (const Branch& b : f.net->network(0).branches())
    for (const SpecialPoint& s : b.special) single.push_back({to_string(s.type), s.u[s.u.size() - 1], f.problem(0).period(s.u)});
  for (const Branch& b : f.net->network(1).branches())
    for (const SpecialPoint& s : b.special) doubled.push_back({to_string(s.type), s.u[s.u.size() - 1], f.problem(1).period(s.u)});
  require_point(single, "PD", 2.83244502786, 5.76982001651);
  require_point(single, "UZ", 3.0, 5.7792382834);
  require_point(doubled, "PD", 3.83735816841, 11.5726888045);
}

TEST_CASE("folds of cycles of the enzyme model, both ends at Hopf points", "[cycles][slow]") {
  const EquilibriumModel model{.variables = {"s", "a"},
                               .parameters = {{"rh", 1.0}},
                               .rhs = {"110 - s - rh*s*a/(1 + s + 0.1*s^2)", "0.2*(500 - a) - rh*s*a/(1 + s + 0.1*s^2)"},
                               .initial = {80.0, 480.0},
                               .mirrors = {}};
  Diagram d(model, "rh", 1.0, 6.0, {.cycle = {.tolerance = 1e-11}, .period_doublings = 0});
  REQUIRE(d.cycles->families().size() == 1);
  REQUIRE(d.why.size() == 2);
  CHECK(d.why[1] == "a family met before ends there");
  std::vector<double> folds;
  for (const Point& p : d.points())
    if (p.type == "LP") folds.push_back(p.p);
  std::sort(folds.begin(), folds.end());
  REQUIRE(folds.size() == 2);
  CHECK(folds[0] == Approx(2.7596874555).epsilon(1e-9));
  CHECK(folds[1] == Approx(5.00783976076).epsilon(1e-9));
}

TEST_CASE("Lorenz: the subcritical family down to period 1.8", "[cycles]") {
  const EquilibriumModel model{.variables = {"x", "y", "z"},
                               .parameters = {{"r", 20.0}},
                               .rhs = {"10*(y - x)", "r*x - y - x*z", "x*y - 8*z/3"},
                               .initial = {7.1, 7.1, 19.0},
                               .mirrors = {{{"x", "y"}, "PF"}}};
  Diagram d(
      model, "r", 14.0, 26.0,
      {.network = {.walk = {.user_values = {24.0, 20.0, 16.0, 14.5}}}, .cycle = {.tolerance = 1e-11}, .period_doublings = 0, .longest_period = 1.85});
  REQUIRE(d.cycles->families().size() == 1);
  const auto points = d.points();
  require_point(points, "UZ", 24.0, 0.679336764198);
  require_point(points, "UZ", 20.0, 0.876552253492);
  require_point(points, "UZ", 16.0, 1.30249747423);
  require_point(points, "UZ", 14.5, 1.79456695328);
  CHECK(count(points, "unresolved") == 0);
  const auto& family = *d.cycles->families().front();
  const Branch& b = family.net->network(0).branches().front();
  // ln |det M| is the mean divergence, -(10 + 1 + 8/3) T.
  CHECK(family.problem(0).divergence(b.u(b.points() / 2)) ==
        Approx(-(11.0 + 8.0 / 3.0) * family.problem(0).period(b.u(b.points() / 2))).epsilon(1e-10));
}

TEST_CASE("peroxidase-oxidase: torus points of a stiff family whose start Newton would leave for its mirror image", "[cycles]") {
  const EquilibriumModel model{.variables = {"A", "B", "X", "Y"},
                               .parameters = {{"k7", 0.6}},
                               .rhs = {"-0.1631021*A*B*X - 0.046875*A*B*Y + k7 - 0.1175*A", "-0.1631021*A*B*X - 0.046875*A*B*Y + 0.5",
                                       "0.1631021*A*B*X - 2500*X^2 + 0.09375*A*B*Y - 20*X + 0.001", "-0.046875*A*B*Y + 2500*X^2 - 1.104*Y"},
                               .initial = {2.0, 25.0, 0.01, 0.1},
                               .mirrors = {}};
  Diagram d(model, "k7", 0.55, 0.95, {.cycle = {.tolerance = 1e-11}, .period_doublings = 0, .longest_period = 25.0});
  REQUIRE(d.cycles->families().size() == 1);
  const auto points = d.points();
  require_point(points, "TR", 0.71643356438, 10.9121268777);
  require_point(points, "TR", 0.818565885283, 14.7224457225);
  CHECK(count(points, "TR") == 2);
  CHECK(count(points, "unresolved") == 0);
}

TEST_CASE("adaptive control: three doublings, all supercritical", "[cycles]") {
  const EquilibriumModel model{
      .variables = {"x", "y", "z"}, .parameters = {{"al", 1.2}}, .rhs = {"y", "z", "-al*z - y - x + x^2"}, .initial = {0.0, 0.0, 0.0}, .mirrors = {}};
  Diagram d(model, "al", 0.4, 1.3, {.cycle = {.tolerance = 1e-11}, .period_doublings = 2});
  const double doublings[] = {0.63030200616, 0.579629840896, 0.569222719606}, periods[] = {6.36407133944, 12.7343655422, 25.4737384995};
  for (int level = 0; level < 3; ++level) {
    require_point(d.points(level), "PD", doublings[level], periods[level]);
    for (const Branch& b : d.cycles->families().front()->net->network(level).branches())
      for (const SpecialPoint& s : b.special)
        if (s.type == EventType::period_doubling) CHECK((s.has_coefficient && s.coefficient < 0.0));
  }
}

TEST_CASE("averaged Oresund stay: cycles of the upper Hopf point and their doubled families", "[cycles][slow]") {
  // Shooting and collocation that agree; folds alternate about the homoclinic value 2.0309900842354.
  const StayParameters<double> stay{{260.0, 2.17e9, 5.5e6, 81.05, 30.4, 9.81}, 0.01, 0.01, 0.5, 1.65};
  const SuperharmonicFlow flow(stay, {.order = 2}, {Lens("omega")});
  Network net(flow, {.walk = {.lower = 1.95, .upper = 2.3}});
  for (const auto& x : coupled_states(flow.model().coefficients<double>(std::array<double, 1>{2.0}))) {
    Vector u(5);
    u << x, 2.0;
    net.add_seed(u, "closed form");
  }
  CycleOptions options{.cycle = {.tolerance = 1e-11}, .period_doublings = 1, .longest_period = 95.0};
  options.network.walk.lower = 1.95;
  options.network.walk.upper = 2.3;
  CycleBranches cycles(flow, options);
  int hopf = 0;
  for (const Branch& b : net.branches())
    for (const SpecialPoint& s : b.special)
      if (s.type == EventType::hopf && std::abs(s.u[4] - 2.03317655052) < 1e-9 && hopf++ == 0) CHECK(cycles.add_hopf(s, "HB").empty());
  REQUIRE(cycles.families().size() == 1);
  const auto points_of = [&](int level) {
    std::vector<Point> all;
    const auto& family = *cycles.families().front();
    for (const Branch& b : family.net->network(level).branches())
      for (const SpecialPoint& s : b.special) all.push_back({to_string(s.type), s.u[s.u.size() - 1], family.problem(level).period(s.u)});
    return all;
  };
  const auto single = points_of(0), doubled = points_of(1);
  require_point(single, "PD", 2.03213830306, 56.292747803);
  require_point(single, "PD", 2.02839066554, 62.593636727);
  require_point(single, "LP", 2.02832122375, 63.88021681);
  require_point(single, "LP", 2.03236772079, 82.607482282);
  require_point(single, "PD", 2.03229084675, 83.597095555);
  require_point(single, "PD", 2.02999977642, 92.962778723);
  require_point(single, "LP", 2.02999236093, 93.581828127);
  require_point(doubled, "PD", 2.03185965143, 114.14638429);
  require_point(doubled, "PD", 2.03150934452, 118.52061965);
  require_point(doubled, "LP", 2.03146779035, 121.15023349);
  require_point(doubled, "PD", 2.0284285685, 125.24891494);
  CHECK(count(single, "unresolved") == 0);
}
