// Study kinds `modes` and `mode-convergence`, and the model keys of forced systems.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "continuation/two_parameter.hpp"
#include "models/floquet.hpp"
#include "models/shallow/modes.hpp"
#include "studies/cable_model_keys.hpp"
#include "studies/forced_system.hpp"
#include "studies/modes_study.hpp"
#include "studies/registry.hpp"
#include "studies/result_file.hpp"
#include "studies/whirl_threshold.hpp"
#include "tests/models/oresund.hpp"

namespace fs = std::filesystem;
using namespace whirl;
using namespace whirl::studies;
using Catch::Contains;

namespace {

const std::string folder = std::string(WHIRL_SOURCE_DIR) + "/studies/";

struct Output {
  fs::path path = fs::temp_directory_path() / ("whirl-modes-" + std::to_string(::getpid()) + ".h5");
  ~Output() { fs::remove(path); }
};

Configuration read(const std::string& file, const std::vector<std::string>& overrides = {}) {
  return Configuration::from_file(folder + file, schemas(), overrides);
}

ResultReader run(const Output& out, const Configuration& c) {
  RunContext context;
  context.output = out.path;
  context.quiet = true;
  REQUIRE(study_kind(c.kind()).run(c, context) == ExitStatus::ok);
  return ResultReader(out.path);
}

const std::string span = "study = \"modes\"\n[cable]\nchord_length = 200.0\naxial_stiffness = 37.6e6\nmass_per_length = 1.57\n";
Configuration text(const std::string& more) { return Configuration::from_text(span + more, "cable.toml", schemas()); }

}  // namespace

TEST_CASE("modes: tables of the second cable", "[published]") {
  const Output out;
  const ResultReader file = run(out, read("second-cable-modes.toml"));
  CHECK(file.scalar("/cable", "lambda2").value == Approx(7.0373).epsilon(0).margin(5e-5));
  CHECK(file.scalar("/cable", "sag").value == Approx(2.0813).epsilon(0).margin(5e-5));
  const auto names = file.text_column("/modes", "mode").values;
  const auto hertz = file.column("/modes", "frequency").values;
  REQUIRE(names.size() == 12);
  const auto frequency = [&](const std::string& name) {
    return hertz[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin())];
  };
  CHECK(frequency("y1") == Approx(0.38379).epsilon(0).margin(5e-6));
  CHECK(frequency("z1") == Approx(0.48122).epsilon(0).margin(5e-6));
  CHECK(frequency("z3") == Approx(1.15577).epsilon(0).margin(5e-6));
  CHECK(file.column("/shapes/z1", "transverse").values.size() == 201);
  CHECK(file.column("/cross_over", "symmetric1").values.front() == Approx(3.154465166857235).epsilon(1e-14));  // at lambda2 = 0.1
  CHECK(file.column("/resonances", "at").values.size() > 10);
  CHECK(file.text_attribute("/study", "outcome") == "complete");
}

TEST_CASE("modes: any one number gives the cable, two or none are refused") {
  Output out;
  const double sag = run(out, text("chord_tension = 37e3\n")).scalar("/cable", "sag").value;
  const auto tension = [&](const std::string& line) { return run(out, text(line)).scalar("/cable", "chord_tension").value; };
  CHECK(tension("sag = " + std::to_string(sag)) == Approx(37e3).epsilon(1e-6));  // six decimals of text
  CHECK(tension("first_frequency = 0.3837877") == Approx(37e3).epsilon(1e-6));
  CHECK(tension("unstressed_length = 199.86082") == Approx(37e3).epsilon(1e-4));
  const auto& check = study_kind("modes").check;
  CHECK_THROWS_WITH(check(text("chord_tension = 37e3\nsag = 2.0\n")), Contains("cable.sag") && Contains("one too many"));
  CHECK_THROWS_WITH(check(text("")), Contains("needs one of chord_tension"));
  CHECK_THROWS_WITH(check(text("sag = 60.0\n")), Contains("cable.toml:6: cable.sag = 60"));
  CHECK(check(text("first_in_plane_frequency = 0.48122\n")).size() == 1);  // several tensions have it
  CHECK(check(text("chord_tension = 37e3\n")).empty());
}

