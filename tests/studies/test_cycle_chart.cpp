// Curves of special points of limit cycles in two parameters against AUTO-07p and multiple shooting, which agree with each other; and what the
// exponents of integrated motions say.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "continuation/network.hpp"
#include "models/equilibrium_model.hpp"
#include "studies/cycle_chart.hpp"
#include "studies/result_file.hpp"
#include "tests/studies/program.hpp"

using namespace whirl;
using namespace whirl::models;
using namespace whirl::continuation;
using namespace whirl::studies;

namespace {

struct Row {
  double p1, p2, period;
};

/// The families of all Hopf points, or of the motion met by integration, and their chart.
struct Charted {
  Charted(const EquilibriumModel& model, const std::string& first, std::pair<double, double> range1, const std::string& second,
          std::pair<double, double> range2, const std::vector<Row>& rows, std::vector<EventType> types, double longest_period,
          double integrate_at = NAN)
      : flow(model, {first}), flow2(model, {first, second}) {
    CycleOptions options;
    options.network.walk.lower = range1.first;
    options.network.walk.upper = range1.second;
    options.longest_period = longest_period;
    cycles = std::make_unique<CycleBranches>(flow, options);
    if (std::isnan(integrate_at)) {
      Network net(flow, {.walk = {.lower = range1.first, .upper = range1.second}});
      Vector u(model.size() + 1);
      u << Eigen::Map<const Vector>(model.initial.data(), model.size()), model.parameter(first);
      net.add_seed(u, "start");
      net.switch_branches();
      for (const Branch& b : net.branches())
        for (const SpecialPoint& s : b.special)
          if (s.type == EventType::hopf) (void)cycles->add_hopf(s, "HB");
    } else {
      REQUIRE(cycles->add_motion(Vector::Constant(model.size(), 0.5), integrate_at, 500.0, "integrated").empty());
    }
    CycleChart::Options o;
    o.follow.walk = options.network.walk;
    o.follow.range1[0] = range1.first;
    o.follow.range1[1] = range1.second;
    o.follow.range2[0] = range2.first;
    o.follow.range2[1] = range2.second;
    for (const Row& r : rows) o.follow.walk.user_values.push_back(r.p2);
    o.curves = std::move(types);
    o.second = model.parameter(second);
    chart = std::make_unique<CycleChart>(flow2, o, std::vector<PointColumn>{}, context);
    for (const auto& family : cycles->families()) chart->follow(*family);
  }
  void require(const std::vector<Row>& rows, bool doubled) const {
    for (const Row& r : rows) {
      double nearest = 1e300, period = 0.0;
      for (const ChartCurve& c : chart->curves())
        for (const CodimensionTwo& point : c.curve.special) {
          const auto k = point.u.size() - 2;
          if (point.type != "UZ" || std::abs(point.u[k + 1] - r.p2) > 1e-11 * std::abs(r.p2) || std::abs(point.u[k] - r.p1) > nearest) continue;
          nearest = std::abs(point.u[k] - r.p1);
          period = std::exp(point.u[LimitCycle::log_period]);
        }
      INFO(r.p1 << " at " << r.p2 << ": nearest " << nearest << ", T " << period << (doubled ? " of the doubled cycle" : ""));
      CHECK(nearest <= 2e-9 * std::max(1.0, std::abs(r.p1)));
      CHECK(std::abs(period / r.period - 1.0) < 1e-8);
    }
  }
  EquilibriumFlow flow, flow2;
  RunContext context;
  std::unique_ptr<CycleBranches> cycles;
  std::unique_ptr<CycleChart> chart;
};

EquilibriumModel roessler(double c) {
  return {.variables = {"x", "y", "z"},
          .parameters = {{"a", 0.2}, {"b", 0.2}, {"c", c}},
          .rhs = {"-y - z", "x + a*y", "b + z*(x - c)"},
          .initial = {0.0, 0.0, 0.0},
          .mirrors = {}};
}

}  // namespace

