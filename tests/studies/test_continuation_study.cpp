// Study kinds `continuation` and `two-parameter` on systems given as expressions: the example inputs give the published values.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "tests/studies/program.hpp"

namespace fs = std::filesystem;
using namespace whirl::studies::tests;

namespace {

struct RunFolder : Folder {
  Ran run(const std::string& arguments) const { return program(*this, "run " + arguments + " -o r.h5"); }
  Ran run_text(const std::string& text, const std::string& arguments = "") const {
    std::ofstream(path / "my.toml") << text;
    return run("my.toml " + arguments);
  }
  bool has_result() const { return fs::exists(path / "r.h5"); }
};

std::string study(const std::string& name) { return std::string(WHIRL_SOURCE_DIR) + "/studies/" + name; }

/// Values of `key` of the points of a type, in the order of the JSON text.
std::vector<double> values(const std::string& json, const std::string& type, const std::string& key) {
  std::vector<double> found;
  std::stringstream s(json);
  for (std::string line; std::getline(s, line);) {
    std::smatch m;
    if (line.find("\"type\": \"" + type + "\"") != std::string::npos && std::regex_search(line, m, std::regex("\"" + key + "\": ([-+0-9.eE]+)")))
      found.push_back(std::stod(m[1]));
  }
  std::sort(found.begin(), found.end());
  return found;
}

void check_values(std::vector<double> found, std::vector<double> wanted, double tolerance) {
  std::sort(wanted.begin(), wanted.end());
  CAPTURE(found, wanted);
  REQUIRE(found.size() == wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(std::abs(found[i] - wanted[i]) < tolerance);
}

const std::string cusp = R"(study = "continuation"
[equilibrium_model]
variables = ["x"]
parameters = { mu = -1.0, lambda = 1.0 }
rhs = ["mu + lambda*x - x^3"]
initial = [-1.3]
[continuation]
parameter = "mu"
range = [-1.0, 1.0]
)";

}  // namespace

TEST_CASE("a normal form in ten lines", "[continuation_study]") {
  const RunFolder f;
  const Ran r = f.run_text(cusp, "--json");
  CHECK(r.status == 0);
  const double fold = 2.0 / (3.0 * std::sqrt(3.0));
  check_values(values(r.out, "LP", "mu"), {-fold, fold}, 1e-10);
  CHECK(r.err.find("x [-]") != std::string::npos);
}

TEST_CASE("the example inputs give the published values", "[continuation_study][published]") {
  const RunFolder f;
  Ran r = f.run(study("lorenz.toml") + " --json");
  CHECK(r.status == 0);
  check_values(values(r.out, "HB", "rho"), {470.0 / 19.0}, 1e-9);
  check_values(values(r.out, "BP", "rho"), {1.0}, 1e-10);
  CHECK(r.out.find("\"criticality\": \"supercritical\"") != std::string::npos);  // the pitchfork
  CHECK(r.out.find("\"criticality\": \"subcritical\"") != std::string::npos);    // the Hopf point
  r = f.run(study("co-oxidation.toml") + " --json");
  CHECK(r.status == 0);
  check_values(values(r.out, "HB", "q2"), {1.04099156953261, 1.05155746245773}, 1e-9);
  check_values(values(r.out, "LP", "q2"), {1.04204850537852, 1.05220028786995}, 1e-9);
  r = f.run(study("whirling-string.toml") + " --json");
  CHECK(r.status == 0);
  check_values(values(r.out, "LP", "w"), {1.0370229451, 1.0779949255}, 1e-10);
  const auto onset = values(r.out, "BP", "w");                            // the upper one also ends the whirl branch
  check_values(onset, {1.0180097647, 1.0728304789, 1.0728304789}, 1e-9);  // printed to 1e-10; ours end in ..76469 and ..78948
  CHECK(values(r.out, "RP", "w").size() == 4);
}

