// The slow-flow study as a user meets it.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "studies/result_file.hpp"
#include "tests/studies/program.hpp"

namespace fs = std::filesystem;
using namespace whirl::studies;
using namespace whirl::studies::tests;

namespace {

const std::string study = std::string(WHIRL_SOURCE_DIR) + "/studies/oresund-combinatorial.toml";
const std::string branches_only = " --set verification.enabled=false --set seeds.max_periods=0 ";

Ran run(const Folder& f, const std::string& arguments) { return program(f, "run " + study + " " + arguments); }

std::vector<double> special(const ResultReader& file, const std::string& type, const std::string& branch) {
  const auto types = file.text_column("/special_points", "type"), names = file.text_column("/special_points", "branch");
  const auto omega = file.column("/special_points", "omega");
  std::vector<double> found;
  for (std::size_t i = 0; i < omega.values.size(); ++i)
    if (types.values[i] == type && names.values[i] == branch) found.push_back(omega.values[i]);
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

TEST_CASE("slow-flow study: the coupled response is found without being told of it", "[slow]") {
  const Folder f;
  const Ran r = run(f, "--json -o o.h5 --set verification.omega=[2.1] --set verification.starts=[10.0,10.0] --set seeds.grid=2");
  INFO(r.err);
  REQUIRE(r.status == 1);  // in plane, stable by this ansatz, the motion has doubled its period
  CHECK(r.err.find("verification contradicts IP1 (stable) at omega = 2.1: ") != std::string::npos);
  CHECK(r.out.find("\"q1_h1.5\"") != std::string::npos);
  ResultReader file(f.path / "o.h5");
  CHECK(file.text_attribute("/study", "outcome") == "partial");
  CHECK(file.scalar("/cable", "omega1").value == Approx(3.14761321417).epsilon(1e-11));
  const auto births = special(file, "BP", "IP1");
  REQUIRE(births.size() == 2);  // where a Mathieu determinant vanishes: tested with the library
  CHECK(births[0] == Approx(1.91238872506).epsilon(1e-10));
  CHECK(births[1] == Approx(2.02690816547).epsilon(1e-10));
  CHECK(special(file, "LP", "WD1").size() == 1);
  const auto runs = file.table("/verification/runs");
  REQUIRE(runs.columns.front().values.size() == 4);                                                             // three averaged states and the start
  CHECK(file.column("/verification/runs", "q1_h1.5").values.back() == Approx(1.8874).epsilon(0).margin(1e-4));  // period-two motion at 2.1 rad/s
  CHECK(file.column("/verification/runs", "averaged_q1_h1.5").values.back() == Approx(2.3154).epsilon(0).margin(1e-4));
  CHECK(file.column("/verification/runs", "multiple").values.back() == 2.0);
  CHECK(file.text_column("/verification/runs", "branch").values.back() == "WD1");
  CHECK(file.column("/verification/transients/run4", "q1").values.front() == Approx(10.001));
  CHECK(file.column("/verification/averaged/w2.1000-1", "q2").values.size() == 257);
  const auto modulus = file.column("/branches/WD1", "floquet_modulus"), unstable = file.column("/branches/WD1", "n_unstable");
  for (std::size_t i = 0; i < modulus.values.size(); ++i) CHECK(std::isfinite(modulus.values[i]));
}

TEST_CASE("slow-flow study: every ansatz by name") {
  const Folder f;
  struct Case {
    std::string arguments, branch;
    double first_branch_point;
  };
  const Case cases[] = {
      {"--set ansatz.motion=in-plane", "IP1", 2.01595434413},
      {"--set ansatz.kind=combinatorial-32-printed", "IP1", 1.92152349804},
      {"--set ansatz.kind=combinatorial-32-printed --set ansatz.motion=in-plane", "IP1", 1.99453746835},
      {"--set ansatz.kind=list --set ansatz.q1=[0.5,1.5] --set ansatz.q2=[0,1,2]", "IP1", 1.91238872506},
      {"--set ansatz.kind=complete --set ansatz.harmonics=8 --set ansatz.nu=2 --set continuation.depth=0 --set seeds.random=0", "IP1", 1.99834670672},
      {"--set ansatz.kind=frozen --set continuation.range=[1.2,2.4]", "IP1", 1.61185715606},  // the superharmonic study's
  };
  for (const Case& c : cases) {
    const Ran r = run(f, c.arguments + branches_only + "--set seeds.grid=1 -o o.h5");
    INFO(c.arguments << "\n" << r.err);
    REQUIRE(r.status == 0);
    const auto found = special(ResultReader(f.path / "o.h5"), "BP", c.branch);
    REQUIRE(!found.empty());
    CHECK(found.front() == Approx(c.first_branch_point).epsilon(1e-10));
  }
  const Ran amplitude = run(f, branches_only +
                                   "--set omega=2.1 --set continuation.parameter=support_motion.amplitude --set "
                                   "continuation.range=[0.2,0.8] --set ansatz.kind=list --set ansatz.q1=[0.5,1.5,2.5] --set "
                                   "ansatz.q2=[0,1,2,3] -o a.h5");
  INFO(amplitude.err);
  CHECK(amplitude.status == 0);
}

TEST_CASE("slow-flow study: bad input, one clear line, nothing written") {
  const Folder f;
  const std::pair<std::string, std::string> cases[] = {
      {"--set ansatz.kind=list", "needs a list of harmonics"},
      {"--set ansatz.kind=list --set ansatz.q1=[0.5,0.5]", "each of them once"},
      {"--set ansatz.kind=list --set ansatz.q3=[1.0]", "the model has 2 coordinates"},
      {"--set ansatz.kind=list --set ansatz.q1=[0.123456]", "denominator"},
      {"--set ansatz.q1=[-1.0]", "ansatz.q1"},
      {"--set ansatz.kind=lists", "ansatz.kind"},
      {"--set ansatz.kind=combinatorial-32-printed --set model.terms=full", "reduced coupling"},
      {"--set seeds.starts=[1.0]", "2 numbers for each start"},
      {"--set omega=2.0", "omega = 2"},
      {"--set continuation.range=[0.0,2.0]", "continuation.range"},
      {"--set continuation.parameter=omga", "did you mean omega"},
  };
  for (const auto& [arguments, expected] : cases) {
    const Ran r = run(f, arguments + " -o x.h5");
    INFO(arguments << "\n" << r.err);
    CHECK(r.status == 2);
    CHECK(r.err.find(expected) != std::string::npos);
    CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
    CHECK(!fs::exists(f.path / "x.h5"));
  }
}

TEST_CASE("slow-flow study: coordinates by the model's names, starts off the model's own plane") {
  const Folder f;
  // A string forced in q1: motion out of plane is q2, and its start must leave q2 = 0 to settle on whirling.
  const std::string text = slurp(std::string(WHIRL_SOURCE_DIR) + "/studies/string-threshold.toml");
  const std::string model = text.substr(text.find("[modal_model]"), text.find("[ansatz]") - text.find("[modal_model]"));
  std::ofstream(f / "string.toml") << "study = \"slow-flow\"\n"
                                   << model << "[ansatz]\nkind = \"list\"\nq1 = [1.0]\nq2 = [1.0]\n[continuation]\nrange = [0.9, 1.2]\n"
                                   << "[seeds]\nmax_periods = 0\n[verification]\nomega = [1.03]\nstarts = [0.0, 0.0]\n";
  const Ran r = program(f, "run string.toml -o s.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  const ResultReader file(f / "s.h5");
  CHECK(file.text_attribute("/study", "mirrored") == "q2");
  REQUIRE(special(file, "BP", "IP1").size() == 2);
  CHECK(special(file, "BP", "IP1")[0] == Approx(1.0180097647).epsilon(0).margin(1e-9));
  CHECK(file.text_column("/verification/runs", "branch").values.back() == "W1");
  CHECK(file.column("/verification/runs", "q2_h1").values.back() == Approx(0.1819).epsilon(0).margin(1e-4));
  CHECK(r.out.find("q1_h1 int/avg     q2_h1 int/avg") != std::string::npos);

  const Ran many = run(f, "--set model.kind=multi-mode --set ansatz.kind=complete --set ansatz.harmonics=3 --set continuation.range=[1.9,1.92]" +
                              branches_only + "-o m.h5");
  INFO(many.err);
  REQUIRE(many.status == 0);
  const ResultReader modes(f / "m.h5");
  CHECK(modes.text_attribute("/study", "mirrored") == "y1, y2, y3");
  CHECK(modes.column("/branches/IP1", "z1_h1").values.front() > 0.5);
  CHECK(many.out.find("z1_h1 [m]") != std::string::npos);
}

TEST_CASE("without [ansatz] any number of coordinates is taken", "[slow_flow_study]") {
  const Folder f;
  for (const char* frequency : {"[1.0]", "[1.0, 2.0]", "[1.0, 2.0, 3.0]"}) {
    std::ofstream(f / "free.toml") << "study = \"slow-flow\"\n[modal_model]\nfrequency = " << frequency
                                   << "\n[[modal_model.force]]\nequation = 1\namplitude = 0.1\n[continuation]\nrange = [0.8, 1.2]\n";
    const Ran r = program(f, "check free.toml");
    INFO(frequency << r.err);
    CHECK(r.status == 0);
  }
}