TEST_CASE("whirl modes prints the table of any study's cable") {
  const std::string table = modes_table(read("oresund-superharmonic.toml"));
  CHECK_THAT(table, Contains("z1") && Contains("3.2007") && Contains("internal"));
  CHECK_THAT(modes_table(read("oresund-modes.toml")), Contains("omega = w(z1)/2"));
}

TEST_CASE("forced systems take the N-mode cable by model.kind") {
  const auto of = [&](const std::vector<std::string>& overrides) {
    return forced_system_of(read("oresund-mode-convergence.toml", overrides), {"omega"});
  };
  const auto many = of({"model.out_of_plane_modes=2", "model.in_plane=[1,3,4]"});
  CHECK(many.coordinates == std::vector<std::string>{"y1", "y2", "z1", "z3", "z4"});
  REQUIRE(many.reflections.size() == 1);
  CHECK(many.reflections[0].signs == std::vector<int>{-1, -1, 1, 1, 1});
  CHECK(of({"support_motion.direction=out-of-plane"}).reflections.empty());
  const auto two = of({"model.kind=two-mode"});
  CHECK(two.coordinates == std::vector<std::string>{"q1", "q2"});
  CHECK(of({"model.kind=two-mode", "support_motion.end=lower"}).coordinates.size() == 2);
  CHECK_THROWS_AS(of({"cable.coefficients=as-printed"}), InputError);
  CHECK_THROWS_AS(of({"model.in_plane=[1,1]"}), InputError);
  CHECK_THROWS_AS(of({"model.in_plane=[1.5]"}), InputError);
  CHECK_THROWS_AS(of({"model.out_of_plane_modes=0", "model.in_plane_modes=0"}), InputError);
}

// Reduced two-mode model: 0.318111237 m at 1.6003780 rad/s is quoted, the least of the points of a computed curve. The curve's lowest point lies
// beside it, 3.4e-8 m lower; that both are on the curve is shown by the multiplier.
TEST_CASE("mode-convergence: whirling threshold of the two-mode stay", "[published]") {
  const Output out;
  const auto file =
      run(out, read("oresund-mode-convergence.toml", {"convergence.counts=[1]", "model.terms=reduced", "support_motion.amplitude=0.5"}));
  const double U = file.column("/convergence", "threshold").values.at(0), omega = file.column("/convergence", "threshold_omega").values.at(0);
  CHECK(U == Approx(0.318111237).epsilon(0).margin(5e-8));
  CHECK(omega == Approx(1.6003780).epsilon(0).margin(5e-5));
  CHECK(U < 0.318111237);
  for (const auto& [w, a] : {std::pair{omega, U}, {1.6003780, 0.318111237}}) {
    const auto hb = models::stay_harmonic_balance(models::oresund(a, w), {models::Lens("omega")}, {.harmonics = 20});
    const auto at = newton(hb, hb.linear_response(Vector::Constant(1, w)), {.max_iterations = 30});
    REQUIRE(at.ok());
    const auto system = hb.system_at(at.x);
    models::Floquet floquet(system, 20, 1);
    const auto mu = floquet.compute(system, at.x.head(hb.size())).multipliers;
    CHECK(std::abs(mu[0] - 1.0) < 3e-6);  // slope of the multiplier along the amplitude times the digits quoted
  }
  // Uniform tension: a threshold a tenth higher.
  CHECK(file.column("/convergence", "threshold").values.at(1) == Approx(0.34915429).epsilon(1e-7));
}

