// Whatever is wrong with the input, and however long or odd its names are: one short line, exit status 2, nothing written. And the same input in
// other spellings is the same input.
#include <catch2/catch.hpp>
#include <cstdint>

#include "studies/equilibrium_model_input.hpp"
#include "studies/modal_model_input.hpp"
#include "tests/studies/program.hpp"
#include "tests/studies/refusal.hpp"

using namespace whirl::studies;
using namespace whirl::studies::tests;

namespace {

const std::string expressions = R"toml(study = "continuation"
[equilibrium_model]
variables = ["x"]
parameters = { p = -1.0, n = 2.0 }
rhs = ["p + x^n"]
initial = [1.0]
[continuation]
parameter = "p"
range = [-1.0, 0.5]
)toml";

const std::string modal = R"toml(study = "periodic"
[modal_model]
frequency = [1.0, 2.0]
damping = [0.05, 0.05]
[[modal_model.term]]
equation = 1
coefficient = 0.1
powers = [3, 0]
name = "beta"
[[modal_model.term]]
equation = 2
coefficient = 0.1
powers = [0, 3]
name = "beta"
[[modal_model.force]]
equation = 2
amplitude = 0.1
[continuation]
range = [1.5, 2.5]
)toml";

std::string write(const Folder& f, const std::string& text) {
  std::ofstream(f / "my.toml", std::ios::binary) << text;
  return "my.toml";
}

void check_refused(const Folder& f, const std::string& arguments) {
  constexpr std::size_t longest = 500;
  const Ran r = program(f, arguments);
  INFO(r.err.substr(0, 600));
  CHECK(r.status == 2);
  CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
  CHECK(r.err.size() <= longest);
  CHECK(r.out.empty());
  CHECK_FALSE(std::filesystem::exists(f / "my.h5"));
}

}  // namespace

