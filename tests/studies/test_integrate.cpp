// The kinds `integrate` and `basins` as a user meets them.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "studies/result_file.hpp"
#include "tests/studies/program.hpp"

namespace fs = std::filesystem;
using namespace whirl::studies;
using namespace whirl::studies::tests;

namespace {

const std::string folder = std::string(WHIRL_SOURCE_DIR) + "/studies/";
const std::string integrate = "run " + folder + "oresund-integrate.toml --set sweep.range=[] ";
const std::string basins = "run " + folder + "oresund-basins.toml --set basins.resolution=[15,11] --set basins.x_range=[-4.5,4.5] ";

std::size_t count(const std::string& s, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = s.find(what); at != std::string::npos; at = s.find(what, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("integrate: the published motions, their tables, JSON and CSV") {
  const Folder f;
  const Ran r = program(f, integrate + "--set integrate.omega=[1.65,2.15] --json -o o.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(count(r.out, "\"attractor\": \"A") == 8);  // four runs, four attractors
  CHECK(r.err.find('\r') == std::string::npos);
  const ResultReader file(f.path / "o.h5");
  const auto multiple = file.column("/integrate/attractors", "multiple").values;
  CHECK(multiple == std::vector<double>{1, 1, 2, 2});
  CHECK(file.text_column("/integrate/attractors", "mirror").values == std::vector<std::string>{"A2", "A1", "", ""});
  CHECK(file.column("/integrate/attractors", "q1_h2").values[0] == Approx(2.059).epsilon(0).margin(6e-4));
  CHECK(file.column("/integrate/attractors", "q2_h1").values[1] == Approx(1.567).epsilon(0).margin(6e-4));
  CHECK(file.column("/integrate/attractors", "q1_h1.5").values[2] == Approx(2.375).epsilon(0).margin(6e-4));  // coupled (3,2) motion
  CHECK(file.column("/integrate/attractors", "q1_h1.5").values[3] == Approx(0.0).epsilon(0).margin(1e-6));
  CHECK(file.column("/integrate/A3/section", "q1").values.size() == 2);
  CHECK(file.column("/integrate/A3/series", "q1'").values.size() == 256);
  CHECK(file.column("/integrate/run1", "t").values.size() == 40 * 128 + 1);
  CHECK(file.text_attribute("/study", "outcome") == "complete");
  CHECK(program(f, "export o.h5").status == 0);
  CHECK(fs::exists(f.path / "o-csv" / "integrate-attractors.csv"));
}

TEST_CASE("integrate: sweeps mark their jumps, another parameter may be swept", "[slow]") {
  const Folder f;
  const Ran r = program(f, "run " + folder +
                               "oresund-integrate.toml --set integrate.omega=[] --set sweep.range=[1.69,1.85] --set sweep.points=9 "
                               "--set sweep.tolerance=1e-4 --json -o o.h5");
  INFO(r.err << r.out);
  REQUIRE(r.status == 0);
  const ResultReader file(f.path / "o.h5");
  for (const auto& [way, fold] : {std::pair{"up", 1.82142291407}, std::pair{"down", 1.70366257099}}) {
    CHECK(file.column(std::string("/sweep/") + way, "omega").values.size() == 9);
    const std::string marks = std::string("/sweep/transitions_") + way;
    const auto before = file.column(marks, "before").values, after = file.column(marks, "after").values, jump = file.column(marks, "jump").values;
    REQUIRE(before.size() == 1);
    CHECK(jump[0] == 1.0);
    CHECK(std::min(before[0], after[0]) < fold);
    CHECK(std::max(before[0], after[0]) > fold);
  }
  const Ran u =
      program(f, "run " + folder +
                     "oresund-integrate.toml --set integrate.omega=[] --set omega=1.6003780 --set sweep.parameter=support_motion.amplitude "
                     "--set sweep.range=[0.29,0.34] --set sweep.points=6 --set 'sweep.directions=[\"up\"]' --set sweep.tolerance=1e-3 -o u.h5");
  INFO(u.err);
  REQUIRE(u.status == 0);
  const ResultReader amplitude(f.path / "u.h5");  // whirling starts at 0.318111237 m
  const auto q1 = amplitude.column("/sweep/up", "q1_rms").values;
  REQUIRE(q1.size() == 6);
  CHECK(q1[2] < 1e-6);
  CHECK(q1[4] > 0.05);
}

TEST_CASE("basins: shares, numbers, symmetry, accuracy, the same with one thread", "[slow]") {
  const Folder f;
  const Ran r = program(f, basins + "--set basins.check_share=0.2 --json -o o.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  const ResultReader file(f.path / "o.h5");
  const auto map = file.column("/basins/map", "attractor").values;
  REQUIRE(map.size() == 165);
  for (std::size_t j = 0; j < 11; ++j)
    for (std::size_t i = 0; i < 15; ++i) CHECK(map[15 * j + i] == map[15 * j + 14 - i]);
  CHECK(file.scalar("/basins", "integrated").value == 88.0);
  CHECK(file.scalar("/basins", "checked").value >= 17.0);
  CHECK(file.scalar("/basins", "disagreed").value == 0.0);
  const auto share = file.column("/basins/attractors", "share").values;
  REQUIRE(share.size() == 2);
  CHECK(share[0] + share[1] == Approx(1.0));
  CHECK(share[1] == Approx(double(std::count(map.begin(), map.end(), 2.0)) / 165.0));
  CHECK(file.column("/basins/points", "attractor").values == std::vector<double>{1, 1, 2, 2});
  CHECK(count(r.out, "\"number\": ") == 2);
  REQUIRE(program(f, basins + "--set basins.threads=1 --set basins.check_share=0 -o one.h5").status == 0);
  CHECK(ResultReader(f.path / "one.h5").column("/basins/map", "attractor").values == map);
  REQUIRE(program(f, basins + "--set basins.use_symmetry=false -o whole.h5").status == 0);
  CHECK(ResultReader(f.path / "whole.h5").column("/basins/map", "attractor").values == map);
}

TEST_CASE("basins: Ctrl-C leaves a readable file with the starts decided so far") {
  const Folder f;
  const std::string many = "oresund-basins.toml --set basins.resolution=[900,900] -o o.h5";
  const Ran r = interrupted_program(f, "run " + folder + many, "", std::chrono::seconds(3 * slower));
  INFO(r.err);
  CHECK(r.status == 130);
  const ResultReader file(f.path / "o.h5");
  CHECK(file.text_attribute("/study", "outcome") == "interrupted");
  const auto map = file.column("/basins/map", "attractor").values;
  CHECK(std::count(map.begin(), map.end(), -2.0) > 0);
  CHECK(std::count_if(map.begin(), map.end(), [](double a) { return a > 0.0; }) > 0);
}

TEST_CASE("integrate and basins: bad input gives one line, status 2, no file") {
  const Folder f;
  const std::pair<std::string, std::string> cases[] = {
      {integrate + "--set integrate.starts=[1.0]", "integrate.starts"},
      {integrate + "--set integrate.states=[1.0,2.0]", "4 values"},
      {integrate + "--set integrate.omega=[]", "nothing to do"},
      {integrate + "--set integrate.starts=[]", "at least one start"},
      {integrate + "--set sweep.range=[2.0,1.0]", "increasing"},
      {integrate + "--set sweep.range=[1.0,2.0] --set sweep.parameter=omga", "did you mean omega?"},
      {integrate + "--set sweep.range=[4e6,7e6] --set sweep.parameter=chord_tension", "set omega"},
      {integrate + "--set integration.relative_tolerance=1", "integration.relative_tolerance"},
      {basins + "--set 'basins.axes=[\"q1\",\"q3\"]'", "q1, q2, q1', q2'"},
      {basins + "--set 'basins.axes=[\"q1\",\"q1\"]'", "two different"},
      {basins + "--set basins.y_range=[1.0,-1.0]", "basins.y_range"},
      {basins + "--set basins.resolution=[10.5,10]", "whole numbers"},
      {basins + "--set basins.at=[1.0]", "basins.at"},
      {basins + "--set basins.omega=-1", "basins.omega"},
  };
  for (const auto& [arguments, expected] : cases) {
    const Ran r = program(f, arguments + " -o x.h5");
    INFO(arguments << "\n" << r.err);
    CHECK(r.status == 2);
    CHECK(count(r.err, "\n") == 1);
    CHECK(r.err.find(expected) != std::string::npos);
    CHECK_FALSE(fs::exists(f.path / "x.h5"));
  }
}

TEST_CASE("integrate and basins: starts, axes and words follow the model") {
  const Folder f;
  const std::string stay =
      "[cable]\nchord_length = 260.0\naxial_stiffness = 2.17e9\nchord_tension = 5.5e6\nmass_per_length = 81.05\ninclination_deg = 30.4\n"
      "[model]\nkind = \"multi-mode\"\nout_of_plane_modes = 1\nin_plane_modes = 2\n[damping]\nout_of_plane = 0.02\nin_plane = 0.02\n"
      "[support_motion]\namplitude = 0.5\n";
  const std::string one = "[modal_model]\nfrequency = [1.0]\ndamping = [0.2]\n[[modal_model.force]]\nequation = 1\namplitude = 0.1\nharmonic = 1\n";
  const auto write = [&](const std::string& name, const std::string& text) { std::ofstream(f / name) << text; };
  const std::string grid = "[basins]\nomega = 1.5\nresolution = [3, 3]\nx_range = [-1.0, 1.0]\ny_range = [-1.0, 1.0]\n";

  write("many.toml", "study = \"basins\"\n" + stay + grid);
  Ran r = program(f, "run many.toml -o many.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(ResultReader(f / "many.h5").texts_attribute("/basins", "axes") == std::vector<std::string>{"y1", "z1"});
  write("one.toml", "study = \"basins\"\n" + one + grid);
  REQUIRE(program(f, "run one.toml -o one.h5").status == 0);
  CHECK(ResultReader(f / "one.h5").texts_attribute("/basins", "axes") == std::vector<std::string>{"q1", "q1'"});

  // One coordinate: two starts, each once. A start given twice is run once.
  write("single.toml", "study = \"integrate\"\n" + one + "[integrate]\nomega = [1.5]\n");
  REQUIRE(program(f, "run single.toml -o single.h5").status == 0);
  CHECK(ResultReader(f / "single.h5").text_column("/integrate/runs", "start").values == std::vector<std::string>{"q1 = 3", "q1 = 10"});
  REQUIRE(program(f, "run single.toml --set integrate.starts=[1.0,2.0,1.0] -o twice.h5").status == 0);
  CHECK(ResultReader(f / "twice.h5").text_column("/integrate/runs", "start").values == std::vector<std::string>{"q1 = 1", "q1 = 2"});

  // Three modes: the sweep names the coordinate that starts to whirl; the recorded motion has its tension.
  write("modes.toml", "study = \"integrate\"\n" + stay +
                          "[integrate]\nomega = [1.62]\n[sweep]\nrange = [1.55, 1.62]\npoints = 3\ntolerance = 0.01\n"
                          "directions = [\"up\"]\n");
  r = program(f, "run modes.toml -o modes.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  const ResultReader file(f / "modes.h5");
  CHECK(file.text_column("/integrate/runs", "start").values == std::vector<std::string>{"y1 = 3", "y1 = 10, z1 = 10"});
  CHECK(count(r.err, "q1") == 0);
  const auto T = file.column("/integrate/A1/series", "tension").values;
  CHECK(*std::max_element(T.begin(), T.end()) > 5.5e6);
  CHECK(*std::min_element(T.begin(), T.end()) < 5.5e6);
}