TEST_CASE("charts of systems given as expressions", "[continuation_study][published]") {
  const RunFolder f;
  Ran r = f.run(study("cusp.toml") + " --json");
  CHECK(r.status == 0);
  check_values(values(r.out, "CP", "mu"), {0.0}, 1e-10);
  check_values(values(r.out, "CP", "lambda"), {0.0}, 1e-10);
  r = f.run(study("co-oxidation-chart.toml") + " --json");
  CHECK(r.status == 0);
  check_values(values(r.out, "BT", "q2"), {1.417628, 1.417628, 1.161199, 1.161199}, 1e-6);  // on both curves
  check_values(values(r.out, "BT", "k"), {0.971397, 0.971397, 0.722339, 0.722339}, 1e-6);
  const auto gh = values(r.out, "GH", "q2");
  CHECK(std::any_of(gh.begin(), gh.end(), [](double q2) { return std::abs(q2 - 0.924255) < 1e-6; }));
  r = f.run(study("duffing-chart.toml") + " --json");
  CHECK(r.status == 0);
  CHECK(r.out.find("\"type\": \"RP\"") != std::string::npos);
}

TEST_CASE("one chart with every codimension-2 point", "[continuation_study][published]") {
  const RunFolder f;
  const Ran r = f.run(study("lorenz-84-chart.toml") + " --json");
  CHECK(r.status == 0);
  for (const double T : values(r.out, "HH", "T")) CHECK(std::abs(std::abs(T) - 0.02627393) < 1e-6);  // published digits
  for (const char* type : {"CP", "BT", "ZH", "HH", "GH"}) CHECK_FALSE(values(r.out, type, "F").empty());
  CHECK(values(r.out, "BT", "u").size() == values(r.out, "BT", "F").size());  // the variables stand beside the parameters
}

TEST_CASE("eight branches leave a double zero, each told where it was born", "[continuation_study]") {
  const RunFolder f;
  const Ran r = f.run(study("two-modes-pitchforks.toml") + " --json");
  CHECK(r.status == 0);
  CHECK(r.out.find("\"subtype\": \"multiple\"") != std::string::npos);
  std::size_t born = 0;  // at the point, or as the image under a symmetry of one that was
  for (const std::string where : {"\"born_at\": \"B1:BP1\"", "by symmetry\""})
    for (std::size_t at = r.out.find(where); at != std::string::npos; at = r.out.find(where, at + 1)) ++born;
  CHECK(born == 8);
}

TEST_CASE("a closed curve between the ends of the range is found without a seed", "[continuation_study]") {
  const RunFolder f;
  std::string text = cusp;
  text = std::regex_replace(text, std::regex("mu \\+ lambda\\*x - x\\^3"), "lambda - x^2 - 16*mu^2");
  const Ran r = f.run_text(text, "--json");
  CHECK(r.status == 0);
  check_values(values(r.out, "LP", "mu"), {-0.25, 0.25}, 1e-10);
  CHECK(r.out.find("\"stop_reason\": \"closed_loop\"") != std::string::npos);
}

TEST_CASE("isolas are found by deflation and told", "[continuation_study]") {
  const RunFolder f;
  const std::string text = R"toml(study = "continuation"
[equilibrium_model]
variables = ["x"]
parameters = { mu = -1.0 }
rhs = ["x*(0.25 - mu^2 - (x-2)^2)"]
initial = [0.0]
[continuation]
parameter = "mu"
range = [-1.0, 1.0]
)toml";
  CHECK(f.run_text(text).out.find("isola") == std::string::npos);
  const Ran r = f.run_text(text, "--json --set continuation.deflate_at=[0.0]");
  CHECK(r.status == 0);
  CHECK(r.err.find(", an isola, born at deflation at mu = 0") != std::string::npos);
  CHECK(r.out.find("\"isola\": true") != std::string::npos);
  CHECK(f.run_text(text, "--set continuation.seeds=[2.5,0.0]").out.find(", an isola, born at seed 1") != std::string::npos);
}

TEST_CASE("bad input to a continuation gives one line", "[continuation_study]") {
  const RunFolder f;
  const auto refused = [&](const std::string& set, const std::string& words) {
    const Ran r = f.run_text(cusp, "--set " + set);
    INFO(r.err);
    CHECK(r.status == 2);
    CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
    CHECK(r.err.find(words) != std::string::npos);
    CHECK_FALSE(f.has_result());
  };
  refused("continuation.parameter=mux", "continuation.parameter = \"mux\": no such parameter, did you mean mu?");
  refused("'continuation.peaks=[\"y\"]'", "continuation.peaks = [\"y\"]: each value must be one of x");
  refused("continuation.seeds=[1.0]", "must hold groups of 2 numbers: the variables, then mu");
  refused("continuation.deflate_at=[3.0]", "each value must lie in continuation.range");
  refused("cable.gravity=9.0", "cable.gravity = 9.0: is not taken beside [equilibrium_model]");
  refused("response.order=3", "is not taken beside [equilibrium_model]");
}

