// [modal_model] and [equilibrium_model] as a user writes them.
#include <catch2/catch.hpp>

#include "studies/equilibrium_model_input.hpp"
#include "studies/modal_model_input.hpp"
#include "tests/studies/refusal.hpp"

using namespace whirl::studies;
using namespace whirl::studies::tests;

namespace {

std::vector<Schema> schemas() {
  Schema s("any", "a study of either");
  s.add({.name = "cable.chord_length", .unit = "m", .description = "length", .required = true, .lower = 0.0});
  s.add({.name = "cable.gravity", .default_value = 9.81});
  s.add({.name = "omega", .optional = true, .lower = 0.0});
  s.add({.name = "continuation.parameter", .default_value = std::string("omega")});
  s.add_free(modal_model_section());
  s.add_free(equilibrium_model_section());
  s.add_alternative({.sections = {"cable"}, .free_sections = {"modal_model", "equilibrium_model"}});
  return {s};
}

// The example of the section itself.
const std::string modal = R"(study = "any"
omega = 1.5
[modal_model]
frequency = [1.0, 2.0]            # rad/s
damping = [0.005, 0.01]           # coefficient c of c q'
[[modal_model.term]]
equation = 1
coefficient = 1.0
powers = [1, 1]
[[modal_model.term]]
equation = 2
coefficient = 0.5
powers = [2, 0]
cos_harmonic = 2
name = "kappa"
[[modal_model.force]]
equation = 2
amplitude = 0.01
)";

const std::string lorenz = R"toml(study = "any"
[equilibrium_model]
variables = ["x", "y", "z"]
parameters = { sigma = 10.0, rho = 0.5, beta = 2.6666666666666667 }
rhs = ["sigma*(y - x)", "x*(rho - z) - y", "x*y - beta*z"]
initial = [0.0, 0.0, 0.0]
mirrors = [["x", "y"]]
)toml";

Configuration read(const std::string& text) { return Configuration::from_text(text, "my.toml", schemas()); }

std::string modal_complaint(const std::string& what, const std::string& by) {
  return message([&] { (void)modal_model_of(read(replaced(modal, what, by))); });
}
std::string lorenz_complaint(const std::string& what, const std::string& by) {
  return message([&] { (void)equilibrium_model_of(read(replaced(lorenz, what, by))); });
}

}  // namespace

TEST_CASE("a modal model is read with its defaults", "[model_input]") {
  const Configuration c = read(modal);
  const auto m = modal_model_of(c);
  CHECK(m.omega == 1.5);
  CHECK(m.frequency == std::vector<double>{1.0, 2.0});
  CHECK(m.damping == std::vector<double>{0.005, 0.01});
  REQUIRE(m.terms.size() == 2);
  CHECK(m.terms[0].equation == 0);
  CHECK(m.terms[0].powers == std::vector<int>{1, 1});
  CHECK(m.terms[0].cos_harmonic == 0);
  CHECK(m.terms[1].cos_harmonic == 2);
  CHECK(m.terms[1].name == "kappa");
  REQUIRE(m.forces.size() == 1);
  CHECK(m.forces[0].equation == 1);
  CHECK(m.forces[0].harmonic == 1);
  CHECK_FALSE(c.has("cable.gravity"));  // belongs to what the model replaces
  const auto again = modal_model_of(read(c.resolved_toml()));
  CHECK(again.frequency == m.frequency);
  CHECK(again.terms[1].coefficient == 0.5);
  const auto system = modal_system_of(c, {"kappa", "omega"});
  CHECK(system.names() == std::vector<std::string>{"kappa", "omega"});
  CHECK(system.reference() == Eigen::Vector2d(0.5, 1.5));
}

TEST_CASE("a modal model by its stiffness", "[model_input]") {
  const auto m = modal_model_of(read(replaced(modal, "frequency = [1.0, 2.0]", "stiffness = [[1.0, 0.25], [0.25, 4]]")));
  CHECK(m.stiffness == std::vector<std::vector<double>>{{1.0, 0.25}, {0.25, 4.0}});
}

