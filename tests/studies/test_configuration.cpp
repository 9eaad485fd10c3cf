/// Reading study files: every accepted form, and the exact line every kind of bad input gives.

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>

#include "studies/configuration.hpp"
#include "tests/studies/refusal.hpp"

using namespace whirl::studies;
using namespace whirl::studies::tests;

namespace {

const std::vector<Schema>& schemas() {
  static const std::vector<Schema> all = [] {
    Schema response("superharmonic", "superharmonic response of a stay");
    append_fields(response);
    response.add({.name = "cable.coefficients", .description = "source", .default_value = "exact", .choices = {"exact", "as-printed"}});
    response.add({.name = "response.order", .description = "order", .default_value = std::int64_t{2}, .lower = 1.0, .closed_lower = true});
    response.add({.name = "continuation.parameter", .description = "what is varied", .default_value = "omega"});
    response.add({.name = "continuation.range",
                  .unit = "rad/s",
                  .description = "from, to",
                  .default_value = std::vector<double>{},
                  .required = true,
                  .lower = 0.0,
                  .min_items = 2,
                  .max_items = 2,
                  .example = std::vector<double>{1.2, 2.4}});
    response.add({.name = "continuation.mirror", .description = "follow the mirror branch", .default_value = false});
    response.add({.name = "verification.omega",
                  .unit = "rad/s",
                  .description = "where the time integration runs",
                  .default_value = std::vector<double>{},
                  .optional = true,
                  .lower = 0.0,
                  .min_items = 1});
    response.add({.name = "output.tables", .description = "what is kept", .default_value = std::vector<std::string>{"branches"}});
    response.add({.name = "output.title", .description = "title", .default_value = "", .optional = true});
    Schema modal("modal", "a modal model of one's own");
    modal.add({.name = "steps", .description = "number of steps", .default_value = std::int64_t{10}});
    modal.add_free({.name = "modal_model", .description = "the model", .example = "[modal_model]\nsize = 2", .required = true});
    return std::vector<Schema>{response, modal};
  }();
  return all;
}

const std::string good = R"(study = "superharmonic"
[cable]
chord_length = 260
axial_stiffness = 2.17e9
chord_tension = 5.5e6
mass_per_length = 81.05
[support_motion]
amplitude = 0.5
[continuation]
range = [1.2, 2]
)";

Configuration read(const std::string& text, const Configuration::Overrides& overrides = {}) {
  return Configuration::from_text(text, "my.toml", schemas(), overrides);
}

std::string complaint(const std::string& text, const Configuration::Overrides& overrides = {}) {
  return message([&] { read(text, overrides); });
}

std::string complaint_about(const std::string& what, const std::string& by) { return complaint(replaced(good, what, by)); }

std::string set(const std::string& assignment) { return complaint(good, {assignment}); }

void check_same(const Configuration& a, const Configuration& b) {
  a.each([&](const Key& key, const Value& value) {
    INFO(key.name);
    REQUIRE(b.has(key.name));
    b.each([&](const Key& other, const Value& other_value) {
      if (other.name == key.name) CHECK(value == other_value);
    });
  });
  CHECK(a.resolved_toml() == b.resolved_toml());
}

}  // namespace

TEST_CASE("a study file gives typed values and defaults", "[configuration]") {
  const Configuration c = read(good);
  CHECK(c.kind() == "superharmonic");
  CHECK(c.source() == "my.toml");
  CHECK(c.number("cable.chord_length") == 260.0);  // an integer where a number is wanted
  CHECK(c.number("cable.gravity") == 9.81);
  CHECK(c.integer("response.order") == 2);
  CHECK(c.number("response.order") == 2.0);
  CHECK_FALSE(c.flag("continuation.mirror"));
  CHECK(c.text("cable.coefficients") == "exact");
  CHECK(c.numbers("continuation.range") == std::vector<double>{1.2, 2.0});
  CHECK(c.texts("output.tables") == std::vector<std::string>{"branches"});
  CHECK_FALSE(c.has("verification.omega"));
  CHECK(c.is_given("cable.chord_length"));
  CHECK_FALSE(c.is_given("cable.gravity"));
  CHECK(c.place("cable.chord_tension") == "my.toml:5");
  CHECK(std::string(c.error("cable.chord_tension", "the cable is slack").what()) == "my.toml:5: cable.chord_tension = 5500000.0: the cable is slack");
  CHECK_THROWS_AS(c.number("cable.colour"), std::invalid_argument);
  CHECK_THROWS_AS(c.number("verification.omega"), std::invalid_argument);
  CHECK_THROWS_AS(c.integer("cable.gravity"), std::invalid_argument);

  const auto stay = stay_parameters(c);
  CHECK(stay.cable.chord_tension == 5.5e6);
  CHECK(stay.damping_in_plane == 0.01);
  CHECK(stay.support_amplitude == 0.5);
}

