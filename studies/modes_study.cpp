#include "studies/modes_study.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "models/shallow/resonances.hpp"
#include "models/statics.hpp"
#include "studies/catenary_modes_study.hpp"
#include "studies/common_keys.hpp"
#include "studies/numbers.hpp"

namespace whirl::studies {
namespace {

using namespace models;
using namespace models::shallow;

struct GivenKey {
  const char* name;
  const char* unit;
  const char* description;
  Given given;
  double example;
};
const std::array<GivenKey, 5> given_keys = {{
    {"cable.chord_tension", "N", "static tension along the chord; 0: one of the next four is given", Given::chord_tension, 5.5e6},
    {"cable.sag", "m", "sag across the chord at midspan", Given::sag, 2.08},
    {"cable.unstressed_length", "m", "length before hanging", Given::unstressed_length, 199.86},
    {"cable.first_frequency", "Hz", "lowest frequency: first mode out of plane", Given::first_frequency, 0.384},
    {"cable.first_in_plane_frequency", "Hz", "first symmetric mode in plane; of several tensions the highest is taken",
     Given::first_in_plane_frequency, 0.481},
}};

Schema schema() {
  Schema s("modes", "statics, frequencies and mode shapes of a shallow cable, cross-over diagram, resonance conditions near");
  append_fields(s, [](std::string_view name) { return name.starts_with("cable.") && name != "cable.chord_tension"; });
  for (const auto& k : given_keys) {
    const bool tension = k.given == Given::chord_tension;  // shown by `whirl init`, so not optional; 0: not given
    s.add({.name = k.name,
           .unit = k.unit,
           .description = k.description,
           .optional = !tension,
           .lower = 0.0,
           .closed_lower = tension,
           .example = tension ? std::optional<Value>(k.example) : std::nullopt});
  }
  s.add_count("modes.count", "modes of each plane in the table", 6, 1, 200);
  s.add_count("modes.stations", "points of a mode shape", 201, 11, 100001);
  s.add({.name = "omega", .unit = "rad/s", .description = "excitation frequency to judge resonance conditions by", .optional = true, .lower = 0.0});
  s.add({.name = "resonances.tolerance",
         .description = "largest relative distance of a resonance condition that counts as near",
         .default_value = 0.1,
         .lower = 0.0,
         .upper = 1.0});
  s.add_count("resonances.superharmonics", "highest superharmonic order", 3, 1, 20);
  return s;
}

const GivenKey& given_of(const Configuration& c) {
  const GivenKey* found = nullptr;
  for (const auto& k : given_keys) {
    if (!c.is_given(k.name) || c.number(k.name) == 0.0) continue;
    if (found) throw c.error(k.name, fmt::format("is one too many beside {}: give one of the two", found->name));
    found = &k;
  }
  if (!found)
    throw InputError(
        fmt::format("{}: cable: needs one of chord_tension [N], sag [m], unstressed_length [m], first_frequency [Hz], "
                    "first_in_plane_frequency [Hz]",
                    c.source()));
  return *found;
}

Cable<double> cable_of(const Configuration& c) {
  if (c.kind() != "modes") return stay_of(c).cable;
  Cable<double> cable{c.number("cable.chord_length"),    c.number("cable.axial_stiffness"), 0.0,
                      c.number("cable.mass_per_length"), c.number("cable.inclination_deg"), c.number("cable.gravity")};
  const GivenKey& key = given_of(c);
  try {
    cable = complete(cable, key.given, c.number(key.name));
    (void)shallow::statics(cable);
    return cable;
  } catch (const std::invalid_argument& e) {
    throw c.error(key.name, e.what());
  }
}

std::vector<std::string> check(const Configuration& c) {
  std::vector<std::string> warnings;
  const Cable<double> cable = cable_of(c);
  const auto s = shallow::statics(cable);
  if (std::abs(s.sag_ratio) > 0.08)
    warnings.push_back(
        fmt::format("sag ratio {:.3g}: against the catenary the formulas are off by a few per cent (antisymmetric modes 6 %, the "
                    "inextensible symmetric ones 2 % at 1/8)",
                    s.sag_ratio));
  const GivenKey& key = given_of(c);
  if (key.given == Given::first_in_plane_frequency) {
    const auto all = tensions(cable, key.given, c.number(key.name));
    std::string list;
    for (const double T : all) list += fmt::format("{}{:.6g}", list.empty() ? "" : ", ", T);
    if (all.size() > 1) warnings.push_back(fmt::format("{} tensions have this in-plane frequency: {} N; the highest is taken", all.size(), list));
  }
  return warnings;
}

struct Report {
  Cable<double> cable;
  Statics statics;
  std::vector<ModeShape> modes;
  std::vector<Resonance> resonances;
  bool judged = false;  // an excitation frequency was given
};

Report report(const Configuration& c) {
  Report r{cable_of(c), {}, {}, {}};
  r.statics = shallow::statics(r.cable);
  const bool own = c.kind() == "modes";
  r.modes = lowest_modes(r.cable, own ? static_cast<int>(c.integer("modes.count")) : 4);
  ResonanceOptions o;
  if (c.has("omega") && (own || c.is_given("omega"))) o.omega = c.number("omega");
  r.judged = o.omega > 0.0;
  if (own) {
    o.tolerance = c.number("resonances.tolerance");
    o.superharmonics = static_cast<int>(c.integer("resonances.superharmonics"));
  }
  r.resonances = resonances(r.modes, o);
  return r;
}

// The cross-over lambda2 = (2 n pi)^2 nearest on a logarithmic scale.
int nearest_cross_over(double lambda2) { return std::max(1, static_cast<int>(std::lround(std::sqrt(lambda2) / (2.0 * std::numbers::pi)))); }

std::string text(const Report& r) {
  const auto& s = r.statics;
  const int near = nearest_cross_over(s.lambda2);
  std::string out = fmt::format(
      "tension {:.6g} N, sag {:.6g} m (1:{:.4g}), arc length {:.8g} m, unstressed {:.8g} m\n"
      "lambda2 = {:.6g} (Le/l = 1 + 8 r^2); cross-over {} at {:.5g}, {:.3g} times that\n\n",
      r.cable.chord_tension, s.sag, 1.0 / s.sag_ratio, s.arc_length, s.unstressed_length, s.lambda2, near, cross_over(near),
      cross_over(near) / s.lambda2);
  out += fmt::format("{:<5} {:<13} {:>10} {:>12} {:>11} {:>6} {:>16} {:>14} {:>10}\n", "mode", "family", "beta l", "omega [rad/s]", "f [Hz]", "nodes",
                     "tension [N/m]", "participation", "eff. mass");
  for (const auto& m : r.modes)
    out +=
        fmt::format("{:<5} {:<13} {:>10.6f} {:>13.7f} {:>11.7f} {:>6} {:>16.6g} {:>14.6f} {:>10.6f}\n", m.name(), to_string(m.family()),
                    m.frequency_number(), m.omega(), m.frequency_hz(), m.internal_nodes(), m.added_tension(), m.participation(), m.effective_mass());
  out += fmt::format("\n{:<14} {:<26} {:>14} {:>12}\n", "resonance", "condition", "at [rad/s]", "detuning");
  std::size_t shown = 0;
  for (const auto& q : r.resonances) {
    if (!q.driven || (!r.judged && q.kind == ResonanceKind::combination)) continue;
    ++shown;
    out += fmt::format("{:<14} {:<26} {:>14.7f} {:>12}\n", to_string(q.kind), q.condition, q.at,
                       std::isnan(q.detuning) ? "-" : fmt::format("{:+.5f}", q.detuning));
  }
  if (shown == 0) out += "none near that anything drives\n";
  if (shown < r.resonances.size())
    out += fmt::format("{} more hold that motion in plane does not drive, or join two modes\n", r.resonances.size() - shown);
  return out;
}

Numbers numbers_of(const Report& r) {
  const auto& s = r.statics;
  const auto e = elastic_correction(s.lambda2);
  return {{"chord_tension", "N", "static tension along the chord", r.cable.chord_tension},
          {"chord_length", "m", "l", r.cable.chord_length},
          {"sag", "m", "d, at midspan across the chord", s.sag},
          {"sag_ratio", "-", "r = d/l", s.sag_ratio},
          {"lambda2", "-", "(8 d/l)^2 l EA/(T Le), Le/l = 1 + 8 r^2", s.lambda2},
          {"irvine_lambda2", "-", "the same with Le/l = 1 + (8/3) r^2, as the modal models take it", parabola(r.cable).irvine_lambda2},
          {"effective_length", "m", "Le", s.effective_length},
          {"arc_length", "m", "under tension", s.arc_length},
          {"unstressed_length", "m", "arc length less the stretch", s.unstressed_length},
          {"tension_drop", "-", "H* of the elastic parabola, were this tension the inextensible cable's", e.tension_drop},
          {"sag_increase", "-", "d* = H*/(1 - H*)", e.sag_increase}};
}

void write_modes(ResultFile& file, const std::vector<ModeShape>& modes) {
  TextColumn name{"mode", "y out of plane, z in plane, and the half waves of the taut string it comes from", {}},
      family{"family", "out of plane, symmetric or antisymmetric in plane", {}};
  std::vector<Column> columns;
  const auto add = [&](const char* title, const char* unit, const char* description, auto value) {
    Column column{title, unit, description, {}};
    for (const auto& m : modes) column.values.push_back(value(m));
    columns.push_back(std::move(column));
  };
  for (const auto& m : modes) {
    name.values.push_back(m.name());
    family.values.emplace_back(to_string(m.family()));
  }
  add("half_waves", "-", "of the taut string's sine", [](const auto& m) { return m.half_waves(); });
  add("order", "-", "within the family", [](const auto& m) { return m.order(); });
  add("frequency_number", "-", "b = beta l = omega l sqrt(m/T)", [](const auto& m) { return m.frequency_number(); });
  add("omega", "rad/s", "frequency", [](const auto& m) { return m.omega(); });
  add("frequency", "Hz", "frequency", [](const auto& m) { return m.frequency_hz(); });
  add("nodes", "-", "zeros of the transverse shape between the supports", [](const auto& m) { return m.internal_nodes(); });
  add("added_tension", "N/m", "tension along the chord a metre of amplitude", [](const auto& m) { return m.added_tension(); });
  add("participation", "-", "int v / int v^2", [](const auto& m) { return m.participation(); });
  add("effective_mass", "-", "(int v)^2 / int v^2, share of the cable's mass", [](const auto& m) { return m.effective_mass(); });
  add("mean_square", "-", "int v^2: modal mass over m l", [](const auto& m) { return m.mean_square(); });
  file.table("/modes", columns, {name, family});
}

void write_shape(ResultFile& file, const ModeShape& m, std::size_t stations) {
  Column xi{"xi", "-", "x/l", {}}, v{"transverse", "-", "v or w, a metre of amplitude", {}}, u{"longitudinal", "-", "u along the chord", {}};
  for (std::size_t i = 0; i < stations; ++i) {
    const double x = static_cast<double>(i) / static_cast<double>(stations - 1);
    xi.values.push_back(x);
    v.values.push_back(m.transverse(x));
    u.values.push_back(m.longitudinal(x));
  }
  const std::string group = "/shapes/" + m.name();
  file.table(group, {xi, v, u});
  file.attribute(group, "family", std::string(to_string(m.family())));
  file.attribute(group, "order", static_cast<double>(m.order()));
  file.attribute(group, "frequency", m.frequency_hz());
}

// Frequency numbers of the symmetric modes against lambda2, from the taut string to the inextensible cable.
void write_cross_over(ResultFile& file) {
  constexpr int modes = 4, points = 400;
  Column lambda2{"lambda2", "-", "(8 d/l)^2 l EA/(T Le)", {}};
  std::vector<Column> columns;
  for (int n = 1; n <= modes; ++n) columns.push_back({fmt::format("symmetric{}", n), "-", "frequency number b of the n-th symmetric mode", {}});
  for (int i = 0; i <= points; ++i) {
    lambda2.values.push_back(std::pow(10.0, -1.0 + 5.0 * i / points));
    for (int n = 1; n <= modes; ++n) columns[static_cast<std::size_t>(n - 1)].values.push_back(shallow::symmetric_root(lambda2.values.back(), n));
  }
  columns.insert(columns.begin(), lambda2);
  file.table("/cross_over", columns);
}

// The first symmetric mode below, at and above its cross-over, at the cable's own sag ratio.
void write_forms(ResultFile& file, const Report& r, std::size_t stations) {
  Column xi{"xi", "-", "x/l", {}};
  std::vector<Column> columns;
  std::vector<double> values;
  for (std::size_t i = 0; i < stations; ++i) xi.values.push_back(static_cast<double>(i) / static_cast<double>(stations - 1));
  for (const double factor : {0.25, 1.0, 4.0}) {
    Statics s = r.statics;
    s.lambda2 = factor * cross_over(1);
    const ModeShape m(s, r.cable, Family::symmetric, 1);
    Column column{fmt::format("form{}", columns.size() + 1), "-", "v of the first symmetric mode", {}};
    for (const double x : xi.values) column.values.push_back(m.transverse(x));
    columns.push_back(std::move(column));
    values.push_back(s.lambda2);
  }
  columns.insert(columns.begin(), xi);
  file.table("/symmetric_forms", columns);
  file.attribute("/symmetric_forms", "lambda2", values);
}

void write_resonances(ResultFile& file, const Report& r) {
  TextColumn kind{"kind", "primary, superharmonic, parametric, combination, internal", {}}, condition{"condition", "what agrees", {}},
      first{"first", "mode", {}}, second{"second", "other mode, where there is one", {}};
  Column at{"at", "rad/s", "excitation frequency that meets it; internal: frequency of the first mode", {}},
      detuning{"detuning", "-", "relative distance from it", {}},
      driven{"driven", "-", "1: motion in the plane of the chord has terms that drive it", {}};
  for (const auto& q : r.resonances) {
    kind.values.emplace_back(to_string(q.kind));
    condition.values.push_back(q.condition);
    first.values.push_back(q.first);
    second.values.push_back(q.second);
    at.values.push_back(q.at);
    detuning.values.push_back(q.detuning);
    driven.values.push_back(q.driven ? 1.0 : 0.0);
  }
  file.table("/resonances", {at, detuning, driven}, {kind, condition, first, second});
}

void put_modes(Json& results, const Report& r) {
  Json modes = Json::array(), near = Json::array();
  for (const auto& m : r.modes) {
    Json o = Json::object();
    o.put("mode", m.name()).put("family", to_string(m.family())).put("order", m.order()).put("frequency_number", m.frequency_number());
    o.put("omega", m.omega()).put("frequency", m.frequency_hz()).put("nodes", m.internal_nodes()).put("added_tension", m.added_tension());
    modes.add(std::move(o.put("participation", m.participation()).put("effective_mass", m.effective_mass())));
  }
  for (const auto& q : r.resonances) {
    Json o = Json::object();
    o.put("kind", to_string(q.kind)).put("condition", q.condition).put("at", q.at).put("detuning", q.detuning);
    near.add(std::move(o.put("driven", q.driven)));
  }
  results.put("chord_tension", r.cable.chord_tension).put("lambda2", r.statics.lambda2);
  results.put("cable", numbers_json(numbers_of(r))).put("modes", std::move(modes)).put("resonances", std::move(near));
}

ExitStatus run(const Configuration& c, RunContext& context) {
  for (const auto& w : check(c)) context.warn(w);
  const Report r = report(c);
  const auto stations = static_cast<std::size_t>(c.integer("modes.stations"));
  ResultFile file(context.output);
  write_study(file, c);
  write_numbers(file, "/cable", numbers_of(r));
  write_modes(file, r.modes);
  for (const auto& m : r.modes) write_shape(file, m, stations);
  for (int n = 1; n <= 2; ++n)  // always there: their longitudinal motion is a figure
    write_shape(file, ModeShape(r.statics, r.cable, Family::antisymmetric, n), stations);
  write_cross_over(file);
  write_forms(file, r, stations);
  write_resonances(file, r);
  put_modes(context.report, r);
  context.print(text(r));
  return finish(file, context, ExitStatus::ok, {"all modes computed"});
}

}  // namespace

StudyKind modes_study() { return {schema(), run, check}; }

std::string modes_table(const Configuration& c) {
  if (c.schema().find("cable.height_difference")) return hanging_modes_table(c);
  if (!c.schema().find("cable.chord_tension")) throw InputError(fmt::format("{}: a {} study has no [cable]", c.source(), c.kind()));
  return text(report(c));
}

}  // namespace whirl::studies