TEST_CASE("odd input takes one short line", "[refusal]") {
  const std::string deep(4000, '('), name(4000, 'q'), accents = "\xc3\xa9\xc3\xa9";
  std::string many;
  for (int i = 0; i < 3000; ++i) many += accents;
  const std::pair<std::string, std::string> changes[] = {{"\"p + x^n\"", "\"p + " + name + "\""},
                                                         {"\"p + x^n\"", "\"p + " + name + "(x)\""},
                                                         {"\"p + x^n\"", "\"" + deep + "x\""},
                                                         {"\"p + x^n\"", "\"" + std::string(100000, '(') + "x" + std::string(100000, ')') + "\""},
                                                         {"\"p + x^n\"", "\"p + x^" + std::string(5000, '9') + "\""},
                                                         {"\"p + x^n\"", "\"p + x^(\""},
                                                         {"\"p + x^n\"", "\"p + (x))\""},
                                                         {"\"p + x^n\"", "\"p + floor(x)\""},
                                                         {"\"p + x^n\"", "\"" + many + "\""},
                                                         {"\"p + x^n\"", "\"\""},
                                                         {"\"p + x^n\"", "\"p + \\u0000x\""},
                                                         {"[\"p + x^n\"]", "[]"},
                                                         {"[\"p + x^n\"]", "[[\"x\"]]"},
                                                         {"[\"p + x^n\"]", "5"},
                                                         {"[\"x\"]", "[\"" + name + "\"]"},
                                                         {"[\"x\"]", "[\"" + many + "\"]"},
                                                         {"[\"x\"]", "[\"sin\"]"},
                                                         {"[\"x\"]", "[\"p\"]"},
                                                         {"[\"x\"]", "[]"},
                                                         {"p = -1.0", name + " = 1.0, p = nan"},
                                                         {"p = -1.0", "p = inf"},
                                                         {"p = -1.0", "p = -1.0, p = 2.0"},
                                                         {"p = -1.0", "\"" + many + "\" = 1.0, p = -1.0"},
                                                         {"n = 2.0", "n = 99999999999999999999"},
                                                         {"[1.0]", "[nan]"},
                                                         {"[1.0]", "[-1.0, 2.0]"},
                                                         {"[1.0]", "[\"" + name + "\"]"},
                                                         {"n = 2.0 }\n", "n = 0.5 }\nconserved = [\"p\"]\n"},
                                                         {"initial", name + " = 1\ninitial"},
                                                         {"initial", "\"" + many + "\" = 1\ninitial"},
                                                         {"initial", "conserved = [\"x\"]\ninitial"},
                                                         {"initial", "conserved = [\"" + name + "\"]\ninitial"},
                                                         {"initial", "conserved = 3\ninitial"},
                                                         {"initial", "phase = \"x\"\ninitial"},
                                                         {"initial", "phase = \"" + name + "\"\ninitial"},
                                                         {"initial", "angles = [\"" + name + "\"]\ninitial"},
                                                         {"initial", "mirrors = [[\"" + name + "\"]]\ninitial"},
                                                         {"initial", "amplitudes = { " + name + " = [\"y\"] }\ninitial"},
                                                         {"initial", "mirrors = [[[[[[[[]]]]]]]]\ninitial"},
                                                         {"[continuation]", "[" + name + "]\na = 1\n[continuation]"},
                                                         {"[continuation]", "[continuation]\n" + name + " = 1"},
                                                         {"[continuation]", "[continuation]\nuser_values = [" + name + "]"},
                                                         {"[continuation]", "[continuation]\ndepth = 9223372036854775807"},
                                                         {"[continuation]", "[continuation]\ndepth = -9223372036854775808"},
                                                         {"\"p\"\nrange", "\"" + name + "\"\nrange"},
                                                         {"[-1.0, 0.5]", "[0.5, -1.0]"},
                                                         {"[-1.0, 0.5]", "[nan, 0.5]"},
                                                         {"[-1.0, 0.5]", "[]"},
                                                         {"[-1.0, 0.5]", "[" + std::string(3000, '[') + std::string(3000, ']') + "]"},
                                                         {"study = \"continuation\"", "study = \"" + name + "\""},
                                                         {"study = \"continuation\"", "study = 7"},
                                                         {"study = \"continuation\"", name + " = 1\nstudy = \"continuation\""},
                                                         {"study = \"continuation\"", "study = \"continuation\"\nstudy = \"periodic\""},
                                                         {"study = \"continuation\"", "study = \"continuation\"\nequilibrium_model = 3"},
                                                         {"study = \"continuation\"", ""}};
  const Folder f;
  for (const auto& [what, by] : changes) {
    INFO("'" << what << "' replaced by '" << by.substr(0, 60) << "'");
    check_refused(f, "run " + write(f, replaced(expressions, what, by)));
  }
  for (const std::string& text : {std::string(), std::string("\xff\xfe"), std::string("="), std::string(1000, '['), std::string("\0\0\0", 3), many}) {
    INFO("file '" << text.substr(0, 20) << "'");
    check_refused(f, "run " + write(f, text));
  }
  write(f, expressions);
  for (const std::string& set :
       {name + "=1", "equilibrium_model." + name + "=1", std::string("continuation.range=[1"), "=" + name, many + "=1", "continuation." + many,
        std::string("continuation.range[0]=1"), std::string("continuation.range[3]=1"), std::string("continuation.range[x]=1"),
        std::string("continuation[1].range=1"), std::string("equilibrium_model.rhs[1][1]=1"), std::string("a.b.c.d.e.f.g.h.i.j=1")}) {
    INFO("--set " << set.substr(0, 60));
    check_refused(f, "run my.toml --set '" + set + "'");
  }
  check_refused(f, "run '" + name.substr(0, 3000) + ".toml'");
  check_refused(f, "run my.toml --" + name);
}