TEST_CASE("overrides win over the file", "[configuration]") {
  const Configuration c = read(good, {"cable.chord_tension=6e6", "cable.coefficients=as-printed", "continuation.range = [1, 3]",
                                      "verification.omega=[1.5]", "output.title=\"a=b\"", "continuation.mirror=true", "cable.inclination_deg=90"});
  CHECK(c.number("cable.chord_tension") == 6e6);
  CHECK(c.text("cable.coefficients") == "as-printed");
  CHECK(c.numbers("continuation.range") == std::vector<double>{1.0, 3.0});
  CHECK(c.numbers("verification.omega") == std::vector<double>{1.5});
  CHECK(c.text("output.title") == "a=b");
  CHECK(c.flag("continuation.mirror"));
  CHECK(c.number("cable.inclination_deg") == 90.0);  // both ends of its range belong to it
  CHECK(c.place("cable.chord_tension") == "--set");
  CHECK(read(good, {"study=superharmonic"}).kind() == "superharmonic");
}

TEST_CASE("a file that cannot be read", "[configuration]") {
  const auto folder = std::filesystem::temp_directory_path() / "whirl-test-configuration";
  std::filesystem::create_directories(folder);
  const auto from = [](const std::filesystem::path& path) { return message([&] { Configuration::from_file(path, schemas()); }); };
  CHECK(from("no/such.toml") == "no/such.toml: no such file");
  CHECK(from(folder) == folder.string() + ": is a directory, not a study file");
  CHECK(from("/dev/zero") == "/dev/zero: larger than 16 MB, not a study file");
  CHECK(from("") == ": no such file");
  const auto path = folder / "good.toml";
  std::ofstream(path) << good;
  CHECK(Configuration::from_file(path, schemas()).source() == path.string());
  std::filesystem::remove_all(folder);
}

TEST_CASE("text that is not TOML", "[configuration]") {
  CHECK_THAT(complaint_about("range = [1.2, 2]", "range = [1.2,"), Catch::StartsWith("my.toml:1") && Catch::Contains(": not valid TOML: "));
  CHECK_THAT(complaint(good + "omega 3\n"), Catch::StartsWith("my.toml:11: not valid TOML: "));
  CHECK_THAT(complaint_about("chord_tension = 5.5e6", "chord_length = 1"), Catch::StartsWith("my.toml:5: not valid TOML: "));
  for (const std::string bad :
       {"[=", "[", "]", "=", "a", "a=", "a=\"", "a='''", "[[", "[[a", "a={", "a=[", "a=0x", "a=1__0", "a=\"\\u12\"", "\xff\xfe"})
    CHECK_THAT(complaint(bad), Catch::StartsWith("my.toml:1: not valid TOML: "));
  CHECK_THAT(complaint(std::string("a=\0", 3)), Catch::StartsWith("my.toml:1: not valid TOML: "));
  std::string name = "a";
  for (int i = 0; i < 100000; ++i) name += ".a";
  CHECK(complaint("\n" + name + " = 1") == "my.toml:2: not valid TOML: sections nested too deeply");
  name.resize(401);
  CHECK(complaint("study = 'modal'\nmodal_model." + name + " = 1").ends_with(": sections nested too deeply"));
  CHECK_THAT(complaint("study = " + std::string(100000, '[')), Catch::StartsWith("my.toml:1: not valid TOML: "));
}

