// What integration says against averaged branches ends in the exit status and in the file, not in a line beside exit 0.
#include <catch2/catch.hpp>

#include "studies/result_file.hpp"
#include "tests/studies/program.hpp"

using namespace whirl::studies;
using namespace whirl::studies::tests;

TEST_CASE("superharmonic: a stable averaged state whose motion settles elsewhere is an error of the run") {
  const std::string study = std::string(WHIRL_SOURCE_DIR) + "/studies/oresund-superharmonic.toml",
                    few = " -o r.h5 --quiet --set verification.sweep_points=0 --set \"verification.starts=[]\" --set verification.omega=";
  const Folder f;
  const Ran agrees = program(f, "run '" + study + "'" + few + "[1.65]");
  CHECK(agrees.status == 0);
  CHECK(agrees.err.find("contradicts") == std::string::npos);
  const Ran contradicts = program(f, "run '" + study + "'" + few + "[1.9,2.1]");  // the exact motions have doubled their period at 2.1
  CHECK(contradicts.status == 1);
  CHECK(contradicts.err.find("verification contradicts W1 (stable) at omega = 1.9: the motion that starts there settles in plane") !=
        std::string::npos);
  CHECK(contradicts.err.find("at omega = 2.1: the motion that starts there settles on a motion of 2 excitation periods") != std::string::npos);
  CHECK(ResultReader(f / "r.h5").text_attribute("/study", "outcome") == "partial");
}