TEST_CASE("the averaged response of a stay is a continuation too", "[continuation_study]") {
  const RunFolder f;
  std::string text = slurp(study("oresund-threshold.toml"));
  text = std::regex_replace(text, std::regex("\"two-parameter\""), "\"continuation\"");
  text = text.substr(0, text.find("[second]"));
  const Ran r = f.run_text(text, "--json --set 'continuation.peaks=[\"q2_h2\"]'");
  CHECK(r.status == 0);
  const auto folds = values(r.out, "LP", "omega");
  CHECK(std::any_of(folds.begin(), folds.end(), [](double w) { return std::abs(w - 2.2051616201) < 1e-9; }));
  CHECK_FALSE(values(r.out, "RP", "omega").empty());
}

TEST_CASE("thresholds of whirling of a modal model, one harmonic in each coordinate", "[continuation_study]") {
  // Planar motion of amplitude A: A^2 ((1 - w^2 + 3/4 A^2)^2 + c^2 w^2) = F^2. A small motion out of plane sees 1 - w^2 + A^2/2 and A^2/4 of its
  // conjugate: it grows from (1 - w^2 + A^2/2)^2 + c^2 w^2 = A^4/16 on.
  const RunFolder f;
  constexpr double c = 0.02;
  const auto planar = [](double w, double A) { return A * A * (std::pow(1.0 - w * w + 0.75 * A * A, 2) + c * c * w * w); };
  const auto onset = [](double w, double A) { return std::pow(1.0 - w * w + 0.5 * A * A, 2) + c * c * w * w - std::pow(A, 4) / 16.0; };
  std::string text = slurp(study("string-threshold.toml"));
  SECTION("branches") {
    text = std::regex_replace(text, std::regex("\"two-parameter\""), "\"continuation\"");
    text = text.substr(0, text.find("[second]"));
    const Ran r = f.run_text(text, "--json --set 'continuation.peaks=[\"q1_h1\"]'");
    INFO(r.err);
    REQUIRE(r.status == 0);
    auto omega = values(r.out, "BP", "omega"), A = values(r.out, "BP", "q1_h1");
    const auto same = [](double a, double b) { return std::abs(a - b) < 1e-9; };  // the whirling branch meets one of them again
    omega.erase(std::unique(omega.begin(), omega.end(), same), omega.end());
    A.erase(std::unique(A.begin(), A.end(), same), A.end());
    REQUIRE(omega.size() == 2);  // A grows with omega between them
    REQUIRE(A.size() == 2);
    CHECK(omega[0] == Approx(1.0180097647).epsilon(0).margin(1e-10));
    CHECK(omega[1] == Approx(1.0728304789).epsilon(0).margin(1e-10));
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(planar(omega[i], A[i]) == Approx(1e-4).epsilon(1e-9));
      CHECK(std::abs(onset(omega[i], A[i])) < 1e-12);
    }
    CHECK(values(r.out, "LP", "omega").size() >= 2);
    const auto peak = values(r.out, "RP", "q1_h1");  // in plane A c w = F where the phase is a right angle, hardly below the largest
    CHECK(std::any_of(peak.begin(), peak.end(), [](double a) { return std::abs(a - 0.46) < 0.03; }));
  }
  SECTION("chart") {
    const Ran r = f.run_text(text, "--json");
    INFO(r.err);
    REQUIRE(r.status == 0);
    const auto F = values(r.out, "MIN", "F");
    REQUIRE_FALSE(F.empty());
    std::stringstream lines(r.out);
    int thresholds = 0;
    for (std::string line; std::getline(lines, line);) {
      std::smatch w, A, amplitude;
      if (line.find("\"type\": \"MIN\"") == std::string::npos || line.find("\"curve\": \"PF") == std::string::npos) continue;
      REQUIRE(std::regex_search(line, w, std::regex("\"omega\": ([-+0-9.eE]+)")));
      REQUIRE(std::regex_search(line, A, std::regex("\"q1_h1\": ([-+0-9.eE]+)")));
      REQUIRE(std::regex_search(line, amplitude, std::regex("\"F\": ([-+0-9.eE]+)")));
      const double omega = std::stod(w[1]), a = std::stod(A[1]), force = std::stod(amplitude[1]);
      CHECK(planar(omega, a) == Approx(force * force).epsilon(1e-9));
      CHECK(std::abs(onset(omega, a)) < 1e-12);
      for (const double step : {-1e-3, 1e-3}) {  // along the onset the force grows on either side
        const double b = a + step, x = 0.5 * b * b, w2 = 1.0 + x - 0.5 * c * c;
        // (1 - w^2 + x)^2 + c^2 w^2 = x^2/4, a quadratic in w^2
        const double root = std::sqrt(w2 * w2 - (1.0 + x) * (1.0 + x) + 0.25 * x * x);
        const double near = std::abs(w2 + root - omega * omega) < std::abs(w2 - root - omega * omega) ? w2 + root : w2 - root;
        CHECK(planar(std::sqrt(near), b) > force * force);
      }
      ++thresholds;
    }
    CHECK(thresholds == 1);
  }
}

