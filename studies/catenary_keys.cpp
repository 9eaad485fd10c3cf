#include "studies/catenary_keys.hpp"

#include "studies/common_keys.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace whirl::studies {

using namespace models::catenary;

namespace {

struct GeometryKey {
  const char *key, *noun, *unit, *description;
  std::optional<double> GeometryInput::*member;
  std::optional<double> example;
};

const GeometryKey quantities[] = {
    {"cable.span", "span", "m", "b, horizontal distance between the supports", &GeometryInput::span, 100.0},
    {"cable.height_difference", "height difference", "m", "h, upper support above the lower one", &GeometryInput::height, 0.0},
    {"cable.length", "length", "m", "l, length of the hanging cable", &GeometryInput::length, 117.6},
    {"cable.sag", "sag", "m", "f, vertical distance from the chord to the cable at half the span", &GeometryInput::sag, std::nullopt},
    {"cable.horizontal_tension", "horizontal tension", "N", "H, horizontal part of the static tension", &GeometryInput::horizontal_tension,
     std::nullopt},
    {"cable.upper_tension", "tension at the upper end", "N", "static tension at the upper support; of two such cables the taut one",
     &GeometryInput::upper_tension, std::nullopt},
};

// The key a refusal speaks of first; the first key given where it names none.
std::string culprit(const Configuration& c, const std::string& message) {
  std::size_t first = std::string::npos;
  std::string key;
  for (const GeometryKey& q : quantities) {
    if (!c.has(q.key)) continue;
    if (key.empty()) key = q.key;
    if (const auto at = message.find(q.noun); at < first) {
      first = at;
      key = q.key;
    }
  }
  return key;
}

}  // namespace

void add_hanging_cable_keys(Schema& s, bool drag) {
  for (const GeometryKey& q : quantities)
    s.add({.name = q.key,
           .unit = q.unit,
           .description = fmt::format("{}; three of span, height_difference, length, sag and a tension are given", q.description),
           .optional = true,
           .suggested = q.example.has_value(),
           .lower = 0.0,
           .closed_lower = q.member == &GeometryInput::height,
           .example = q.example ? std::optional<Value>(*q.example) : std::nullopt});
  s.add({.name = "cable.mass_per_length",
         .unit = "kg/m",
         .description = "mass per unit length",
         .required = true,
         .lower = 0.0,
         .example = Value{10.0}});
  s.add({.name = "cable.gravity", .unit = "m/s^2", .description = "acceleration of gravity", .default_value = 9.81, .lower = 0.0});
  s.add({.name = "cable.axial_stiffness",
         .unit = "N",
         .description = "EA; left out: inextensible",
         .optional = true,
         .lower = 0.0,
         .example = Value{2.0e7}});
  if (!drag) return;
  for (const auto& [name, direction] : {std::pair{"tangential", "along the cable"}, {"normal", "across it, in plane"}, {"lateral", "out of plane"}})
    s.add({.name = fmt::format("drag.{}", name),
           .unit = "N s/m^2",
           .description = fmt::format("linear drag {}: force per length and velocity", direction),
           .default_value = 0.0,
           .lower = 0.0,
           .closed_lower = true});
}

HangingCable hanging_cable_of(const Configuration& c) {
  GeometryInput in;
  std::string given;
  int count = 0;
  for (const GeometryKey& q : quantities)
    if (c.has(q.key)) {
      in.*q.member = c.number(q.key);
      given = q.key;
      ++count;
    }
  if (count == 0) throw InputError(fmt::format("{}: [cable] needs three of span, height_difference, length, sag and a tension", c.source()));
  in.weight_per_length = c.number("cable.mass_per_length") * c.number("cable.gravity");
  try {
    HangingCable cable{.shape = geometry(in), .mass_per_length = c.number("cable.mass_per_length"), .gravity = c.number("cable.gravity")};
    if (c.has("cable.axial_stiffness")) cable.axial_stiffness = c.number("cable.axial_stiffness");
    if (c.schema().find("drag.normal") != nullptr) {
      cable.drag_tangential = c.number("drag.tangential");
      cable.drag_normal = c.number("drag.normal");
      cable.drag_lateral = c.number("drag.lateral");
    }
    return cable;
  } catch (const std::invalid_argument& e) {
    throw c.error(count == 3 ? culprit(c, e.what()) : given, e.what());
  } catch (const std::exception&) {  // a search that met overflow or underflow
    throw c.error(given, "lengths and tensions of such sizes are beyond the reach of this computer's numbers");
  }
}

