// The program as a user meets it: exit statuses, one-line errors, JSON, files left behind.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "studies/registry.hpp"
#include "studies/result_file.hpp"
#include "tests/studies/program.hpp"

namespace fs = std::filesystem;
using namespace whirl::studies;
using namespace whirl::studies::tests;

namespace {

const std::string oresund = std::string(WHIRL_SOURCE_DIR) + "/studies/oresund-superharmonic.toml";
const std::string quick = " --set verification.enabled=false ";

std::size_t lines(const std::string& s) { return static_cast<std::size_t>(std::count(s.begin(), s.end(), '\n')); }

// All numbers of a key in a JSON text.
std::vector<double> numbers(const std::string& json, const std::string& type, const std::string& key) {
  std::vector<double> values;
  std::stringstream s(json);
  for (std::string line; std::getline(s, line);) {
    if (line.find("\"type\": \"" + type + "\"") == std::string::npos) continue;
    std::smatch m;
    if (std::regex_search(line, m, std::regex("\"" + key + "\": ([-+0-9.eE]+)"))) values.push_back(std::stod(m[1]));
  }
  return values;
}

}  // namespace

TEST_CASE("the main study: special points as JSON, a readable file, CSV") {
  const Folder f;
  const Ran r = program(f, "run " + oresund + quick + "--json -o o.h5");
  REQUIRE(r.status == 0);
  const auto bp = numbers(r.out, "BP", "omega"), lp = numbers(r.out, "LP", "omega"), hb = numbers(r.out, "HB", "omega");
  REQUIRE(bp.size() == 3);  // two on the in-plane branch, one of them again where the whirling branch ends
  CHECK(bp[0] == Approx(1.6118571561).epsilon(1e-10));
  CHECK(bp[1] == Approx(1.9013687861).epsilon(1e-10));
  REQUIRE(lp.size() == 4);
  CHECK(lp[0] == Approx(1.7766151904).epsilon(1e-10));
  CHECK(hb.size() == 2);
  CHECK(numbers(r.out, "BP", "q2_h2")[0] == Approx(2.51506249).epsilon(5e-9));  // printed to 9 digits
  CHECK(r.out.find("\"branches\": [") != std::string::npos);
  ResultReader file(f.path / "o.h5");
  CHECK(file.text_attribute("/study", "kind") == "superharmonic");
  CHECK(file.text_attribute("/study", "outcome") == "complete");
  CHECK(file.scalar("/cable", "irvine_lambda2").value == Approx(0.414643984992).epsilon(1e-11));
  CHECK(file.column("/branches/W1", "q1_h2").values.size() > 50);
  const Ran e = program(f, "export o.h5");
  REQUIRE(e.status == 0);
  CHECK(fs::exists(f.path / "o-csv" / "branches-IP1.csv"));
  CHECK(fs::exists(f.path / "o-csv" / "special_points.csv"));
}

TEST_CASE("U = 0.15 m: one branch, no special point") {
  const Folder f;
  const Ran r = program(f, "run " + oresund + quick + "--json --set support_motion.amplitude=0.15 -o o.h5");
  REQUIRE(r.status == 0);
  CHECK(r.out.find("\"type\": \"") == std::string::npos);  // of a special point; the table of none has a column "type"
  CHECK(r.out.find("\"IP1\"") != std::string::npos);
  CHECK(r.out.find("\"IP2\"") == std::string::npos);
}

TEST_CASE("any numeric key can be continued in") {
  const Folder f;
  for (const std::string parameter : {"support_amplitude", "support_motion.amplitude"}) {
    const Ran r = program(f, "run " + oresund + quick + "--json --set omega=1.6118571560642 --set continuation.parameter=" + parameter +
                                 " --set continuation.range=[0.05,0.8] -o o.h5");
    INFO(r.err);
    REQUIRE(r.status == 0);
    const auto bp = numbers(r.out, "BP", parameter);
    REQUIRE(bp.size() >= 1);
    CHECK(std::any_of(bp.begin(), bp.end(), [](double U) { return std::abs(U - 0.5) < 1e-9; }));
  }
  const Ran r = program(
      f, "run " + oresund + quick + "--json --set omega=1.7 --set continuation.parameter=chord_tension --set continuation.range=[4e6,7e6] -o o.h5");
  INFO(r.err);
  CHECK(r.status == 0);
}