TEST_CASE("an ansatz for a cable in a continuation: with enough harmonics the exact onset of whirling", "[continuation_study]") {
  const RunFolder f;
  std::string text = slurp(study("oresund-threshold.toml"));
  text = std::regex_replace(text, std::regex("\"two-parameter\""), "\"continuation\"");
  text = text.substr(0, text.find("[second]"));
  const Ran r = f.run_text(text + "\n[ansatz]\nkind = \"complete\"\nharmonics = 10\n", "--json --set continuation.range=[1.4,1.7]");
  INFO(r.err);
  REQUIRE(r.status == 0);
  const auto onset = values(r.out, "BP", "omega");
  CHECK(std::any_of(onset.begin(), onset.end(), [](double w) { return std::abs(w - 1.58096018215) < 1e-7; }));  // of the exact motion
  const Ran more = f.run_text(text, "--set support_motion.direction=vertical");
  CHECK(more.status == 2);
  CHECK(more.err.find("ansatz.kind = \"superharmonic\": has two modes, the upper end moved horizontally") != std::string::npos);
  std::string model = slurp(study("string-threshold.toml"));
  model = model.substr(0, model.find("[ansatz]")) + model.substr(model.find("[continuation]"));
  const Ran unchosen = f.run_text(model);
  CHECK(unchosen.status == 2);
  CHECK(unchosen.err.find("ansatz.kind = \"superharmonic\": is for a [cable]") != std::string::npos);
}

namespace {

const char* one_to_three = R"([modal_model]
frequency = [1.0, 3.05]
damping = [0.03, 0.05]
term = [
  { equation = 1, coefficient = 1.0, powers = [3, 0] },
  { equation = 1, coefficient = 1.2, powers = [2, 1] },
  { equation = 2, coefficient = 0.4, powers = [3, 0] },
  { equation = 2, coefficient = 1.0, powers = [0, 3] },
]
[[modal_model.force]]
equation = 1
amplitude = 0.2
harmonic = 1
name = "F"
[ansatz]
kind = "list"
q1 = [1.0, 3.0]
q2 = [1.0, 3.0]
[continuation]
parameter = "omega"
range = [0.6, 2.0]
)";

}  // namespace

TEST_CASE("zero-Hopf points where the real eigenvalue is born from a pair within the step", "[continuation_study][slow]") {
  const RunFolder f;
  const Ran r =
      f.run_text(std::string("study = \"two-parameter\"\n") + one_to_three + "[second]\nparameter = \"F\"\nrange = [0.02, 0.4]\n", "--json");
  INFO(r.err);
  REQUIRE(r.status == 0);
  // Newton on f = 0, det J = 0, det (J - i w) = 0; each stands on a curve of Hopf points at least
  const auto omega = values(r.out, "ZH", "omega"), F = values(r.out, "ZH", "F");
  REQUIRE(omega.size() >= 3);
  const double w[] = {1.6381441975, 1.6670266802, 1.8114874873}, force[] = {0.0805341527, 0.0851596198, 0.1133502697};
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(std::any_of(omega.begin(), omega.end(), [&](const double& at) {
      return std::abs(at - w[i]) < 2e-10 && std::abs(F[static_cast<std::size_t>(&at - omega.data())] - force[i]) < 2e-10;
    }));
}

