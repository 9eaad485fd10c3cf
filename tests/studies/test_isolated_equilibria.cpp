// Rest points that are not isolated, and corners: what a run says and does about them.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "studies/result_file.hpp"
#include "tests/studies/program.hpp"
#include "tests/studies/refusal.hpp"

using namespace whirl::studies;
using namespace whirl::studies::tests;

namespace {

std::string study(const std::string& model, const std::string& parameter, const std::string& range) {
  return "study = \"continuation\"\n[equilibrium_model]\n" + model + "[continuation]\nparameter = \"" + parameter + "\"\nrange = " + range + "\n";
}

const std::string sirs =
    "variables = [\"S\", \"I\", \"R\"]\nparameters = { b = 0.2, g = 0.5, w = 0.1 }\n"
    "rhs = [\"-b*S*I + w*R\", \"b*S*I - g*I\", \"g*I - w*R\"]\ninitial = [1.0, 0.0, 0.0]\n";
const std::string ring =
    "variables = [\"x\", \"y\"]\nparameters = { p = -1.0 }\nrhs = [\"x*(p - x^2 - y^2)\", \"y*(p - x^2 - y^2)\"]\ninitial = [0.0, 0.0]\n";

struct Result {
  Ran ran;
  std::vector<std::string> types, subtypes;
  std::vector<double> parameter;
};

Result run(const Folder& f, const std::string& text, const std::string& parameter, const std::string& more = "") {
  std::ofstream(f / "my.toml") << text;
  Result r{program(f, "run my.toml -o r.h5" + more), {}, {}, {}};
  if (!std::filesystem::exists(f / "r.h5")) return r;
  const ResultReader file(f / "r.h5");
  r.types = file.text_column("/special_points", "type").values;
  r.subtypes = file.text_column("/special_points", "subtype").values;
  r.parameter = file.column("/special_points", parameter).values;
  return r;
}

}  // namespace

TEST_CASE("a conserved total is found, held and named", "[isolated]") {
  const Folder f;
  for (const std::string key : {"", "conserved = [\"S + I + R\"]\n", "conserved = [\"(S + I + R)^2\"]\n"}) {
    const Result r = run(f, study(sirs + key, "b", "[0.2, 2.0]"), "b");
    INFO(r.ran.err);
    CHECK(r.ran.status == 0);
    REQUIRE(r.types == std::vector<std::string>{"BP"});
    CHECK(r.subtypes[0] == "TC");
    CHECK(r.parameter[0] == Approx(0.5).epsilon(1e-10));
    CHECK((r.ran.err.find("conserve S + I + R") != std::string::npos) == key.empty());
  }
  // The total as a parameter: TC where b N = g.
  const std::string by_total = replaced(replaced(sirs, "b = 0.2", "N = 1.0, b = 1.0"), "initial", "conserved = [\"S + I + R - N\"]\ninitial");
  const Result r = run(f, study(by_total, "N", "[0.1, 1.0]"), "N");
  INFO(r.ran.err);
  CHECK(r.ran.status == 0);
  REQUIRE(r.parameter.size() == 1);
  CHECK(r.parameter[0] == Approx(0.5).epsilon(1e-10));
}

TEST_CASE("a circle of rest points is named with the key that pins one", "[isolated]") {
  const Folder f;
  const Result loose = run(f, study(ring, "p", "[-1.0, 1.0]"), "p");
  INFO(loose.ran.err);
  CHECK(loose.ran.status == 1);
  CHECK(loose.ran.err.find("not isolated") != std::string::npos);
  CHECK(loose.ran.err.find("rotation of (x, y)") != std::string::npos);
  CHECK(loose.ran.err.find("phase = ") != std::string::npos);
  CHECK(std::count(loose.ran.err.begin(), loose.ran.err.end(), '\n') < 20);
  const Result pinned = run(f, study(ring + "phase = \"x\"\n", "p", "[-1.0, 1.0]"), "p");
  INFO(pinned.ran.err);
  CHECK(pinned.ran.status == 0);
  REQUIRE(pinned.types == std::vector<std::string>{"BP"});
  CHECK(pinned.subtypes[0] == "PF");
  CHECK(std::abs(pinned.parameter[0]) < 1e-10);
}

TEST_CASE("locked oscillators with a phase pinned", "[isolated]") {
  const std::string kuramoto =
      "variables = [\"a\", \"b\", \"c\"]\nparameters = { K = 3.0 }\n"
      "rhs = [\"0.55 + K/3*(sin(b-a) + sin(c-a))\", \"0.15 + K/3*(sin(a-b) + sin(c-b))\", \"0.05 + K/3*(sin(a-c) + sin(b-c))\"]\ninitial = [0.1, "
      "0.0, -0.1]\n"
      "phase = \"c\"\nangles = [\"a\", \"b\"]\n";
  const Folder f;
  const Result r = run(f, study(kuramoto, "K", "[0.1, 3.0]"), "K");
  INFO(r.ran.err);
  CHECK(r.ran.status == 0);
  // Newton on the phase differences and the determinant, from 3000 random starts in another program
  const double folds[] = {0.4563351, 1.565088, 2.0210044};
  for (const double k : folds) CHECK(std::any_of(r.parameter.begin(), r.parameter.end(), [k](double p) { return std::abs(p - k) < 1e-6; }));
  const ResultReader file(f / "r.h5");
  const auto drift = file.column("/branches/B1", "c_drift").values;
  for (const double d : drift) CHECK(d == Approx(0.25).epsilon(1e-9));  // the mean of the three frequencies
}

