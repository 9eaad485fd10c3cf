// Keys of charts: values of the second parameter asked for, a pair of parameters that leaves that of the branches, states along the curves.

#include <catch2/catch.hpp>
#include <cmath>

#include "studies/result_file.hpp"
#include "tests/studies/program.hpp"

using namespace whirl::studies;
using namespace whirl::studies::tests;

namespace {

Ran run_text(const Folder& f, const std::string& text, const std::string& arguments = "") {
  std::ofstream(f / "my.toml") << text;
  return program(f, "run my.toml -o r.h5 --json " + arguments);
}

// x' = p + m + q x - x^3: folds 27 (p + m)^2 = 4 q^3
const char* cusp = R"(study = "two-parameter"
[equilibrium_model]
variables = ["x"]
parameters = { p = -1.0, m = 0.0, q = 0.75 }
rhs = ["p + m + q*x - x^3"]
initial = [-1.2]
[continuation]
parameter = "p"
range = [-1.0, 1.0]
[second]
parameter = "q"
range = [-0.5, 1.0]
)";

}  // namespace

TEST_CASE("a chart lists points where the second parameter takes values asked for", "[chart_study]") {
  const Folder f;
  REQUIRE(run_text(f, cusp, "--set second.user_values=[0.3,0.6]").status == 0);
  const ResultReader file(f / "r.h5");
  const auto types = file.text_column("/special_points", "type").values;
  const auto p = file.column("/special_points", "p").values, q = file.column("/special_points", "q").values,
             x = file.column("/special_points", "x").values;
  int listed = 0;
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (types[i] != "UZ") continue;
    ++listed;
    CHECK((q[i] == 0.3 || q[i] == 0.6));
    CHECK(std::abs(p[i] + q[i] * x[i] - x[i] * x[i] * x[i]) < 1e-9);
  }
  CHECK(listed == 4);
  const Ran r = run_text(f, cusp, "--set second.user_values=[2.0]");
  CHECK(r.status == 2);
  CHECK(r.err.find("must lie in second.range, got 2") != std::string::npos);
}

TEST_CASE("a chart in two other parameters holds that of the branches at each special point", "[chart_study]") {
  const Folder f;
  REQUIRE(run_text(f, cusp, "--set first.parameter=m --set first.range=[-1.0,1.0]").status == 0);
  const ResultReader file(f / "r.h5");
  const auto m = file.column("/curves/LP1", "m").values, q = file.column("/curves/LP1", "q").values, p = file.column("/curves/LP1", "p").values,
             x = file.column("/curves/LP1", "x").values;
  REQUIRE(m.size() > 20);
  for (std::size_t i = 0; i < m.size(); ++i) {
    CHECK(p[i] == p[0]);
    CHECK(std::abs(27.0 * std::pow(p[i] + m[i], 2) - 4.0 * std::pow(q[i], 3)) < 1e-9);
    CHECK(std::abs(p[i] + m[i] + q[i] * x[i] - std::pow(x[i], 3)) < 1e-9);
  }
  CHECK(27.0 * p[0] * p[0] == Approx(4.0 * std::pow(0.75, 3)).epsilon(1e-9));
  const Ran r = run_text(f, cusp, "--set first.parameter=m");
  CHECK(r.status == 2);
  CHECK(r.err.find("must hold two increasing values") != std::string::npos);
}

TEST_CASE("a chart without an equilibrium says so", "[chart_study]") {
  const Folder f;
  std::string text = cusp;
  text.replace(text.find("p + m + q*x - x^3"), 17, "p + q*x - x + 0*m");  // q = 1: an equilibrium at p = 0 only
  text.replace(text.find("q = 0.75"), 8, "q = 1.0 ");
  const Ran r = run_text(f, text);
  CHECK(r.status == 1);
  CHECK(r.err.find("no equilibrium was found with p in [-1, 1]: no chart") != std::string::npos);
}

TEST_CASE("the JSON of a chart of periodic motions has its curves and their points", "[chart_study]") {
  const Folder f;
  const Ran r = run_text(f, R"(study = "periodic"
[modal_model]
frequency = [1.0]
damping = [0.05]
[[modal_model.term]]
equation = 1
coefficient = 1.0
powers = [3]
[[modal_model.force]]
equation = 1
amplitude = 0.2
name = "F"
[continuation]
parameter = "omega"
range = [0.8, 1.8]
[second]
parameter = "F"
range = [0.05, 0.3]
user_values = [0.25]
)",
                         "--set periodic.harmonics=5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.out.find("\"curve_points\": [\n") != std::string::npos);
  CHECK(r.out.find("\"curves\": [\n") != std::string::npos);
  CHECK(r.out.find("\"type\": \"UZ\"") != std::string::npos);
  const ResultReader file(f / "r.h5");
  CHECK(file.column("/curves/LP1", "q1_max").values.size() > 5);
  CHECK(file.column("/curves/LP1", "q1_rate_start").values.size() > 5);
}