std::vector<std::string> hanging_cable_warnings(const HangingCable& cable) {
  const double steepest = std::max(std::abs(cable.shape.x1), cable.shape.x2), strain = core_of(cable).kappa * std::cosh(steepest);
  std::vector<std::string> warnings;
  if (strain >= 1e-3)
    warnings.push_back(
        fmt::format("the static stretch, up to {:.2g} of the length, is left out of the shape: give the stretched length, or the sag", strain));
  if (steepest > 9.0)  // seen: 1e-17 times the square of the slope, and a hundredfold where the cable stretches
    warnings.push_back(fmt::format("an end stands at a slope of {:.2g}: frequencies in plane keep about {:.0f} digits", std::sinh(steepest),
                                   std::max(0.0, (core_of(cable).kappa > 0.0 ? 15.0 : 17.0) - 2.0 * std::log10(std::sinh(steepest)))));
  return warnings;
}

Numbers hanging_cable_numbers(const HangingCable& cable) {
  const Geometry& g = cable.shape;
  const CoreCable core = core_of(cable);
  const double H = horizontal_tension(cable);
  const auto degrees = [](double slope) { return std::atan(slope) * 180.0 / std::numbers::pi; };
  Numbers all{{"span", "m", "b", g.span},
              {"height_difference", "m", "h", g.height},
              {"length", "m", "l", g.length},
              {"sag", "m", "f, vertical, at half the span", g.sag},
              {"sag_parameter", "-", "b / sqrt(l^2 - h^2)", g.sag_parameter()},
              {"a", "m", "catenary parameter H/(mu g)", g.a},
              {"half_width", "-", "b/2a", g.m},
              {"xi_lower", "-", "sgn(x) (cosh x - 1) at the lower end", xi_of(g.x1)},
              {"xi_upper", "-", "the same at the upper end", xi_of(g.x2)},
              {"lower_slope", "-", "dy/dx at the lower end", std::sinh(g.x1)},
              {"upper_slope", "-", "dy/dx at the upper end", std::sinh(g.x2)},
              {"lower_slope_deg", "deg", "angle to the horizontal at the lower end", degrees(std::sinh(g.x1))},
              {"upper_slope_deg", "deg", "the same at the upper end", degrees(std::sinh(g.x2))},
              {"horizontal_tension", "N", "H", H},
              {"lower_tension", "N", "static tension at the lower end", H * std::cosh(g.x1)},
              {"upper_tension", "N", "static tension at the upper end", H * std::cosh(g.x2)},
              {"lower_vertical_tension", "N", "its vertical part, H dy/dx, at the lower end", H * std::sinh(g.x1)},
              {"upper_vertical_tension", "N", "the same at the upper end", H * std::sinh(g.x2)},
              {"flexibility", "-", "kappa = H/EA", core.kappa},
              {"frequency_unit", "rad/s", "sqrt(g/a)", frequency_unit(cable)}};
  if (core.kappa > 0.0) all.push_back({"irvine_lambda2", "-", "(b/a)^2 (b/Le) EA/H", irvine_lambda2(g, core.kappa)});
  return all;
}

void write_hanging_cable(ResultFile& file, RunContext& context, const HangingCable& cable) {
  const Numbers numbers = hanging_cable_numbers(cable);
  write_numbers(file, "/cable", numbers);
  context.report.put("cable", numbers_json(numbers));
  context.print(numbers_text(numbers) + "\n");
}

std::vector<double> to_std(const Eigen::Ref<const Vector>& v) { return {v.begin(), v.end()}; }

Along along(const HangingCable& cable, int points) {
  const Geometry& g = cable.shape;
  // Equal arcs: s = sinh x.
  const Vector s = Vector::LinSpaced(points, std::sinh(g.x1), std::sinh(g.x2));
  Along a;
  a.x = s.array().unaryExpr([](double v) { return std::asinh(v); }).min(g.x2).max(g.x1);
  a.columns = {{"s", "m", "arc length from the lower end", to_std(g.a * (s.array() - s[0]).matrix())},
               {"x", "m", "horizontal distance from the lower end", to_std(g.a * (a.x.array() - g.x1).matrix())},
               {"y", "m", "height above the lower end", to_std(g.a * (a.x.array().cosh() - std::cosh(g.x1)).matrix())}};
  return a;
}

ExitStatus finish_tables(ResultFile& file, RunContext& context, const std::vector<std::string>& failures) {
  for (const auto& f : failures) context.warn(f);
  return finish(file, context, failures.empty() ? ExitStatus::ok : ExitStatus::numerical_failure, failures);
}

}  // namespace whirl::studies