TEST_CASE("a bad modal model gives one line with its place", "[model_input]") {
  CHECK(modal_complaint("[1.0, 2.0]", "[1.0, 0.0]") == "my.toml:4: modal_model.frequency = [1.0, 0.0]: each value must be > 0 [rad/s]");
  CHECK(modal_complaint("[1.0, 2.0]", "\"a\"") == "my.toml:4: modal_model.frequency = \"a\": must be an array of finite numbers");
  CHECK(modal_complaint("frequency = [1.0, 2.0]", "stiffness = [[1.0], [0.0, 1.0]]") ==
        "my.toml:4: modal_model.stiffness = [[1.0], [0.0, 1.0]]: must be square: as many rows as numbers in each row");
  CHECK(modal_complaint("frequency = [1.0, 2.0] ", "") ==
        "my.toml:3: modal_model: needs either frequency, an array of numbers > 0 [rad/s], or stiffness, rows of numbers [1/s^2]");
  CHECK(modal_complaint("[0.005, 0.01]", "[0.005]") ==
        "my.toml:5: modal_model.damping = [0.005]: must be an array of 2 numbers, one for each coordinate");
  CHECK(modal_complaint("equation = 2", "equation = 3") == "my.toml:11: modal_model.term[2].equation = 3: must be an integer in 1..2");
  CHECK(modal_complaint("[1, 1]", "[1]") == "my.toml:9: modal_model.term[1].powers = [1]: must be an array of 2 integers, one for each coordinate");
  CHECK(modal_complaint("[1, 1]", "[5, 4]") == "my.toml:9: modal_model.term[1].powers = [5, 4]: must sum to at most 8");
  CHECK(modal_complaint("coefficient = 1.0\n", "") == "my.toml:6: modal_model.term[1].coefficient is missing: must be a finite number");
  CHECK(modal_complaint("amplitude", "amplitud") == "my.toml:16: modal_model.force[1].amplitude is missing: must be a finite number");
  CHECK(modal_complaint("name =", "nam =") == "my.toml:15: modal_model.term[2].nam = \"kappa\": unknown key, did you mean name?");
  CHECK(message([] { (void)read(modal + "[cable]\nchord_length = 2.0\n"); }) ==
        "my.toml:20: cable.chord_length = 2.0: is not taken beside [modal_model]");
  CHECK(message([] { (void)read("study = 'any'"); }) ==
        "my.toml: cable.chord_length is missing: must be a number > 0 [m]; or give [modal_model] or [equilibrium_model] in place of [cable]");
  CHECK_THAT(message([] { (void)read(modal + lorenz.substr(lorenz.find('\n') + 1)); }), Catch::EndsWith("is not taken beside [modal_model]"));
  const Configuration c = read(modal);
  CHECK(message([&] { check_modal_lens(c, modal_model_of(c), "continuation.parameter", "frequency[3]"); }) ==
        "my.toml: continuation.parameter = \"omega\": no such parameter, did you mean frequency[1]?");
}

TEST_CASE("an equilibrium model is read and tried out", "[model_input]") {
  const auto m = equilibrium_model_of(read(lorenz));
  CHECK(m.variables == std::vector<std::string>{"x", "y", "z"});
  CHECK(m.parameter("sigma") == 10.0);
  REQUIRE(m.mirrors.size() == 1);
  const whirl::models::EquilibriumFlow flow(m, {"rho"});
  CHECK(flow.reflections().size() == 1);
}

TEST_CASE("a bad equilibrium model gives one line with its place", "[model_input]") {
  CHECK_THAT(lorenz_complaint("(rho - z)", "(rh - z)"),
             Catch::StartsWith("my.toml:5: equilibrium_model.rhs = [") && Catch::Contains("expression 2: ") && Catch::EndsWith("did you mean rho?"));
  CHECK_THAT(lorenz_complaint("[[\"x\", \"y\"]]", "[[\"x\"]]"), Catch::Contains("mirrors") && Catch::EndsWith("changes the equations: no symmetry"));
  CHECK(lorenz_complaint("[0.0, 0.0, 0.0]", "[0.0]") ==
        "my.toml:6: equilibrium_model.initial = [0.0]: must be an array of 3 numbers, one for each variable");
  CHECK_THAT(lorenz_complaint("\"x*y - beta*z\"", "\"1/(x*y)\""), Catch::Contains("initial") && Catch::Contains("finite"));
  CHECK_THAT(lorenz_complaint("0.5,", "\"a\","), Catch::EndsWith("rho must be a finite number"));
  const Configuration c = read(lorenz);
  CHECK(message([&] { check_equilibrium_lens(c, equilibrium_model_of(c), "continuation.parameter", "rhoo"); }) ==
        "my.toml: continuation.parameter = \"omega\": no such parameter, did you mean rho?");
}