TEST_CASE("angles: each solution once", "[isolated]") {
  const std::string pendulum = "variables = [\"x\"]\nparameters = { p = 0.2 }\nrhs = [\"p - sin(x)\"]\ninitial = [0.2]\n";
  const Folder f;
  const Result r = run(f, study(pendulum + "angles = [\"x\"]\n", "p", "[-2.0, 2.0]"), "p");
  INFO(r.ran.err);
  CHECK(r.ran.status == 0);
  REQUIRE(r.types == std::vector<std::string>{"LP", "LP"});
  CHECK(std::abs(r.parameter[0] * r.parameter[1] + 1.0) < 1e-10);
}

TEST_CASE("angles that turn together: each solution once", "[isolated]") {
  // AUTO's coupled pendula: one fold at R = 1, one branch point at sqrt(1 - (2 ga)^2) for each 2 pi.
  const std::string pendula =
      "variables = [\"p1\", \"p2\", \"q1\", \"q2\"]\nparameters = { ga = 0.175, eps = 0.1, R = 0.0 }\n"
      "rhs = [\"q1\", \"q2\", \"-eps*q1 - sin(p1) + R + ga*(p2-p1)\", \"-eps*q2 - sin(p2) + R + ga*(p1-p2)\"]\ninitial = [0.0, 0.0, 0.0, 0.0]\n";
  const Folder f;
  const Result plain = run(f, study(pendula, "R", "[0.0, 0.5]"), "R");
  CHECK(plain.ran.err.find("2 pi in p1 + p2: equilibrium_model.angles = [\"p1\"]") != std::string::npos);
  for (const char* angles : {"angles = [\"p1\"]\n", "angles = [\"p2\", \"p1\"]\n"}) {
    const Result r = run(f, study(pendula + angles, "R", "[0.0, 1.5]"), "R");
    INFO(angles << r.ran.err);
    int folds = 0, pitchforks = 0;
    for (std::size_t i = 0; i < r.types.size(); ++i) {
      folds += r.types[i] == "LP" && std::abs(r.parameter[i] - 1.0) < 1e-10 ? 1 : 0;
      pitchforks += r.subtypes[i] == "PF" && std::abs(r.parameter[i] - std::sqrt(1.0 - 0.35 * 0.35)) < 1e-10 ? 1 : 0;
    }
    CHECK(folds == 1);
    CHECK(pitchforks == 1);
  }
  const Result none = run(f, study(pendula + "angles = [\"q1\"]\n", "R", "[0.0, 0.5]"), "R");
  CHECK(none.ran.status == 2);
  CHECK(none.ran.err.find("do not repeat") != std::string::npos);
}

TEST_CASE("corners are said, and nothing grinds", "[isolated]") {
  const Folder f;
  const Result tent =
      run(f, study("variables = [\"x\"]\nparameters = { p = 1.0 }\nrhs = [\"p - abs(x)\"]\ninitial = [1.0]\n", "p", "[-1.0, 1.0]"), "p");
  INFO(tent.ran.err);
  REQUIRE(tent.types == std::vector<std::string>{"MX"});
  CHECK(tent.subtypes[0] == "corner");
  CHECK(std::abs(tent.parameter[0]) < 1e-9);
  CHECK(tent.ran.err.find("abs(") != std::string::npos);
  // The same tent by other functions; and a jump, which no branch crosses.
  for (const auto& [rhs, word] :
       {std::pair{"p - max(x, -x)", "max("}, std::pair{"p + min(x, 0 - x)", "min("}, std::pair{"p + sign(x) - x", "sign("}}) {
    const std::string model = fmt::format("variables = [\"x\"]\nparameters = {{ p = 1.0 }}\nrhs = [\"{}\"]\ninitial = [1.0]\n", rhs);
    const Result r = run(f, study(model, "p", "[-2.0, 1.0]"), "p");
    INFO(rhs << ": " << r.ran.err);
    CHECK(r.ran.err.find(word) != std::string::npos);
    CHECK((r.ran.err.find("corner") != std::string::npos || r.ran.err.find("not connected") != std::string::npos));
  }
  // Chua's piecewise linear circuit in the slope between the corners: at m0 = -1 every |x| <= 1 is at rest.
  const std::string chua =
      "variables = [\"x\", \"y\", \"z\"]\nparameters = { al = 9.0, be = 14.0, m0 = -0.5, m1 = -0.714 }\n"
      "rhs = [\"al*(y - x - (m1*x + 0.5*(m0-m1)*(abs(x+1)-abs(x-1))))\", \"x - y + z\", \"-be*y\"]\ninitial = [0.0, 0.0, 0.0]\n";
  const Result upright = run(f, study(chua, "m0", "[-2.0, -0.5]"), "m0");
  INFO(upright.ran.err);
  CHECK(upright.ran.err.find("m0 = -1 are not isolated") != std::string::npos);
  CHECK(upright.types.size() < 10);
}

TEST_CASE("a Hill function with its exponent as a parameter", "[isolated]") {
  const std::string hill = "variables = [\"x\"]\nparameters = { a = 0.0, n = 2.0 }\nrhs = [\"-x + a*x^n/(1 + x^n)\"]\ninitial = [0.0]\n";
  const Folder f;
  const Result r = run(f, study(hill, "a", "[0.0, 3.0]"), "a", " --set continuation.user_values=[2.5]");
  INFO(r.ran.err);
  CHECK(r.ran.status == 0);
  CHECK(std::count(r.types.begin(), r.types.end(), "LP") == 1);
  CHECK(std::count(r.types.begin(), r.types.end(), "UZ") == 3);  // x = 0, 1/2, 2
}
