// The kinds `periodic` and `compare` as a user runs them.
#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "studies/result_file.hpp"
#include "tests/studies/program.hpp"

using namespace whirl::studies;
using namespace whirl::studies::tests;
namespace fs = std::filesystem;

namespace {

// Output and messages together.
Ran run(const std::string& arguments) {
  const Folder f;
  Ran r = program(f, arguments);
  r.out += r.err;
  return r;
}

fs::path scratch(const std::string& name) {
  const fs::path folder = fs::temp_directory_path() / ("whirl-exact-" + std::to_string(getpid()));
  fs::create_directories(folder);
  return folder / name;
}

fs::path write(const std::string& name, const std::string& text) {
  const fs::path path = scratch(name);
  std::ofstream(path) << text;
  return path;
}

const std::string inputs = std::string(WHIRL_SOURCE_DIR) + "/studies/";

double omega_of(const ResultReader& file, const std::string& branch, const std::string& label) {
  const auto names = file.text_column("/special_points", "branch").values, labels = file.text_column("/special_points", "label").values;
  const auto omega = file.column("/special_points", "omega").values;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == branch && labels[i] == label) return omega[i];
  return 0.0;
}

}  // namespace

TEST_CASE("periodic: the Oresund stay about its whirling point, motions checked by integration", "[slow]") {
  const fs::path result = scratch("periodic.h5");
  const Ran r = run("run " + inputs + "oresund-periodic.toml -o " + result.string() +
                    " --quiet --set continuation.range=[1.5,1.7] --set verification.omega=[1.65] --set second.range=[] --set seeds.grid=3 --set "
                    "periodic.tolerance=1e-11");
  INFO(r.out);
  REQUIRE(r.status == 0);
  const ResultReader file(result);
  CHECK(omega_of(file, "IP1", "BP1") == Approx(1.58096018215).epsilon(0).margin(1e-10));
  CHECK(file.number_attribute("/branches/W1", "truncation_error") < 1e-11);
  for (const double defect : file.column("/verification/orbits", "defect").values) CHECK(defect < 3e-9);  // CVODE at 1e-11 over a period
  for (const double error : file.column("/verification/orbits", "multiplier_error").values) CHECK(error < 1e-8);
  // Physics of the stay at 1.65 rad/s, three decimals: the whirling motion's harmonics.
  const auto branch = file.text_column("/verification/orbits", "branch").values;
  CHECK(std::count(branch.begin(), branch.end(), "W1") == 1);
}

TEST_CASE("periodic: the whole Oresund study with its chart, past the degenerate point of the whirling folds", "[slow]") {
  const fs::path result = scratch("chart.h5");
  const Ran r = run("run " + inputs + "oresund-periodic.toml -o " + result.string() + " --quiet");
  INFO(r.out);
  REQUIRE(r.status == 0);
  const ResultReader file(result);
  CHECK(omega_of(file, "IP1", "BP1") == Approx(1.58096018215).epsilon(0).margin(1e-10));
  const auto types = file.text_column("/special_points", "type").values;
  CHECK(std::count(types.begin(), types.end(), "unresolved") == 0);
  const auto curves = file.text_column("/curve_points", "curve").values, kinds = file.text_column("/curve_points", "type").values;
  const auto omega = file.column("/curve_points", "omega").values, U = file.column("/curve_points", "support_motion.amplitude").values;
  const auto at = [&](const std::string& curve, const std::string& kind) {
    for (std::size_t i = 0; i < kinds.size(); ++i)
      if (curves[i].starts_with(curve) && kinds[i] == kind) return std::pair{omega[i], U[i]};
    return std::pair{0.0, 0.0};
  };
  CHECK(at("WH", "MIN").first == Approx(1.6003560996).epsilon(0).margin(1e-9));
  CHECK(at("WH", "MIN").second == Approx(0.318111203383).epsilon(0).margin(1e-11));
  // Period doublings out of plane and in plane cross in one point of both curves.
  std::vector<std::pair<double, double>> crossings;
  for (std::size_t i = 0; i < kinds.size(); ++i)
    if (curves[i].starts_with("PD") && kinds[i] == "PP") crossings.emplace_back(omega[i], U[i]);
  REQUIRE(crossings.size() == 2);
  CHECK(crossings[0].first == Approx(crossings[1].first).epsilon(0).margin(1e-9));
  CHECK(crossings[0].second == Approx(crossings[1].second).epsilon(0).margin(1e-9));
}

TEST_CASE("periodic: a modal model, the exact folds of the Duffing oscillator", "[published]") {
  // x'' + .05 x' + x + .1 x^3 = .18 cos wt: folds of the exact periodic response.
  const fs::path study = write("duffing.toml", R"(
study = "periodic"
[modal_model]
frequency = [1.0]
damping = [0.05]
[[modal_model.term]]
equation = 1
coefficient = 0.1
powers = [3]
[[modal_model.force]]
equation = 1
amplitude = 0.18
harmonic = 1
[continuation]
range = [0.8, 1.5]
)");
  const fs::path result = scratch("duffing.h5");
  const Ran r = run("run " + study.string() + " -o " + result.string() + " --quiet");
  INFO(r.out);
  REQUIRE(r.status == 0);
  const ResultReader file(result);
  CHECK(omega_of(file, "B1", "LP1") == Approx(1.269601956).epsilon(0).margin(1e-9));
  CHECK(omega_of(file, "B1", "LP2") == Approx(1.115700252).epsilon(0).margin(1e-9));
}