TEST_CASE("the kind of a study", "[configuration]") {
  CHECK(complaint("") == "my.toml: study is missing: must be one of \"superharmonic\", \"modal\"");
  CHECK(complaint("study = 3") == "my.toml:1: study = 3: must be one of \"superharmonic\", \"modal\"");
  CHECK(complaint("\nstudy = 'superharmnoic'") == "my.toml:2: study = \"superharmnoic\": unknown kind, did you mean \"superharmonic\"?");
  CHECK(complaint("study = 'tea'") == "my.toml:1: study = \"tea\": unknown kind, must be one of \"superharmonic\", \"modal\"");
  CHECK(set("study=tea") == "--set: study = \"tea\": unknown kind, must be one of \"superharmonic\", \"modal\"");
}

TEST_CASE("unknown keys", "[configuration]") {
  CHECK(complaint_about("gth = 260", "gth = 260\nchord_tention = 1") ==
        "my.toml:4: cable.chord_tention = 1: unknown key, did you mean cable.chord_tension?");
  CHECK(complaint_about("[cable]", "[cabel]") == "my.toml:2: [cabel]: unknown section, did you mean [cable]?");
  CHECK(complaint_about("[cable]", "chord_tension = 3\n[cable]") == "my.toml:2: chord_tension = 3: unknown key, did you mean cable.chord_tension?");
  CHECK(complaint_about("amplitude = 0.5", "amplitude = 0.5\ncolour = 'red'") ==
        "my.toml:9: support_motion.colour = \"red\": unknown key; [support_motion] takes amplitude");
  CHECK(complaint(good + "[tea]\n") ==
        "my.toml:11: [tea]: unknown section; this study takes [cable], [damping], [support_motion], omega, [response], [continuation], "
        "[verification], [output]");
  CHECK(complaint("study = 'superharmonic'\ncable = 5") == "my.toml:2: cable = 5: must be a section");
  CHECK(complaint_about("[cable]", "\"cable.gravity\" = 5\n[cable]") == "my.toml:2: \"cable.gravity\": a key must not contain a dot");
  CHECK(set("cable.gravitiy=1") == "--set: cable.gravitiy = 1: unknown key, did you mean cable.gravity?");
  CHECK(set("cabel.gravity=1") == "--set: [cabel]: unknown section, did you mean [cable]?");
}

TEST_CASE("missing keys point at their section", "[configuration]") {
  CHECK(complaint_about("chord_tension = 5.5e6\n", "") == "my.toml:2: cable.chord_tension is missing: must be a number > 0 [N]");
  CHECK(complaint_about("[support_motion]\namplitude = 0.5\n", "") == "my.toml: support_motion.amplitude is missing: must be a number >= 0 [m]");
  CHECK(complaint("study = 'modal'") == "my.toml: [modal_model] is missing: the model");
}

TEST_CASE("values of another type", "[configuration]") {
  CHECK(complaint_about("5.5e6", "'big'") == "my.toml:5: cable.chord_tension = \"big\": must be a number > 0 [N]");
  CHECK(complaint_about("5.5e6", "true") == "my.toml:5: cable.chord_tension = true: must be a number > 0 [N]");
  CHECK(complaint_about("5.5e6", "1979-05-27") == "my.toml:5: cable.chord_tension = 1979-05-27: must be a number > 0 [N]");
  CHECK(complaint_about("5.5e6", "[5.5e6]") == "my.toml:5: cable.chord_tension = [5500000.0]: must be a number > 0 [N]");
  CHECK(complaint_about("5.5e6", "{a = 1}") == "my.toml:5: cable.chord_tension = {a = 1}: must be a number > 0 [N]");
  CHECK(complaint_about("[1.2, 2]", "1.2") == "my.toml:10: continuation.range = 1.2: must be an array of 2 numbers, each > 0 [rad/s]");
  CHECK(complaint_about("[1.2, 2]", "[1.2, 'a']") ==
        "my.toml:10: continuation.range = [1.2, \"a\"]: must be an array of 2 numbers, each > 0 [rad/s]");
  CHECK(set("damping.in_plane=-0.1") == "--set: damping.in_plane = -0.1: must be >= 0 and <= 1");
  CHECK(set("response.order=2.5") == "--set: response.order = 2.5: must be an integer >= 1");
  CHECK(set("continuation.mirror=1") == "--set: continuation.mirror = 1: must be true or false");
  CHECK(set("continuation.parameter=1") == "--set: continuation.parameter = 1: must be a text in quotes");
  CHECK(set("output.tables=[1]") == "--set: output.tables = [1]: must be an array of texts");
}