TEST_CASE("init prints a study that check and run accept") {
  const Folder f;
  for (const auto& kind : study_kinds()) {
    const Ran init = program(f, "init " + kind.schema.kind());
    REQUIRE(init.status == 0);
    std::ofstream(f.path / "my.toml") << init.out;
    const Ran check = program(f, "check my.toml");
    INFO(kind.schema.kind() << "\n" << check.err);
    CHECK(check.status == 0);
    CHECK(slurp(f.path / "my.toml").size() > 200);
  }
  const Ran list = program(f, "list");
  CHECK(list.out.find("superharmonic") != std::string::npos);
  CHECK(program(f, "check " + oresund).status == 0);
  CHECK(program(f, "--version").out.find("whirl 0.") != std::string::npos);
  CHECK(program(f, "--help").out.find("export") != std::string::npos);
}

TEST_CASE("bad input: one clear line, exit status 2, nothing written") {
  const Folder f;
  std::ofstream(f.path / "broken.toml") << "study = \"superharmonic\"\n[cable\n";
  std::ofstream(f.path / "text.h5") << "not a result";
  fs::create_directory(f.path / "folder");
  const std::string run = "run " + oresund + quick;
  const std::pair<std::string, std::string> cases[] = {
      {"run missing.toml", "missing.toml"},
      {"run folder", "folder"},
      {"run broken.toml", "broken.toml:2"},
      {run + "--set cable.chord_tention=1 -o x.h5", "did you mean cable.chord_tension?"},
      {run + "--set cable.chord_tension=-5 -o x.h5", "cable.chord_tension = -5"},
      {run + "--set cable.chord_tension=nan -o x.h5", "finite"},
      {run + "--set 'cable.chord_tension=\"tight\"' -o x.h5", "cable.chord_tension"},
      {run + "--set cable.chord_tension=1e5 -o x.h5", "parabola's range"},
      {run + "--set continuation.range=[2.4,1.2] -o x.h5", "must be increasing"},
      {run + "--set continuation.parameter=omga -o x.h5", "did you mean omega"},
      {run + "--set verification.starts=[1.0] -o x.h5", "even number"},
      {run + "-o /no/such/folder/x.h5", "/no/such/folder"},
      {run + "-o folder", "folder"},
      {"init nonsense", "unknown study kind"},
      {"export missing.h5", "missing.h5"},
      {"export text.h5", "text.h5"},
      {"export folder", "folder"},
  };
  for (const auto& [arguments, expected] : cases) {
    const Ran r = program(f, arguments);
    INFO(arguments << "\n" << r.err);
    CHECK(r.status == 2);
    CHECK(lines(r.err) == 1);
    CHECK(r.err.find(expected) != std::string::npos);
    CHECK_FALSE(fs::exists(f.path / "x.h5"));
  }
  for (const std::string arguments : {"run", "", "runn", "run a.toml --nonsense", "run a.toml b.toml"}) {  // the command line itself
    const Ran r = program(f, arguments);
    INFO(arguments << "\n" << r.err);
    CHECK(r.status == 2);
    CHECK(lines(r.err) == 1);
    CHECK(r.err.find("see whirl --help") != std::string::npos);
  }
}

TEST_CASE("a truncated result file is refused") {
  const Folder f;
  REQUIRE(program(f, "run " + oresund + quick + "-o o.h5").status == 0);
  fs::resize_file(f.path / "o.h5", fs::file_size(f.path / "o.h5") / 2);
  const Ran r = program(f, "export o.h5");
  CHECK(r.status == 2);
  CHECK(lines(r.err) == 1);
  CHECK_FALSE(fs::exists(f.path / "o-csv"));
}

TEST_CASE("Ctrl-C keeps the results so far and ends with status 130") {
  const Folder f;
  const std::string endless = " --set verification.max_periods=90000000 --set verification.tolerance=1e-15 -o o.h5";
  const Ran r = interrupted_program(f, "run " + oresund + endless, "W1      HB", std::chrono::milliseconds(200));
  INFO(r.err);
  CHECK(r.status == 130);
  ResultReader file(f.path / "o.h5");
  CHECK(file.has("/branches/W1"));
  CHECK(file.text_attribute("/study", "outcome") == "interrupted");
}

TEST_CASE("progress stays out of a pipe") {
  const Folder f;
  const Ran r = program(f, "run " + oresund + quick + "-o o.h5");
  CHECK(r.err.find('\r') == std::string::npos);
  CHECK(r.out.find('\r') == std::string::npos);
}