TEST_CASE("period doublings of the Roessler system in (c, a)") {
  const std::vector<Row> rows = {{1.9034307266, 0.33942084762, 5.271234793},
                                 {2.73312406776, 0.20692436351, 5.746295347},
                                 {3.1010666357, 0.18395495636, 5.823259219},
                                 {4.88222526578, 0.12461565322, 6.006067317}};
  const Charted c(roessler(2.6), "c", {1.5, 6.0}, "a", {0.1, 0.36}, rows, {EventType::period_doubling}, 20.0, 2.6);
  c.require(rows, true);
}

TEST_CASE("folds of cycles of the enzyme model in (rh, s0)") {
  const EquilibriumModel model{.variables = {"s", "a"},
                               .parameters = {{"rh", 1.0}, {"s0", 110.0}},
                               .rhs = {"s0 - s - rh*s*a/(1 + s + 0.1*s^2)", "0.2*(500 - a) - rh*s*a/(1 + s + 0.1*s^2)"},
                               .initial = {80.0, 480.0},
                               .mirrors = {}};
  const std::vector<Row> rows = {{2.57098232145, 108.92686416, 10.57636217},
                                 {2.92969606026, 110.77787431, 9.53844075},
                                 {4.94294517244, 110.24797871, 5.767941308},
                                 {5.4077701922, 108.21024068, 5.133842483}};
  const Charted c(model, "rh", {1.0, 6.5}, "s0", {95.0, 120.0}, rows, {EventType::fold}, 40.0);
  c.require(rows, false);
}

TEST_CASE("period doublings of the whirling string in (d, f), one curve through four of them", "[slow]") {
  const EquilibriumModel model{.variables = {"a", "b", "c", "e"},
                               .parameters = {{"d", -7.0}, {"f", 4.0}},
                               .rhs = {"-a - (d + 0.75*(a^2 + b^2) + 0.5*(c^2 + e^2))*b - 0.25*(2*c*e*a - (c^2 - e^2)*b)",
                                       "-b + (d + 0.75*(a^2 + b^2) + 0.5*(c^2 + e^2))*a + 0.25*((c^2 - e^2)*a + 2*c*e*b) - f",
                                       "-c - (d + 0.75*(c^2 + e^2) + 0.5*(a^2 + b^2))*e - 0.25*(2*a*b*c - (a^2 - b^2)*e)",
                                       "-e + (d + 0.75*(c^2 + e^2) + 0.5*(a^2 + b^2))*c + 0.25*((a^2 - b^2)*c + 2*a*b*e)"},
                               .initial = {1.9135, -2.582, 0.0, 0.0},
                               .mirrors = {{{"c", "e"}, "WH"}}};
  const std::vector<Row> rows = {{-12.5524168674, 4.3828974887, 4.514737881},
                                 {-8.63205350773, 3.9241921376, 4.41065614},
                                 {-6.22368153708, 4.3069666841, 3.580637903},
                                 {-5.96477083384, 3.7009538248, 3.977943415}};
  const Charted c(model, "d", {-13.0, -2.0}, "f", {3.0, 4.6}, rows, {EventType::period_doubling}, 5.2);
  c.require(rows, true);
}

TEST_CASE("torus points of the peroxidase-oxidase reaction in (k7, k8)", "[slow]") {
  const EquilibriumModel model{.variables = {"A", "B", "X", "Y"},
                               .parameters = {{"k7", 0.6}, {"k8", 0.5}},
                               .rhs = {"-0.1631021*A*B*X - 0.046875*A*B*Y + k7 - 0.1175*A", "-0.1631021*A*B*X - 0.046875*A*B*Y + k8",
                                       "0.1631021*A*B*X - 2500*X^2 + 0.09375*A*B*Y - 20*X + 0.001", "-0.046875*A*B*Y + 2500*X^2 - 1.104*Y"},
                               .initial = {2.0, 25.0, 0.01, 0.1},
                               .mirrors = {}};
  const std::vector<Row> rows = {
      {0.6408407829, 0.45706543412, 10.49293841}, {0.702712053207, 0.49235314791, 10.84011257}, {0.947333811028, 0.61963209336, 11.86851721}};
  const Charted c(model, "k7", {0.55, 0.95}, "k8", {0.42, 0.63}, rows, {EventType::torus}, 25.0);
  c.require(rows, false);
}

