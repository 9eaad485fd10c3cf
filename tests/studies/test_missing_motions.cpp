// Motions that no branch leads to: isolated ones, found by averaging, deflation and integration, and what the program says of them.
#include <catch2/catch.hpp>
#include <fstream>
#include <set>

#include "studies/result_file.hpp"
#include "tests/studies/program.hpp"

using namespace whirl::studies;
using namespace whirl::studies::tests;

namespace {

struct Case {
  Folder folder;
  Ran ran;
  ResultReader file;
  Case(const std::string& study, const std::string& arguments) : ran(run(study, arguments)), file(folder / "r.h5") {}
  Ran run(const std::string& study, const std::string& arguments) const {
    std::ofstream(folder / "s.toml") << study;
    return program(folder, "run s.toml -o r.h5 " + arguments);
  }
  struct Point {
    std::string type;
    double omega, q1, q2, period, unstable;
  };
  std::vector<Point> points(bool two) const {
    std::vector<Point> all;
    const auto types = file.text_column("/special_points", "type").values;
    const auto column = [&](const std::string& name) { return file.column("/special_points", name).values; };
    const auto omega = column("omega"), q1 = column("q1_max"), q2 = two ? column("q2_max") : q1, period = column("period"),
               unstable = column("unstable_after");
    for (std::size_t i = 0; i < types.size(); ++i) all.push_back({types[i], omega[i], q1[i], q2[i], period[i], unstable[i]});
    return all;
  }
  bool has(const std::string& type, double omega, bool two = true) const {
    const auto all = points(two);
    return std::any_of(all.begin(), all.end(), [&](const auto& p) { return p.type == type && std::abs(p.omega - omega) < 1e-9; });
  }
};

std::string forced_duffing(double damping, double cubic, double force, const std::string& range) {
  return "study = \"periodic\"\n[modal_model]\nfrequency = [1.0]\ndamping = [" + std::to_string(damping) +
         "]\n[[modal_model.term]]\nequation = 1\ncoefficient = " + std::to_string(cubic) +
         "\npowers = [3]\n[[modal_model.force]]\nequation = 1\namplitude = " + std::to_string(force) + "\n[continuation]\nrange = " + range + "\n";
}

struct Stay {
  double L, EA, T, m, inclination;
  const char* terms;
  double out, in, U, lower, upper, omega;
};

std::string study_of(const Stay& s) {
  std::ostringstream o;
  o.precision(12);
  o << "study = \"periodic\"\n[cable]\nchord_length = " << s.L << "\naxial_stiffness = " << s.EA << "\nchord_tension = " << s.T
    << "\nmass_per_length = " << s.m << "\ninclination_deg = " << s.inclination << "\n[model]\nterms = \"" << s.terms
    << "\"\n[damping]\nout_of_plane = " << s.out << "\nin_plane = " << s.in << "\n[support_motion]\namplitude = " << s.U
    << "\n[continuation]\nrange = [" << s.lower << ", " << s.upper << "]\nuser_values = [" << s.omega << "]\n";
  return o.str();
}

}  // namespace

TEST_CASE("periodic: two coupled parametric oscillators, all their families and the folds of the isolated ones", "[published]") {
  // Normal modes of two parametrons; at least nine nonzero families at w = 1.015 by shooting, four folds of isolated ones.
  std::ostringstream study;
  study << "study = \"periodic\"\n[modal_model]\nfrequency = [0.99708026, 1.00291124]\ndamping = [0.007, 0.007]\n";
  const auto term = [&](int equation, double coefficient, const char* powers, const char* more = "") {
    study << "[[modal_model.term]]\nequation = " << equation << "\ncoefficient = " << coefficient << "\npowers = " << powers << "\n" << more;
  };
  study.precision(9);
  term(1, -0.02, "[1, 0]", "cos_harmonic = 2\n");
  term(2, -0.02, "[0, 1]", "cos_harmonic = 2\n");
  term(1, 0.6323529, "[3, 0]");
  term(1, 1.1029412, "[1, 2]");
  term(1, 0.2205882, "[0, 3]");
  term(1, -0.6617647, "[2, 1]");
  term(2, 0.6323529, "[0, 3]");
  term(2, 1.1029412, "[2, 1]");
  term(2, -0.2205882, "[3, 0]");
  term(2, 0.6617647, "[1, 2]");
  study << "[continuation]\nrange = [0.98, 1.02]\nuser_values = [1.015]\n";
  const Case c(study.str(), "--quiet");
  INFO(c.ran.err);
  REQUIRE(c.ran.status == 0);
  for (const double omega : {1.0012144741, 1.00465901874, 1.00517516664, 1.01217392393}) CHECK(c.has("LP", omega));
  std::set<std::pair<long, long>> families;
  for (const auto& p : c.points(true))
    if (p.type == "UZ" && p.q1 + p.q2 > 1e-6) families.insert({std::lround(1e6 * p.q1), std::lround(1e6 * p.q2)});
  CHECK(families.size() == 12);                                                 // the averaged equations have twelve pairs there
  for (const auto& name : c.file.children("/branches")) CHECK(name[0] == 'B');  // none told again as a motion of period two
}

