// The studies of hanging cables as a user meets them.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "studies/result_file.hpp"
#include "tests/studies/program.hpp"

namespace fs = std::filesystem;
using namespace whirl::studies;
using namespace whirl::studies::tests;

namespace {

std::string study(const std::string& name) { return std::string(WHIRL_SOURCE_DIR) + "/studies/" + name + ".toml "; }

// Every number of a key in a JSON text.
std::vector<double> numbers(const std::string& json, const std::string& key) {
  std::vector<double> values;
  const std::regex pattern("\"" + key + "\": ([-+0-9.eE]+)");
  for (auto m = std::sregex_iterator(json.begin(), json.end(), pattern); m != std::sregex_iterator(); ++m) values.push_back(std::stod((*m)[1]));
  return values;
}

}  // namespace

TEST_CASE("catenary-modes: frequencies in SI and as ratios, shapes, sweep, series") {
  const Folder f;
  // b/sqrt(l^2 - h^2) = 0.9, h = b/2, inextensible: a row of the source's Table B-3, corrected.
  const Ran r = program(f, "run " + study("catenary-modes") + "--json --set sweep.points=3 -o m.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(numbers(r.out, "omega_ratio").size() == 16);
  CHECK(r.out.find("\"complete\": true") != std::string::npos);
  ResultReader file(f.path / "m.h5");
  CHECK(file.scalar("/cable", "sag_parameter").value == Approx(0.9).epsilon(1e-8));
  const double unit = file.scalar("/cable", "frequency_unit").value;
  const Table t = file.table("/modes/in_plane");
  CHECK(t.columns[1].values[0] == Approx(numbers(r.out, "omega_ratio")[0] * unit).epsilon(1e-12));
  CHECK(t.columns[2].values[0] == Approx(t.columns[1].values[0] / (2.0 * 3.14159265358979324)).epsilon(1e-12));
  CHECK(file.column("/modes/in_plane", "decay").values[0] == Approx(0.025).epsilon(0.2));  // drag 0.5 over twice 10 kg/m, less its tangential share
  CHECK(file.column("/modes/damped", "decay").values[7] == Approx(0.025).epsilon(0.2));
  CHECK(file.column("/modes/damped", "damping_ratio").values[0] ==
        Approx(0.025 / file.column("/modes/damped", "damped_omega").values[0]).epsilon(0.2));
  const auto amplitude = file.column("/shapes/damped/mode3", "V").values, phase = file.column("/shapes/damped/mode3", "V_phase").values;
  CHECK(*std::max_element(amplitude.begin(), amplitude.end()) == Approx(0.99).margin(0.02));
  CHECK(*std::max_element(phase.begin(), phase.end()) != *std::min_element(phase.begin(), phase.end()));  // unequal drag: not in step
  CHECK(file.column("/shapes/in_plane/mode3", "V").values.front() == Approx(0.0).epsilon(0).margin(1e-9));
  CHECK(file.column("/sweep/out_of_plane/h0.5", "w1").values.size() == 3);

  std::ofstream(f.path / "stiff.toml") << "study = \"catenary-modes\"\n[cable]\nspan = 100\nheight_difference = 50\nlength = 121.842845552563\n"
                                          "mass_per_length = 10\n[series]\ncompare = true\n";
  const Ran stiff = program(f, "run stiff.toml --json -o s.h5");
  INFO(stiff.err);
  REQUIRE(stiff.status == 0);
  const double printed[] = {3.13296809319, 4.97860823666, 6.92395904678, 8.68910318782, 10.5504741629, 12.3095496431, 14.1423833465, 15.9023567805};
  for (std::size_t k = 0; k < 8; ++k) CHECK(numbers(stiff.out, "omega_ratio")[k] == Approx(printed[k]).epsilon(1e-10));
  ResultReader s(f.path / "s.h5");
  for (const double d : s.column("/series/in_plane", "difference").values) CHECK(std::abs(d) < 1e-9);
}

TEST_CASE("catenary-forced: resonance, motion along the cable, phases") {
  const Folder f;
  const Ran r = program(f, "run " + study("catenary-forced") + "--json --set response.points=60 -o c.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.err.find("slack") != std::string::npos);
  ResultReader file(f.path / "c.h5");
  const auto U = file.column("/motions/w0.8/h1", "U").values, U2 = file.column("/motions/w0.8/h2", "U").values;
  CHECK(U.front() == Approx(0.0).epsilon(0).margin(1e-12));
  CHECK(U.back() == Approx(0.5).epsilon(1e-12));
  CHECK(U2.back() == Approx(0.1).epsilon(1e-12));
  CHECK(file.column("/motions/w0.8/h2", "U_phase").values.back() == Approx(1.5707963267948966));
  CHECK(file.column("/resonance", "tension").values.size() > 100);  // more than the 60 asked for
  CHECK(file.number_attribute("/motions/w0.8", "omega") == 0.8);
  // A vertical motion has both parts; together they are the amplitude.
  const Ran v = program(f, "run " + study("catenary-forced") +
                               "--set end_motion.tangential=[] --set end_motion.tangential_phase_deg=[] "
                               "--set end_motion.vertical=[0.3] --set response.points=2 -o v.h5");
  REQUIRE(v.status == 0);
  ResultReader vertical(f.path / "v.h5");
  CHECK(std::hypot(vertical.column("/motions/w0.8/h1", "U").values.back(), vertical.column("/motions/w0.8/h1", "V").values.back()) == Approx(0.3));
}

TEST_CASE("catenary-forced: resonances as narrow as the drag makes them") {
  const Folder f;
  std::ofstream(f / "light.toml") << R"(study = "catenary-forced"
[cable]
span = 100.0
height_difference = 20.0
length = 120.0
mass_per_length = 10.0
[drag]
tangential = 0.001
normal = 0.001
lateral = 0.001
[end_motion]
tangential = [0.01]
[response]
range = [0.1, 2.0]
points = 50
at = [1.7506400565, 1.7506400566]
)";
  const Ran r = program(f, "run light.toml --json -o l.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(numbers(r.out, "omega").at(0) == Approx(1.75064003).epsilon(1e-8));
  CHECK(numbers(r.out, "tension").at(0) == Approx(15964.49).epsilon(1e-5));  // as `at` gives it to seven digits next to it
  {
    const ResultReader file(f / "l.h5");
    CHECK(file.has("/motions/w1.7506400565"));
    CHECK(file.has("/motions/w1.7506400566"));
    const auto T = file.column("/resonance", "tension").values;
    CHECK(*std::max_element(T.begin(), T.end()) > 0.999 * 15964.49);
    const auto along = file.column("/motions/w1.7506400565/h1", "tension").values;  // the motion next to the peak, at 201 points
    CHECK(numbers(r.out, "tension").at(0) == Approx(*std::max_element(along.begin(), along.end())).epsilon(1e-3));
  }
  // Without drag there is no largest value, and a motion at a natural frequency is none.
  const Ran undamped = program(f, "run light.toml --json --set drag.tangential=0.0 --set drag.normal=0.0 -o u.h5");
  CHECK(undamped.status == 1);
  CHECK(undamped.err.find("unbounded") != std::string::npos);
  CHECK(undamped.out.find("\"bounded\": false") != std::string::npos);
  CHECK(ResultReader(f / "u.h5").text_attribute("/study", "outcome") == "partial");
  const Ran coarse = program(f, "run light.toml --json --set response.refine=false --set response.at=[] -o c.h5");
  CHECK(numbers(coarse.out, "points").at(0) == 50.0);
  const Ran lateral = program(f, "run light.toml --set end_motion.tangential=[] --set end_motion.out_of_plane=[0.01] --set response.at=[] -o w.h5");
  CHECK(lateral.status == 0);
  CHECK(lateral.out.find("largest displacement out of plane") != std::string::npos);
  CHECK(lateral.out.find("dynamic tension") == std::string::npos);
  const Ran high = program(f, "run light.toml --set response.at=[1e5] -o h.h5");
  CHECK(high.status == 2);
  CHECK(high.err.find("response.at") != std::string::npos);
  CHECK(high.err.find("must lie below") != std::string::npos);
  CHECK_FALSE(fs::exists(f / "h.h5"));
}

TEST_CASE("a hanging cable's frequencies at once, failures told in the file") {
  const Folder f;
  const Ran r = program(f, "modes " + study("catenary-modes"));
  CHECK(r.status == 0);
  CHECK(r.out.find("none is missing") != std::string::npos);
  const Ran soft = program(f, "run " + study("catenary-modes") + "--set cable.axial_stiffness=1e-20 -o s.h5");
  CHECK(soft.status == 1);
  const ResultReader file(f / "s.h5");
  CHECK(file.text_attribute("/study", "outcome") == "failed");
  CHECK(file.text_attribute("/study", "stop_reasons").find("positive definite") != std::string::npos);
  for (const std::string refused : {"cable.span=1e200", "modes.points=1"}) {
    const Ran bad = program(f, "run " + study("catenary-modes") + "--set " + refused + " -o b.h5");
    INFO(refused << ": " << bad.err);
    CHECK(bad.status == 2);
    CHECK(std::count(bad.err.begin(), bad.err.end(), '\n') == 1);
    CHECK_FALSE(fs::exists(f / "b.h5"));
  }
}

TEST_CASE("veering: crossings by both ways, least gap, hybrid modes") {
  const Folder f;
  const Ran r = program(f, "run " + study("veering") + "--json --set veering.points=12 --set veering.height_over_span=[0.0,0.1] -o v.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  const std::string points = r.out.substr(r.out.find("special_points"));  // the cable stands before them
  const auto kappa = numbers(points, "flexibility"), gap = numbers(points, "gap");
  CHECK(kappa.at(0) == Approx(0.00949701628833).epsilon(1e-10));
  CHECK(gap.at(0) == 0.0);
  ResultReader file(f.path / "v.h5");
  const auto walked = file.column("/crossings", "flexibility").values;
  for (const double expected : {0.00949701628833, 0.00222565573064})
    CHECK(std::any_of(walked.begin(), walked.end(), [&](double k) { return std::abs(k / expected - 1.0) < 1e-9; }));
  CHECK(std::any_of(gap.begin(), gap.end(), [](double g) { return std::abs(g - 0.0177603) < 1e-6; }));
  CHECK(file.number_attribute("/hybrid/h0.1/closest", "odd_lower") == Approx(0.5).epsilon(0).margin(0.1));
  CHECK(file.has("/fan/h0"));
}

TEST_CASE("catenary-modes: a nonlinear model that other kinds take, the asymptotic formula in the sweep") {
  const Folder f;
  const Ran r = program(f, "run " + study("catenary-modes") +
                               "--set cable.height_difference=20 --set cable.length=160 --set drag.normal=0.2 --set drag.lateral=0.2 "
                               "--set reduced.out_of_plane=1 --set reduced.in_plane=3 --set sweep.height_over_span=[0] --set sweep.points=3 -o m.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  ResultReader file(f.path / "m.h5");
  const auto exact = file.column("/sweep/in_plane/h0", "w6").values, formula = file.column("/sweep/in_plane/h0", "asymptotic6").values;
  for (std::size_t i = 0; i < 3; ++i) CHECK(formula[i] == Approx(exact[i]).epsilon(1e-3));
  const std::string model = file.text("/reduced", "modal_model"),
                    example = slurp(study("deep-cable-swing").substr(0, study("deep-cable-swing").size() - 1));
  CHECK(example.find(model.substr(0, model.find("term"))) != std::string::npos);  // the example is this model
  std::ofstream(f.path / "p.toml") << "study = \"periodic\"\n"
                                   << model << "force = [{ equation = 3, amplitude = 0.2 }]\n[continuation]\nrange = [0.85, 1.3]\n";
  const Ran p = program(f, "run p.toml --json -o p.h5");
  INFO(p.err);
  REQUIRE(p.status == 0);
  const auto at = numbers(p.out, "omega");  // the swing begins at half the frequency on either side of twice its own, 2 x 0.47468 rad/s
  for (const double edge : {0.94171764894, 0.97871996656})
    CHECK(std::any_of(at.begin(), at.end(), [&](double w) { return std::abs(w - edge) < 1e-7; }));
  CHECK(program(f, "run " + study("catenary-modes") + "--set reduced.out_of_plane=7 --set reduced.in_plane=6 -o x.h5").status == 2);
}

TEST_CASE("catenary-modes: modes that drag keeps from oscillating are told") {
  const Folder f;
  const Ran r =
      program(f, "run " + study("catenary-modes") + "--set drag.normal=30 --set drag.tangential=30 --set sweep.height_over_span=[] -o m.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.out.find("2 roots do not oscillate") != std::string::npos);  // drag over mass 3 > 2 x 1.24 rad/s
  ResultReader file(f.path / "m.h5");
  CHECK(file.numbers_attribute("/modes/damped", "overdamped_decay").size() == 2);
  const double omega = file.column("/modes/in_plane", "omega").values[1];  // equal drag: w^2 - 1.5^2
  CHECK(file.column("/modes/damped", "damped_omega").values[0] == Approx(std::sqrt(omega * omega - 2.25)).epsilon(1e-9));
}

TEST_CASE("hanging cables: bad input gives one clear line and nothing else") {
  const Folder f;
  const std::string modes = "run " + study("catenary-modes"), forced = "run " + study("catenary-forced");
  const std::pair<std::string, std::string> cases[] = {
      {modes + "--set cable.length=90", "cable.span = 100.0: the span 100 m is not shorter than the cable, 90 m"},
      {modes + "--set cable.height_difference=110", "cable.height_difference = 110.0: the height difference 110 m is beyond reach"},
      {modes + "--set cable.height_difference=-1", "cable.height_difference = -1"},
      {modes + "--set cable.sag=10", "exactly three"},
      {modes + "--set cable.sag=-10", "cable.sag = -10"},
      {modes + "--set series.compare=true", "series method is for inextensible cables"},
      {modes + "--set sweep.sag_parameter=[0.9,0.5]", "must be increasing"},
      {modes + "--set sweep.sag_parameter=[0.5,1.5]", "sweep.sag_parameter"},
      {forced + "--set end_motion.tangential=[]", "has more entries than end_motion.tangential"},
      {forced + "--set response.range=[2,1]", "must be increasing"},
      {forced + "--set response.range=[0,1e6]", "must lie below 465.047 rad/s"},
      {"run " + study("veering") + "--set veering.flexibility=[0.2,0.1]", "must be increasing"},
  };
  for (const auto& [arguments, expected] : cases) {
    const Ran r = program(f, arguments + " -o x.h5");
    INFO(arguments << "\n" << r.err);
    CHECK(r.status == 2);
    CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
    CHECK(r.err.find(expected) != std::string::npos);
    CHECK_FALSE(fs::exists(f.path / "x.h5"));
  }
  std::ofstream(f.path / "deep.toml") << "study = \"catenary-modes\"\n[cable]\nspan = 10\nheight_difference = 0\nlength = 100\n"
                                         "mass_per_length = 1\n[series]\ncompare = true\n";
  const Ran deep = program(f, "run deep.toml -o x.h5");
  CHECK(deep.status == 2);
  CHECK(deep.err.find("deep.toml:8: series.compare = true: the series method needs both ends within |xi| < 4") != std::string::npos);
}
