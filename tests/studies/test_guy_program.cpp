// The guy studies as a user meets them: example inputs run, results stand in the file, bad input gives one line.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
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

constexpr double foot = 0.3048, pound = 4.4482216152605, kip_per_foot = 1000.0 * pound / foot;

std::string input(const std::string& name) { return std::string(WHIRL_SOURCE_DIR) + "/studies/" + name + ".toml"; }

}  // namespace

TEST_CASE("okc-guy-statics: curve, groups, chains", "[published]") {
  const Folder f;
  const Ran r = program(f, "run " + input("okc-guy-statics") + " --json -o s.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.out.find("\"unstressed_length\": 502.776") != std::string::npos);
  const ResultReader file(f.path / "s.h5");
  CHECK(file.text_attribute("/study", "outcome") == "complete");
  CHECK(file.scalar("/guy", "modulus").value / kip_per_foot == Approx(4.656029838).epsilon(1e-8));
  CHECK(file.scalar("/guy", "modulus_first_order").value / kip_per_foot == Approx(4.649243199).epsilon(1e-8));
  const auto H = file.column("/curve/exact", "horizontal_tension").values;
  CHECK(H.front() / pound == Approx(16199.2248025).epsilon(1e-9));  // -10 ft
  CHECK(H.back() / pound == Approx(83734.1383364).epsilon(1e-9));   // 6 ft
  CHECK(file.numbers_attribute("/groups/direction45", "azimuths_deg").size() == 4);
  CHECK(file.number_attribute("/groups/direction0", "tangent") / kip_per_foot == Approx(2 * (4.656029838 + 35.3 / 950.0)).epsilon(1e-7));
  CHECK(file.column("/lumped/funicular", "x").values[4] / foot == Approx(684.0327).epsilon(1e-6));
  CHECK(file.number_attribute("/lumped/hung", "horizontal_tension") / pound == Approx(34796.0384192).epsilon(1e-9));
}

TEST_CASE("okc-guy-modes: all kinds of modes, an independent count", "[published]") {
  const Folder f;
  const Ran r = program(f, "run " + input("okc-guy-modes") + " --set scan.points=7 --json -o m.h5");
  INFO(r.err);
  REQUIRE(r.status == 0);
  const ResultReader file(f.path / "m.h5");
  CHECK(file.column("/modes/transverse", "omega").values[0] == Approx(0.892016074145).epsilon(1e-10));
  CHECK(file.column("/modes/in_plane", "omega").values[0] == Approx(1.39840492078).epsilon(1e-10));
  CHECK(file.column("/modes/out_of_plane", "omega").values[7] == Approx(7.13499797988).epsilon(1e-10));
  CHECK(file.column("/modes/transverse_shapes", "guy_8").values.size() == 201);
  CHECK(file.number_attribute("/modes/transverse", "orthonormality_error") < 1e-9);
  CHECK(file.column("/scan", "in_plane_1").values.size() == 7);
  CHECK(r.out.find("\"modes\": [") != std::string::npos);
}

TEST_CASE("okc-guy-stiffness and davenport-guy-stiffness: curves, poles, zeros, convergence", "[published]") {
  const Folder f;
  for (const std::string name : {"okc-guy-stiffness", "davenport-guy-stiffness"}) {
    const Ran r = program(f, "run " + input(name) + " --set stiffness.points=200 --json -o k.h5");
    INFO(r.err);
    REQUIRE(r.status == 0);
    const ResultReader file(f.path / "k.h5");
    const auto type = file.text_column("/poles_and_zeros", "type").values, direction = file.text_column("/poles_and_zeros", "direction").values;
    const auto ratio = file.column("/poles_and_zeros", "omega_ratio").values;
    int poles = 0;
    for (std::size_t i = 0; i < type.size(); ++i) poles += type[i] == "pole" && direction[i] == "horizontal";
    CHECK(poles == static_cast<int>(file.number_attribute("/poles_and_zeros", "counted_in_plane")));
    if (name == "okc-guy-stiffness") {
      CHECK(ratio[0] == Approx(1.081).epsilon(0).margin(5e-4));
      CHECK(ratio[1] == Approx(1.5643).epsilon(0).margin(5e-5));
      CHECK(file.column("/stiffness/horizontal", "full_re").values[0] / kip_per_foot == Approx(4.65517916).epsilon(1e-8));
      CHECK(r.out.find(R"("branch": "horizontal", "type": "zero", "omega": 0.966)") != std::string::npos);
    }
    for (const double im : file.column("/stiffness/horizontal", "full_im").values) CHECK(im >= 0.0);
    const auto error = file.column("/convergence", "error_galerkin").values;
    CHECK(error.front() > 1e-3);
    CHECK(error.back() < 1e-10);
    CHECK(file.has("/longitudinal/X"));
  }
}