TEST_CASE("periodic: stays whose stable isolated motions integration finds", "[slow]") {
  // Peaks of the stable motions that random starts settle on, by a Runge-Kutta method of order 7 over 3000 periods: there they repeat to 6e-12.
  struct Known {
    Stay stay;
    double q1, q2, period;
  };
  const Known cases[] = {
      {{303.0, 5.53e8, 1.31e6, 70.6, 44.2, "reduced", 0.0079, 0.0047, 0.4, 1.06, 3.67, 1.888}, 7.24278830, 6.06273616, 1},
      {{166.0, 1.87e9, 6.2e6, 63.8, 20.0, "reduced", 0.014, 0.002, 0.302, 4.42, 15.3, 6.681}, 0.0, 3.52555392, 1},
      {{257.0, 8.88e8, 4e6, 77.0, 21.3, "full", 0.0062, 0.0038, 0.604, 2.09, 7.24, 3.762}, 10.35608186, 1.87313619, 1},
      {{116.0, 3.92e8, 1.78e6, 69.0, 59.9, "reduced", 0.011, 0.0028, 0.353, 1.44, 3.48, 2.898}, 0.0, 0.47385895, 2},
  };
  for (const auto& known : cases) {
    const Case c(study_of(known.stay), "--quiet");
    INFO(c.ran.err);
    REQUIRE(c.ran.status == 0);
    const auto points = c.points(true);
    CHECK(std::any_of(points.begin(), points.end(), [&](const auto& p) {
      return p.type == "UZ" && p.unstable == 0 && p.period == known.period && std::abs(p.q1 - known.q1) < 2e-7 && std::abs(p.q2 - known.q2) < 2e-7;
    }));
  }
}

TEST_CASE("periodic: a strongly forced oscillator's isola of period two, and its motions of period three by name", "[published]") {
  const Case c(forced_duffing(0.2, 1.0, 27.0, "[2.0, 8.0]"), "--set seeds.check=6");
  REQUIRE(c.ran.status == 0);
  CHECK(c.has("LP", 4.06038529082, false));  // by shooting
  CHECK(c.has("LP", 6.41875726973, false));  // of period two: det(M - I) = 0 of the map over two periods, integrated to 1e-12 apart from this program
  CHECK(c.ran.err.find("72 starts integrated at 12 values of omega") != std::string::npos);
  CHECK(c.ran.err.find("on motions that no branch holds (periodic 3T at ") != std::string::npos);
  const auto kinds = c.file.text_column("/verification/attractors", "kind").values,
             branches = c.file.text_column("/verification/attractors", "branch").values;
  const auto multiple = c.file.column("/verification/attractors", "multiple").values;
  for (std::size_t i = 0; i < kinds.size(); ++i) CHECK((branches[i].empty() == (multiple[i] != 1 && multiple[i] != 2)));
}

TEST_CASE("periodic: the closing line, in the JSON too, and none without starts or damping") {
  const std::string study = forced_duffing(0.05, 0.1, 0.18, "[0.8, 1.5]");
  const Case all(study, "--json");
  REQUIRE(all.ran.status == 0);
  CHECK(all.ran.err.find("values of omega: all settle on branches found\n") != std::string::npos);
  CHECK(all.ran.out.find("\"attractor_check\": {\"starts\": ") != std::string::npos);
  CHECK(all.ran.out.find("\"without_branch\": 0, ") != std::string::npos);
  CHECK(Case(study, "--set seeds.check=0").ran.err.find("starts integrated") == std::string::npos);
  CHECK(Case(forced_duffing(0.0, 0.1, 0.18, "[1.3, 1.5]"), "").ran.err.find("starts integrated") == std::string::npos);
  const Case some(study, "--set seeds.check=2 --set seeds.check_values=3");
  CHECK((some.ran.out + some.ran.err).find("6 starts integrated at 3 values of omega: ") != std::string::npos);
}