TEST_CASE("extreme numbers in a modal model are refused", "[refusal]") {
  const Folder f;
  const std::pair<std::string, std::string> changes[] = {{"[3, 0]", "[-9223372036854775808, 1]"},
                                                         {"[3, 0]", "[9223372036854775807, 1]"},
                                                         {"[3, 0]", "[4294967299, 0]"},
                                                         {"[3, 0]", "[-1, 0]"},
                                                         {"[3, 0]", "[2.0, 1]"},
                                                         {"[3, 0]", "[]"},
                                                         {"[3, 0]", "[3, 0, 0]"},
                                                         {"equation = 1", "equation = -9223372036854775808"},
                                                         {"equation = 1", "equation = 4294967297"},
                                                         {"coefficient = 0.1", "coefficient = inf"},
                                                         {"[1.0, 2.0]", "[1.0, 1e400]"},
                                                         {"[1.0, 2.0]", "[1.0, nan]"},
                                                         {"[1.0, 2.0]", "[]"},
                                                         {"amplitude = 0.1", "amplitude = 0.1\nharmonic = -9223372036854775808"}};
  for (const auto& [what, by] : changes) {
    INFO(by);
    check_refused(f, "run " + write(f, replaced(modal, what, by)));
  }
}

TEST_CASE("byte order mark, line ends and inline tables change nothing", "[refusal]") {
  const auto model = [](const std::string& text, const std::vector<std::string>& overrides = {}) {
    Schema s("periodic", "");
    s.add_free(modal_model_section());
    s.add({.name = "continuation.range", .default_value = std::vector<double>{}});
    const std::vector<Schema> schemas{s};
    const Configuration c = Configuration::from_text(text, "my.toml", schemas, overrides);
    const auto again = modal_model_of(Configuration::from_text(c.resolved_toml(), "my.toml", schemas));
    const auto m = modal_model_of(c);
    CHECK(again.frequency == m.frequency);
    CHECK(again.terms.size() == m.terms.size());
    return m;
  };
  const auto plain = model(modal);
  std::string crlf;
  for (const char c : modal) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const std::string table =
      "{ frequency = [1.0, 2.0], damping = [0.05, 0.05], term = [{ equation = 1, coefficient = 0.1, powers = [3, 0], name = 'beta' }, "
      "{ equation = 2, coefficient = 0.1, powers = [0, 3], name = 'beta' }], force = [{ equation = 2, amplitude = 0.1 }] }";
  const std::string inline_text = "study = \"periodic\"\nmodal_model = " + table + "\n[continuation]\nrange = [1.5, 2.5]\n";
  for (const auto& m : {model("\xef\xbb\xbf" + modal), model(crlf), model(inline_text),
                        model("study = \"periodic\"\ncontinuation = { range = [1.5, 2.5] }\n", {"modal_model=" + table})}) {
    CHECK(m.frequency == plain.frequency);
    CHECK(m.damping == plain.damping);
    REQUIRE(m.terms.size() == 2);
    CHECK(m.terms[1].powers == std::vector<int>{0, 3});
    CHECK(m.terms[1].name == "beta");
    REQUIRE(m.forces.size() == 1);
    CHECK(m.forces[0].amplitude == 0.1);
  }
  const auto set = model(inline_text, {"modal_model.beta=0.7", "modal_model.frequency[2]=2.5", "modal_model.force[1].amplitude=0.3"});
  CHECK(set.terms[0].coefficient == 0.7);
  CHECK(set.terms[1].coefficient == 0.7);
  CHECK(set.frequency == std::vector<double>{1.0, 2.5});
  CHECK(set.forces[0].amplitude == 0.3);
  CHECK(model(modal, {"modal_model.term[2].coefficient=0.9"}).terms[1].coefficient == 0.9);
  CHECK_THAT(message([&] { (void)model(modal, {"modal_model.term[3].coefficient=0.9"}); }), Catch::EndsWith("there is no term[3]"));
  CHECK_THAT(message([&] {
               (void)model(modal, {"modal_model.term[2].coefficient=0.9", "modal_model.beta=0.5"});
             }),
             Catch::Contains("numbers that differ"));
  CHECK_THAT(message([&] { (void)model(modal, {"modal_model.beta=\"a\""}); }), Catch::Contains("must be a finite number"));
}