TEST_CASE("mast-level: ice and cold tighten a guy, three guys are isotropic") {
  const Folder f;
  const Ran s = program(f, "run " + input("mast-level") + " -q -o s.h5"),
            r = program(f, "run " + input("mast-level-stiffness") + " --set stiffness.points=50 -q -o k.h5");
  INFO(s.err << r.err);
  REQUIRE(s.status == 0);
  REQUIRE(r.status == 0);
  const ResultReader statics(f.path / "s.h5"), file(f.path / "k.h5");
  CHECK(statics.scalar("/guy", "horizontal_tension").value > statics.scalar("/guy", "installed_horizontal_tension").value);
  const auto XX = file.column("/stiffness/level", "XX_re").values, YY = file.column("/stiffness/level", "YY_re").values;
  const auto xx = file.column("/stiffness/horizontal", "full_re").values, zz = file.column("/stiffness/matrix", "zz_re").values;
  for (std::size_t i = 0; i < XX.size(); ++i) {
    CHECK(XX[i] == Approx(1.5 * (xx[i] + zz[i])).epsilon(1e-9));
    CHECK(YY[i] == Approx(XX[i]).epsilon(1e-9));
  }
}

TEST_CASE("bad guys: one line that names the key, exit status 2, nothing written") {
  const Folder f;
  const std::pair<std::string, std::string> cases[] = {
      {"okc-guy-statics.toml --set guy.known=unstressed_length --set guy.value=400",
       "guy.value = 400.0: guy: an unstressed length of 400 m cannot reach"},
      {"okc-guy-statics.toml --set guy.known=upper_tension --set guy.value=3000", "below the least its weight allows"},
      {"okc-guy-statics.toml --set guy.value=-5", "guy.value = -5"},
      {"okc-guy-statics.toml --set guy.value=1e8", "strains it"},
      {"okc-guy-statics.toml --set guy.axial_stiffness=1e5", "its own weight"},
      {"okc-guy-statics.toml --set curve.range=[-1.0,600.0]", "curve.range"},
      {"okc-guy-statics.toml --set group.azimuths_deg=[0.0,90.0]", "give one of them"},
      {"okc-guy-statics.toml --set lumped.masses=1 --set lumped.extra_weights=[1.0,2.0]", "lumped.extra_weights"},
      {"okc-guy-modes.toml --set scan.tension_range=[2e5,1e5]", "increasing"},
      {"okc-guy-modes.toml --set modes.count=0", "modes.count"},
      {"okc-guy-stiffness.toml --set damping.ratio=-0.1", "damping.ratio = -0.1"},
      {"okc-guy-stiffness.toml --set damping.rate=-1.0", "damping.rate = -1"},
      {"okc-guy-stiffness.toml --set stiffness.range=[3.0,1.0]", "stiffness.range"},
      {"okc-guy-stiffness.toml --set stiffness.range=[1.0,1e5]", "stiffness.range"},
      {"okc-guy-stiffness.toml --set stiffness.closed_forms=[\\\"classic\\\"]", "stiffness.closed_forms"},
      {"okc-guy-stiffness.toml --set stiffness.degree=1", "stiffness.degree"},
      {"okc-guy-stiffness.toml --set convergence.omega=99.0", "convergence.omega"}};
  for (const auto& [arguments, words] : cases) {
    const Ran r = program(f, "run " + std::string(WHIRL_SOURCE_DIR) + "/studies/" + arguments + " -o b.h5");
    INFO(arguments << "\n" << r.err);
    CHECK(r.status == 2);
    CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
    CHECK(r.err.find(words) != std::string::npos);
    CHECK_FALSE(fs::exists(f.path / "b.h5"));
  }
}