TEST_CASE("averaged equations in a continuation: fast pairs are marked, forces outside the ansatz told", "[continuation_study]") {
  const RunFolder f;
  const Ran r = f.run_text(std::string("study = \"continuation\"\n") + one_to_three, "--json");
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.err.find("Hopf points marked \"fast\"") != std::string::npos);
  const Ran dropped = f.run_text(std::string("study = \"continuation\"\n") + one_to_three, "--set ansatz.q1=[3.0]");
  CHECK(dropped.err.find("the force on q1 at harmonic 1 is outside the ansatz") != std::string::npos);
}

TEST_CASE("the same study gives the same digits in every run", "[continuation_study]") {
  const RunFolder f;
  const std::string nerve = R"toml(study = "continuation"
[equilibrium_model]
variables = ["V", "w"]
parameters = { I = 0.0, gl = 2.0, vl = -60.0, gk = 8.0, vk = -84.0, gca = 4.0, vca = 120.0, C = 20.0, phi = 0.06666667 }
rhs = ["(I - gl*(V-vl) - gk*w*(V-vk) - gca*0.5*(1+tanh((V+1.2)/18))*(V-vca))/C", "phi*(0.5*(1+tanh((V-12)/17.4))-w)*cosh((V-12)/(2*17.4))"]
initial = [-60.0, 0.01]
[continuation]
parameter = "I"
range = [-50.0, 200.0]
)toml";
  const Ran first = f.run_text(nerve, "--json");
  REQUIRE(first.status == 0);
  for (int i = 0; i < 5; ++i) CHECK(f.run_text(nerve, "--json").out == first.out);
}

TEST_CASE("names and places that would lose data are refused", "[continuation_study]") {
  const RunFolder f;
  const auto study_of = [](const std::string& variable, const std::string& parameter, const std::string& more = "") {
    return "study = \"continuation\"\n[equilibrium_model]\nvariables = [\"" + variable + "\"]\nparameters = { " + parameter + " = 1.0 }\nrhs = [\"" +
           parameter + " - " + variable + "^2\"]\ninitial = [1.0]\n" + more + "[continuation]\nparameter = \"" + parameter +
           "\"\nrange = [0.5, 2.0]\n";
  };
  const std::pair<std::string, std::string> cases[] = {
      {study_of("residual", "p"), "equilibrium_model.variables"},
      {study_of("eig1_re", "p"), "equilibrium_model.variables"},
      {study_of("x", "frequency"), "equilibrium_model.parameters"},
      {study_of("x", "exp"), "equilibrium_model.parameters"},
      {study_of("x", "p", "amplitudes = { p = [\"x\"] }\n"), "equilibrium_model.amplitudes"},
      {study_of("x", "p") + "user_values = [5.0]\n", "continuation.user_values"},
      {study_of("x", "p") + "seeds = [1.0, 5.0]\n", "continuation.seeds"},
  };
  for (const auto& [text, expected] : cases) {
    const Ran r = f.run_text(text);
    INFO(text << r.err);
    CHECK(r.status == 2);
    CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
    CHECK(r.err.find(expected) != std::string::npos);
    CHECK_FALSE(f.has_result());
  }
  std::ofstream(f.path / "own.toml") << study_of("x", "p");
  const Ran own = program(f, "run own.toml -o own.toml");
  CHECK(own.status == 2);
  CHECK(slurp(f.path / "own.toml") == study_of("x", "p"));
  std::string unnamed = study_of("x", "p");
  unnamed.erase(unnamed.find("parameter = \"p\"\n"), 16);
  const Ran missing = f.run_text(unnamed);
  CHECK(missing.status == 2);
  CHECK(missing.err.find("continuation.parameter is missing: one of p") != std::string::npos);
}