TEST_CASE("values outside the accepted range", "[configuration]") {
  CHECK(complaint_about("5.5e6", "-5") == "my.toml:5: cable.chord_tension = -5: must be > 0 [N]");
  CHECK(complaint_about("5.5e6", "0") == "my.toml:5: cable.chord_tension = 0: must be > 0 [N]");
  CHECK(complaint_about("5.5e6", "inf") == "my.toml:5: cable.chord_tension = inf: must be a finite number > 0 [N]");
  CHECK(complaint_about("5.5e6", "nan") == "my.toml:5: cable.chord_tension = nan: must be a finite number > 0 [N]");
  CHECK_THAT(complaint_about("5.5e6", "1e999"), Catch::StartsWith("my.toml:5: "));
  CHECK(set("cable.inclination_deg=90.5") == "--set: cable.inclination_deg = 90.5: must be >= -90 and <= 90 [deg]");
  CHECK(set("response.order=0") == "--set: response.order = 0: must be >= 1");
  CHECK(set("cable.coefficients=printed") == "--set: cable.coefficients = \"printed\": must be one of \"exact\", \"as-printed\"");
  CHECK(set("continuation.range=[1, -2]") == "--set: continuation.range = [1, -2]: each value must be > 0 [rad/s]");
  CHECK(set("continuation.range=[1, inf]") == "--set: continuation.range = [1, inf]: each value must be a finite number > 0 [rad/s]");
  CHECK(set("continuation.range=[1, 2, 3]") == "--set: continuation.range = [1, 2, 3]: must be an array of 2 numbers, each > 0 [rad/s]");
  CHECK(set("verification.omega=[]") == "--set: verification.omega = []: must be an array of at least 1 number, each > 0 [rad/s]");
}

TEST_CASE("overrides that are none", "[configuration]") {
  CHECK(set("cable.gravity") == "--set: cable.gravity: must be key=value");
  CHECK(set("=3") == "--set: =3: must be key=value");
  CHECK(set("cable..gravity=3") == "--set: cable..gravity=3: must be key=value");
  CHECK(set(".=3") == "--set: .=3: must be key=value");
  CHECK(set("") == "--set: : must be key=value");
  CHECK(set("cable.gravity=") == "--set: cable.gravity=: the value is neither TOML nor a bare word");
  CHECK(set("cable.gravity=[1,") == "--set: cable.gravity=[1,: the value is neither TOML nor a bare word");
  CHECK(set("cable.gravity=1\nx=2") == "--set: cable.gravity=1 x=2: the value is neither TOML nor a bare word");
  CHECK(set("cable.gravity.x=1") == "--set: cable.gravity = {x = 1}: must be a number >= 0 [m/s^2]");
  CHECK(set("cable.chord_length.x=1") == "--set: cable.chord_length.x=1: chord_length is not a section");
}

TEST_CASE("the resolved configuration reads back the same", "[configuration]") {
  const Configuration c = read(good, {"cable.gravity=9.80665000000000001", "output.title=\"a \\\"quoted\\\" \\\\ line\\n\\u0001 end: \u03c9\"",
                                      "verification.omega=[0.1, 1e-300, 123456789012345678]", "damping.in_plane=0.1234567890123456789"});
  const Configuration again = read(c.resolved_toml());
  check_same(c, again);
  CHECK(again.text("output.title") == "a \"quoted\" \\ line\n\x01 end: \u03c9");
  CHECK_THAT(c.resolved_toml(), Catch::StartsWith("study = \"superharmonic\"\nomega = 1.0\n\n[cable]\nchord_length = 260.0\n"));
}