TEST_CASE("periodic: eight modes, the leading coordinates are printed and the tension stands in the file", "[slow]") {
  const fs::path study = write("eight.toml", R"(
study = "periodic"
[cable]
chord_length = 260.0
axial_stiffness = 2.17e9
chord_tension = 5.5e6
mass_per_length = 81.05
inclination_deg = 30.4
[model]
kind = "multi-mode"
out_of_plane_modes = 4
in_plane_modes = 4
longitudinal = "quasi-static"
terms = "full"
[damping]
out_of_plane = 0.01
in_plane = 0.01
[support_motion]
amplitude = 0.4
[continuation]
range = [1.56, 1.6]
[seeds]
grid = 2
[verification]
omega = [1.595]
)");
  const fs::path result = scratch("eight.h5");
  const Ran r = run("run " + study.string() + " -o " + result.string());
  INFO(r.out);
  REQUIRE(r.status == 0);
  CHECK(r.out.find("z1_max") != std::string::npos);
  CHECK(r.out.find("y2_max") == std::string::npos);
  const ResultReader file(result);
  CHECK(omega_of(file, "IP1", "BP1") == Approx(1.58365713817).epsilon(0).margin(1e-9));  // elimination without sweeps gave the same
  // Whirling motion carried over a period by CVODE, its multipliers beside the swept ones.
  for (const double d : file.column("/verification/orbits", "multiplier_error").values) CHECK(d < 1e-7);
  const auto branches = file.text_column("/verification/orbits", "branch").values;
  for (std::size_t i = 0; i < branches.size(); ++i) {
    const std::string group = "/verification/motions/00" + std::to_string(i + 1);
    const auto T = file.column(group, "tension").values;
    const double largest = *std::max_element(T.begin(), T.end());
    const auto omega = file.column("/branches/" + branches[i], "omega").values, top = file.column("/branches/" + branches[i], "tension_max").values;
    std::size_t nearest = 0;
    for (std::size_t k = 0; k < omega.size(); ++k)
      if (std::abs(omega[k] - 1.595) < std::abs(omega[nearest] - 1.595)) nearest = k;
    CHECK(top[nearest] == Approx(largest).epsilon(5e-3));  // a step of the branch away
  }
}

TEST_CASE("periodic: bad input is one line and leaves nothing behind") {
  const fs::path result = scratch("none.h5");
  const auto refused = [&](const std::string& set, const std::string& words) {
    const Ran r = run("run " + inputs + "oresund-periodic.toml -o " + result.string() + " --set " + set);
    INFO(r.out);
    CHECK(r.status == 2);
    CHECK(r.out.find(words) != std::string::npos);
    CHECK(std::count(r.out.begin(), r.out.end(), '\n') == 1);
    CHECK_FALSE(fs::exists(result));
  };
  refused("periodic.nu=0", "periodic.nu = 0");
  refused("second.parameter=omega", "must differ from continuation.parameter");
  refused("second.range=[0.6,0.7]", "must contain the value 0.5");
  refused("verification.omega=[9]", "must lie in continuation.range");
  refused("seeds.starts=[1,2,3]", "seeds.starts");
  refused("continuation.parameter=omegaa", "did you mean omega");
}

TEST_CASE("compare: every special point matched or told to be alone, and a sentence", "[slow]") {
  const fs::path result = scratch("compare.h5");
  const Ran r = run("run " + inputs + "oresund-compare.toml -o " + result.string() +
                    " --set continuation.range=[1.5,1.75] --set sweep.points=0 --set map.values=[0.05,0.3] --set map.points=9 --set seeds.grid=5");
  INFO(r.out);
  REQUIRE(r.status == 0);
  const ResultReader file(result);
  const auto kinds = file.text_column("/compare/points", "kind").values, found = file.text_column("/compare/points", "found").values;
  const auto exact = file.column("/compare/points", "omega_exact").values, shift = file.column("/compare/points", "shift_frozen").values,
             complete = file.column("/compare/points", "shift_complete").values;
  bool whirling = false, fold = false;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] == "WH" && std::abs(exact[i] - 1.58096018) < 1e-7) {
      whirling = true;
      CHECK(found[i] == "all");
      CHECK(shift[i] == Approx(1.61185715606 - 1.58096018215).epsilon(0).margin(1e-9));  // both are known
      CHECK(std::abs(complete[i]) < 1e-6);                                               // eight harmonics
    }
    if (kinds[i] == "LP" && std::abs(exact[i] - 1.70366257) < 1e-7) {
      fold = true;  // the averaged one lies at 1.7766, outside this range
      CHECK(found[i] == "not frozen");
    }
  }
  CHECK(whirling);
  CHECK(fold);
  CHECK(file.number_attribute("/compare", "trusted_up_to") == 0.05);
  CHECK(r.out.find("trust the averaged curve below support_motion.amplitude = 0.05") != std::string::npos);
}