TEST_CASE("the threshold by two small matrices is that of the engine's curve of branch points", "[slow]") {
  using namespace continuation;
  models::CableModel m{.stay = models::oresund(0.4, 1.0)};
  m.out_of_plane = m.in_plane = {1, 3};
  m.longitudinal = models::Longitudinal::quasi_static;
  const auto t = whirl_threshold(m, {.harmonics = 10, .omega = {1.4, 1.75}, .amplitude = {0.1, 0.7}});
  REQUIRE(t.ok);
  const models::HarmonicBalanceOptions o{.harmonics = 10, .reflections = models::cable_reflections(m)};
  using models::Lens;
  const models::HarmonicBalance one(models::cable_system(m, {Lens("omega")}), o),
      two(models::cable_system(m, {Lens("omega"), Lens("support_amplitude")}), o);
  const auto start = newton(one, one.linear_response(Vector::Constant(1, 1.5)), {.max_iterations = 30});
  REQUIRE(start.ok());
  const Branch branch = Walker(one, {.lower = 1.4, .upper = 1.75}).walk(start.x);
  const auto whirl = std::find_if(branch.special.begin(), branch.special.end(), [](const auto& p) { return p.subtype == "WH"; });
  REQUIRE(whirl != branch.special.end());
  CHECK(t.first_omega == Approx(whirl->u[one.size()]).epsilon(1e-9));
  const auto curve = follow(two, *whirl, 0.4, {.range1 = {1.4, 1.75}, .range2 = {0.1, 0.7}});
  const auto least = std::find_if(curve.special.begin(), curve.special.end(), [](const auto& z) { return z.type == "MIN"; });
  REQUIRE(least != curve.special.end());
  CHECK(t.amplitude == Approx(least->u[two.size() + 1]).epsilon(1e-9));
  CHECK(t.omega == Approx(least->u[two.size()]).epsilon(1e-7));
}

TEST_CASE("mode-convergence: bad input and what is not there") {
  const auto& kind = study_kind("mode-convergence");
  CHECK_THROWS_WITH(kind.check(read("oresund-mode-convergence.toml", {"convergence.counts=[1.5]"})), Contains("whole numbers"));
  CHECK_THROWS_WITH(kind.check(read("oresund-mode-convergence.toml", {"support_motion.amplitude=0.05"})), Contains("threshold.amplitude"));
  CHECK_THROWS_WITH(kind.check(read("oresund-mode-convergence.toml", {"support_motion.direction=out-of-plane"})), Contains("plane"));
  const Output out;
  RunContext context;
  context.output = out.path;
  context.quiet = true;
  // Far below the threshold: partial result, said so.
  const auto c = read("oresund-mode-convergence.toml", {"convergence.counts=[1]", "support_motion.amplitude=0.2"});
  CHECK(kind.run(c, context) == ExitStatus::numerical_failure);
  CHECK(ResultReader(out.path).text_attribute("/study", "outcome") == "partial");
  CHECK(std::isnan(ResultReader(out.path).column("/convergence", "threshold").values.at(0)));
  CHECK(ResultReader(out.path).column("/convergence", "peak").values.at(0) == Approx(1.04989367).epsilon(1e-6));
}

TEST_CASE("an example study for each resonance", "[slow]") {
  for (const char* file : {"resonance-primary.toml", "resonance-parametric.toml", "resonance-superharmonic.toml", "resonance-internal-1-1.toml",
                           "resonance-internal-1-2.toml"})
    CHECK(study_kind("periodic").check(read(file)).empty());
  const auto special = [](const std::string& file, const std::string& type) {
    const Output out;
    const ResultReader result = run(out, read(file));
    const auto types = result.text_column("/special_points", "type").values;
    const auto omega = result.column("/special_points", "omega").values;
    std::vector<double> found;
    for (std::size_t i = 0; i < types.size(); ++i)
      if (types[i] == type) found.push_back(omega[i]);
    return found;
  };
  // Parametric: planar motion loses stability to twice its period out of plane just below 2 w(y1).
  const auto doubled = special("resonance-parametric.toml", "PD");
  REQUIRE(doubled.size() == 1);
  CHECK(doubled[0] == Approx(55.4815).epsilon(0).margin(1e-3));
  // Internal 1:2: on both sides of w(z1) = 2 w(y1).
  const auto pair = special("resonance-internal-1-2.toml", "PD");
  REQUIRE(pair.size() >= 2);
  auto cable = models::Cable<double>{200.0, 37.6e6, 20.83e3, 1.57, 0.0, 9.81};
  const double w = 2.0 * models::shallow::ModeShape(models::shallow::statics(cable), cable, models::shallow::Family::out_of_plane, 1).omega();
  CHECK((std::min(pair[0], pair[1]) < w && w < std::max(pair[0], pair[1])));
  CHECK(special("resonance-primary.toml", "LP").size() == 2);
}