TEST_CASE("cycles by the program: chart and motions in the file, bad input in one line") {
  const studies::tests::Folder f;
  const std::string run = std::string("run ") + WHIRL_SOURCE_DIR + "/studies/roessler-cycles.toml --set cycles.period_doublings=0 ";
  const auto good = studies::tests::program(
      f,
      run + "--set second.parameter=a --set second.range=[0.15,0.25] --set cycles.integrate_at=[2.6,5.7] --set cycles.exponents=400 --json -o r.h5");
  INFO(good.err);
  REQUIRE(good.status == 0);
  const ResultReader file(f / "r.h5");
  CHECK(file.column("/curves/PD1", "a").values.size() > 5);
  CHECK(file.column("/curves/PD1", "cycle_period").values.front() > 5.0);
  CHECK(file.text_column("/motions", "motion").values == std::vector<std::string>{"periodic", "chaotic"});
  const auto sum = file.column("/motions", "lyapunov_sum").values, divergence = file.column("/motions", "divergence").values;
  for (std::size_t i = 0; i < 2; ++i) CHECK(sum[i] == Approx(divergence[i]).epsilon(1e-6));
  CHECK(good.out.find("\"motions\"") != std::string::npos);
  CHECK(good.out.find("\"curves\"") != std::string::npos);
  const std::pair<std::string, std::string> cases[] = {
      {"--set second.parameter=c --set second.range=[0.1,0.3]", "second.parameter"},
      {"--set second.parameter=a --set second.range=[0.3,0.4]", "second.range"},
      {"--set second.parameter=a --set second.range=[0.3,0.1]", "second.range"},
      {"--set second.range=[0.1,0.3]", "second.parameter"},
      {"--set second.parameter=q --set second.range=[0.1,0.3]", "second.parameter"},
      {"--set cycles.exponents=7", "cycles.exponents"},
  };
  for (const auto& [arguments, expected] : cases) {
    const auto bad = studies::tests::program(f, run + arguments + " -o x.h5");
    INFO(arguments << "\n" << bad.err);
    CHECK(bad.status == 2);
    CHECK(std::count(bad.err.begin(), bad.err.end(), '\n') == 1);
    CHECK(bad.err.find(expected) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(f / "x.h5"));
  }
}

TEST_CASE("superharmonic and slow-flow: averaged equations in time are in the file") {
  const studies::tests::Folder f;
  const std::string folder = std::string("run ") + WHIRL_SOURCE_DIR + "/studies/";
  const std::string quick =
      " --set support_motion.amplitude=0.15 --set verification.omega=[1.58] --set verification.starts=[0.0,0.0] --set verification.perturbation=0 "
      "--json ";
  for (const std::string& study : {std::string("oresund-superharmonic.toml --set verification.sweep_points=0 --set orbits.damping_pairs=[]"),
                                   std::string("oresund-combinatorial.toml --set ansatz.kind=frozen --set ansatz.order=2 --set seeds.grid=1 --set "
                                               "seeds.random=0 --set 'seeds.starts=[0.0,0.0]'")}) {
    const auto r = studies::tests::program(f, folder + study + quick + "-o m.h5");
    INFO(study << "\n" << r.err);
    REQUIRE(r.status == 0);
    const ResultReader file(f / "m.h5");
    const std::string run1 = "/verification/modulation/run1";
    const auto u = file.column(run1, "q2_h2_u").values, v = file.column(run1, "q2_h2_v").values;
    const auto au = file.column(run1, "averaged_q2_h2_u").values, av = file.column(run1, "averaged_q2_h2_v").values;
    double top = 0.0, averaged_top = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      top = std::max(top, std::hypot(u[i], v[i]));
      averaged_top = std::max(averaged_top, std::hypot(au[i], av[i]));
    }
    CHECK(top == Approx(0.7444).margin(1e-4));
    CHECK(averaged_top == Approx(0.7033).margin(1e-4));
    CHECK(r.out.find("\"modulation\"") != std::string::npos);
    CHECK(file.column(run1, "t").values.size() == 59 * 64 + 1);
  }
}