TEST_CASE("a free section is handed over unchecked, with its lines", "[configuration]") {
  const std::string text = R"(study = "modal"
steps = 3

[modal_model]
size = 2
frequencies = [0.1, 1.2345678901234567]
[[modal_model.terms]]
power = [1, 2]
[[modal_model.terms]]
coefficient = -3.0
)";
  const Configuration c = read(text, {"modal_model.size=4"});
  CHECK(c.has("modal_model"));
  CHECK(c.raw_line("modal_model") == 4);
  CHECK(c.place("modal_model.terms[1].coefficient") == "my.toml:10");
  CHECK(c.place("modal_model.size") == "--set");
  CHECK_THAT(c.raw("modal_model"), Catch::Contains("size = 4") && Catch::Contains("1.2345678901234567") && !Catch::Contains("[modal_model]"));
  CHECK(c.raw("other").empty());
  CHECK(c.raw_line("other") == 0);
  const Configuration again = read(c.resolved_toml());
  check_same(c, again);
  CHECK(again.raw("modal_model") == c.raw("modal_model"));
  CHECK(complaint("study = 'modal'\nmodal_model = 3") == "my.toml:2: modal_model = 3: must be a section");
  CHECK(complaint("study = 'modal'\n[modal_modle]\nsize = 2") == "my.toml:2: [modal_modle]: unknown section, did you mean [modal_model]?");
}

TEST_CASE("the example is a study that can be read", "[configuration]") {
  const std::string text = example_toml(schemas()[0]);
  CHECK_THAT(text, Catch::Contains("# static tension along the chord: a number > 0 [N]; required\nchord_tension = 5500000.0\n"));
  CHECK_THAT(text, Catch::Contains("# acceleration of gravity: a number >= 0 [m/s^2]; default 9.81\ngravity = 9.81\n"));
  CHECK_THAT(text, Catch::Contains("# source: one of \"exact\", \"as-printed\"; default \"exact\"\ncoefficients = \"exact\"\n"));
  CHECK_THAT(text, Catch::Contains("\n[continuation]\n") && Catch::Contains("\nrange = [1.2, 2.4]\n") && Catch::Contains("\n# omega =\n"));
  CHECK(read(text).number("support_motion.amplitude") == 0.5);
  CHECK(complaint(replaced(text, "chord_length = 260.0\n", "")).ends_with("cable.chord_length is missing: must be a number > 0 [m]"));
  CHECK_THAT(example_toml(schemas()[1]), Catch::Contains("# [modal_model] the model; required\n# [modal_model]\n# size = 2\n"));
}

TEST_CASE("a schema refuses what contradicts itself", "[configuration]") {
  Schema s("k", "");
  s.add({.name = "a", .default_value = 1.0, .lower = 0.0});
  CHECK_THROWS_AS(s.add({.name = "a"}), std::invalid_argument);
  CHECK_THROWS_AS(s.add({.name = "b", .default_value = -1.0, .lower = 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(s.add({.name = "c", .default_value = "x", .choices = {"y"}}), std::invalid_argument);
  CHECK(s.nearest("aa") == "a");
  CHECK(schemas()[0].nearest("cabel.gravty") == "cable.gravity");
  CHECK(schemas()[0].nearest("support_motion.colour").empty());
  CHECK(nearest("chord", {"xxxrd", "tension"}).empty());
  CHECK(nearest("ch", {"hc"}) == "hc");  // one swap
}

TEST_CASE("mutilated input never gets past InputError", "[configuration]") {
  unsigned state = 1;
  const auto random = [&](std::size_t n) { return (state = state * 1664525u + 1013904223u) / 65536u % n; };
  const std::string alphabet = "[]{}=\"'.,#\n\\-+_e09xtuf \t\xff";
  for (int run = 0; run < 5000; ++run) {
    std::string text = good;
    for (std::size_t k = 0; k <= random(6); ++k) {
      const std::size_t at = random(text.size());
      if (random(3) == 0) text.erase(at, random(8));
      if (text.empty()) text = "x";
      text.insert(std::min(at, text.size()), 1, alphabet[random(alphabet.size())]);
    }
    try {
      check_same(read(text), read(read(text).resolved_toml()));
    } catch (const InputError& e) {
      REQUIRE(std::string(e.what()).find('\n') == std::string::npos);
    }
  }
}
