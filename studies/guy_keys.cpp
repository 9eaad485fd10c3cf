#include "studies/guy_keys.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "models/guy/tangent.hpp"
#include "models/guy/transverse_modes.hpp"

namespace whirl::studies {

using namespace models::guy;

namespace {

Numbers numbers_of(const GuyInput& in) {
  const Statics& s = in.rest;
  const Guy& g = s.guy;
  const Tangent k = tangent(in.exact);
  const auto lower = curve_at(in.exact, 0.0), upper = curve_at(in.exact, in.exact.unstressed_length);
  const auto degrees = [](double slope) { return std::atan(slope) * 180.0 / std::numbers::pi; };
  return {{"horizontal_tension", "N", "H", s.horizontal_tension},
          {"lower_tension", "N", "tension at the anchor", s.lower_tension},
          {"upper_tension", "N", "tension at the mast", s.upper_tension},
          {"lower_slope", "-", "dy/dx at the anchor, exact form", lower.slope},
          {"upper_slope", "-", "dy/dx at the mast", upper.slope},
          {"lower_slope_deg", "deg", "angle to the horizontal at the anchor", degrees(lower.slope)},
          {"upper_slope_deg", "deg", "the same at the mast", degrees(upper.slope)},
          {"lower_vertical_tension", "N", "vertical part of the tension at the anchor, exact form", in.exact.horizontal_tension * lower.slope},
          {"upper_vertical_tension", "N", "the same at the mast", in.exact.horizontal_tension * upper.slope},
          {"unstressed_length", "m", "L0 in this condition's temperature", s.unstressed_length},
          {"length", "m", "L, stretched", s.length},
          {"sag", "m", "largest distance from the chord", s.sag},
          {"chord", "m", "Lc", g.chord()},
          {"inclination_deg", "deg", "of the chord", std::atan2(g.rise, g.horizontal_span) * 180.0 / std::numbers::pi},
          {"r", "-", "w l / 2H", s.r()},
          {"irvine_lambda2", "-", "(w l / Tm)^2 AE / Tm", s.irvine_lambda2()},
          {"weight", "N/m", "w, with ice", g.weight()},
          {"modulus_first_order", "N/m", "dH/dl, first-order form", horizontal_modulus(in.first_order)},
          {"modulus", "N/m", "dH/dl, exact form", k.xx},
          {"modulus_xy", "N/m", "coupling of horizontal and vertical", k.xy},
          {"modulus_yy", "N/m", "vertical", k.yy},
          {"modulus_zz", "N/m", "H/l, out of plane", k.zz},
          {"taut_modulus", "N/m", "AE cos^2 g / Lc", g.taut_modulus()},
          {"turnbuckle", "N/m", "dH/dL0 at fixed ends", tension_per_unstressed_length(in.exact)},
          {"first_frequency", "rad/s", "first transverse frequency, linear tension", s.first_frequency()},
          {"string_frequency", "rad/s", "of the mean-tension string along the chord", string_frequency(s, 1)},
          {"installed_horizontal_tension", "N", "H without ice and change of temperature", in.installed.horizontal_tension}};
}

}  // namespace

void add_guy_keys(Schema& s) {
  const auto positive = [&](const char* name, const char* unit, const char* description, double example) {
    s.add({.name = name, .unit = unit, .description = description, .required = true, .lower = 0.0, .example = Value{example}});
  };
  positive("guy.horizontal_span", "m", "l, horizontal distance from the anchor to the mast", 290.0);
  s.add({.name = "guy.rise", .unit = "m", .description = "h, height of the mast's end above the anchor", .required = true, .example = Value{411.0}});
  positive("guy.axial_stiffness", "N", "AE", 2.58e8);
  positive("guy.mass_per_length", "kg/m", "per unit unstressed length", 13.4);
  s.add({.name = "guy.gravity", .unit = "m/s^2", .description = "g", .default_value = 9.80665, .lower = 0.0});
  s.add({.name = "guy.known",
         .description = "which quantity guy.value gives; tensions, frequencies: the taut of two solutions",
         .default_value = std::string("horizontal_tension"),
         .choices = {"horizontal_tension", "unstressed_length", "sag", "lower_tension", "upper_tension", "first_frequency"}});
  s.add({.name = "guy.value",
         .unit = "N, m or rad/s",
         .description = "of the quantity guy.known names, as installed: no ice, reference temperature",
         .required = true,
         .lower = 0.0,
         .example = Value{157000.0}});
  s.add({.name = "guy.form",
         .description = "static form behind guy.value: the elastic catenary, or the first-order form of the literature",
         .default_value = std::string("exact"),
         .choices = {"exact", "first-order"}});
  s.add({.name = "condition.ice_mass_per_length",
         .unit = "kg/m",
         .description = "ice: weight and mass, no stiffness",
         .default_value = 0.0,
         .lower = 0.0,
         .closed_lower = true});
  s.add({.name = "condition.temperature_change",
         .unit = "K",
         .description = "since installation",
         .default_value = 0.0,
         .lower = -200.0,
         .upper = 200.0});
  s.add({.name = "condition.thermal_expansion",
         .unit = "1/K",
         .description = "of the rope",
         .default_value = 1.2e-5,
         .lower = 0.0,
         .upper = 1e-3,
         .closed_lower = true});
}

void add_guy_damping_keys(Schema& s) {
  s.add({.name = "damping.ratio",
         .description = "c/m = 2 ratio w_1, w_1 of the mean-tension string",
         .default_value = 0.005,
         .lower = 0.0,
         .upper = 0.5,
         .closed_lower = true});
  s.add({.name = "damping.rate",
         .unit = "1/s",
         .description = "c/m itself, in place of the ratio",
         .optional = true,
         .lower = 0.0,
         .closed_lower = true,
         .example = Value{0.01}});
}

GuyInput guy_of(const Configuration& c) {
  const Guy bare{c.number("guy.horizontal_span"), c.number("guy.rise"), c.number("guy.axial_stiffness"), c.number("guy.mass_per_length"),
                 c.number("guy.gravity")};
  blame(c, "guy.axial_stiffness", [&] { bare.validate(); });
  Known known = Known::horizontal_tension;
  for (const Known k : {Known::unstressed_length, Known::sag, Known::lower_tension, Known::upper_tension, Known::first_frequency})
    if (to_string(k) == c.text("guy.known")) known = k;
  const Form form = c.text("guy.form") == "exact" ? Form::exact : Form::first_order, other = form == Form::exact ? Form::first_order : Form::exact;
  GuyInput in;
  in.installed = blame(c, "guy.value", [&] { return solve(bare, known, c.number("guy.value"), form); });
  const double ice = c.number("condition.ice_mass_per_length"), warmer = c.number("condition.temperature_change");
  if (ice == 0.0 && warmer == 0.0) {
    in.rest = in.installed;
  } else {
    const double length = blame(c, "condition.temperature_change",
                                [&] { return heated_length(in.installed.unstressed_length, warmer, c.number("condition.thermal_expansion")); });
    in.rest = blame(c, ice > 0.0 ? "condition.ice_mass_per_length" : "condition.temperature_change",
                    [&] { return solve(with_ice(bare, ice), Known::unstressed_length, length, form); });
  }
  const Statics twin = blame(c, "guy.value", [&] { return at_horizontal_tension(in.rest.guy, in.rest.horizontal_tension, other); });
  in.exact = form == Form::exact ? in.rest : twin;
  in.first_order = form == Form::exact ? twin : in.rest;
  return in;
}

double damping_rate_of(const Configuration& c, const Statics& rest) {
  return c.has("damping.rate") ? c.number("damping.rate") : 2.0 * c.number("damping.ratio") * string_frequency(rest, 1);
}

std::vector<double> grid_of(const Configuration& c, const std::string& key, int points) {
  const auto& range = c.numbers(key);
  if (range.size() != 2 || !(range[0] < range[1])) throw c.error(key, "must be two increasing numbers");
  std::vector<double> grid;
  for (int i = 0; i < points; ++i) grid.push_back(range[0] + (range[1] - range[0]) * i / (points - 1));
  return grid;
}

void write_guy(ResultFile& file, RunContext& context, const GuyInput& in) {
  const Numbers numbers = numbers_of(in);
  write_numbers(file, "/guy", numbers);
  context.report.put("guy", numbers_json(numbers));
  context.print(numbers_text(numbers));
  const std::size_t rows = 101;
  const double L = in.exact.unstressed_length;
  const auto at = [&](std::size_t i) { return curve_at(in.exact, L * static_cast<double>(i) / (rows - 1)); };
  file.table(
      "/static_curve",
      {column("arc", "m", "unstressed arc from the anchor", rows, [&](auto i) { return L * static_cast<double>(i) / (rows - 1); }),
       column("x", "m", "horizontal", rows, [&](auto i) { return at(i).x; }), column("y", "m", "vertical", rows, [&](auto i) { return at(i).y; }),
       column("tension", "N", "static tension", rows, [&](auto i) { return at(i).tension; }),
       column("slope", "-", "dy/dx", rows, [&](auto i) { return at(i).slope; })});
}

std::vector<std::string> guy_warnings(const GuyInput& in) {
  std::vector<std::string> warnings;
  const double difference = horizontal_modulus(in.first_order) / tangent(in.exact).xx - 1.0;
  if (std::abs(difference) > 0.01)
    warnings.push_back(fmt::format("the first-order form's tangent is off by {:.2g} %: trust the exact form", 100.0 * difference));
  if (in.rest.r() > 0.5)
    warnings.push_back(
        fmt::format("a slack guy (w l / 2H = {:.3g}): closed forms of the dynamic stiffness and linear tension are not meant for it", in.rest.r()));
  if (in.rest.upper_tension > 0.01 * in.rest.guy.axial_stiffness)
    warnings.push_back(
        fmt::format("a strain of {:.2g} %: beyond the working range of steel ropes", 100.0 * in.rest.upper_tension / in.rest.guy.axial_stiffness));
  return warnings;
}

}  // namespace whirl::studies
