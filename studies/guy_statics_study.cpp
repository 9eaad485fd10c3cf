#include "studies/guy_statics_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/guy/group.hpp"
#include "models/guy/lumped.hpp"
#include "models/guy/tangent.hpp"
#include "studies/common_keys.hpp"
#include "studies/guy_keys.hpp"

namespace whirl::studies {
namespace {

using namespace models::guy;

constexpr double degree = std::numbers::pi / 180.0;

struct Setup {
  GuyInput guy;
  std::vector<double> curve;  // displacements of the mast's end away from the anchor
  std::vector<double> azimuths, directions, displacements;
  int masses = 0;
};

Schema schema() {
  Schema s("guy-statics", "static state of a guy, force against displacement, groups of guys on a level, chains of lumped masses");
  add_guy_keys(s);
  s.add({.name = "curve.range",
         .unit = "m",
         .description = "displacements of the mast's end away from the anchor; left out: 1/500 of the chord rounded, less where the guy is too taut",
         .default_value = std::vector<double>{},
         .optional = true,
         .suggested = true,
         .min_items = 2,
         .max_items = 2,
         .example = Value{std::vector<double>{-1.0, 1.0}}});
  s.add_count("curve.points", "of the curve", 161, 2, 100000);
  s.add_count("group.guys", "equal guys, equally spread, that hold one point of the mast; 0: none", 0, 0, 100);
  s.add({.name = "group.azimuths_deg",
         .unit = "deg",
         .description = "or their azimuths from the mast to the anchors",
         .default_value = std::vector<double>{},
         .max_items = 100});
  s.add({.name = "group.directions_deg",
         .unit = "deg",
         .description = "directions in which the point is moved",
         .default_value = std::vector<double>{0.0},
         .min_items = 1,
         .max_items = 36});
  s.add({.name = "group.range",
         .unit = "m",
         .description = "displacements of the point; left out: as curve.range",
         .default_value = std::vector<double>{},
         .optional = true,
         .suggested = true,
         .min_items = 2,
         .max_items = 2,
         .example = Value{std::vector<double>{-1.0, 1.0}}});
  s.add_count("group.points", "of a curve", 81, 2, 100000);
  s.add_count("lumped.masses", "masses of the chains; 0: none", 5, 0, 10000);
  s.add({.name = "lumped.extra_weights",
         .unit = "N",
         .description = "hung on the masses of the hung chain, from the anchor up: one value for each, or none",
         .default_value = std::vector<double>{},
         .lower = 0.0,
         .closed_lower = true});
  return s;
}

Statics moved(const Statics& rest, double displacement) {
  Guy g = rest.guy;
  g.horizontal_span += displacement;
  return solve(g, Known::unstressed_length, rest.unstressed_length, rest.form);
}

Group group_of(const Setup& s) {
  Group group;
  for (const double a : s.azimuths) group.push_back({s.guy.rest, a * degree});
  return group;
}

// The largest of 1, 2, 5 times a power of ten within x.
double rounded_down(double x) {
  const double decade = std::pow(10.0, std::floor(std::log10(x) + 1e-12));
  return decade * (x >= 5.0 * decade ? 5.0 : x >= 2.0 * decade ? 2.0 : 1.0);
}

// -d and d: a movement that suits the guy's size, halved until `takes` it both ways.
template <class Takes>
std::vector<double> suitable_range(const Guy& guy, Takes&& takes) {
  constexpr double part_of_chord = 1.0 / 500.0;
  constexpr int halvings = 40;
  double d = rounded_down(part_of_chord * guy.chord());
  for (int i = 0; i < halvings; ++i, d = rounded_down(0.5 * d)) try {
      takes(-d), takes(d);
      break;
    } catch (const std::exception&) {
    }
  return {-d, d};
}

void require_reaction(const Setup& s, double displacement) {
  for (const double direction : s.directions)
    for (const auto terms : {GroupTerms::axial, GroupTerms::full_geometry}) (void)reaction(group_of(s), displacement, direction * degree, terms);
}

// The section's range and points; `otherwise` where no range is given.
template <class Otherwise>
std::vector<double> grid(const Configuration& c, const std::string& section, Otherwise&& otherwise) {
  const int points = static_cast<int>(c.integer(section + ".points"));
  if (c.has(section + ".range")) return grid_of(c, section + ".range", points);
  const std::vector<double> range = otherwise();
  std::vector<double> all;
  for (int i = 0; i < points; ++i) all.push_back(range[0] + (range[1] - range[0]) * i / (points - 1));
  return all;
}

Setup setup(const Configuration& c) {
  Setup s;
  s.guy = guy_of(c);
  const auto try_move = [&](double d) { (void)moved(s.guy.exact, d), (void)moved(s.guy.first_order, d); };
  s.curve = grid(c, "curve", [&] { return suitable_range(s.guy.rest.guy, try_move); });
  s.azimuths = c.numbers("group.azimuths_deg");
  for (const double end : {s.curve.front(), s.curve.back()}) blame(c, "curve.range", [&] { try_move(end); });
  const auto guys = c.integer("group.guys");
  if (guys > 0 && !s.azimuths.empty()) throw c.error("group.guys", "is given beside group.azimuths_deg: give one of them");
  for (int j = 0; j < guys; ++j) s.azimuths.push_back(360.0 * j / static_cast<double>(guys));
  s.directions = c.numbers("group.directions_deg");
  s.displacements = grid(c, "group", [&] {
    return suitable_range(s.guy.rest.guy, [&](double d) {
      try_move(d);
      if (!s.azimuths.empty()) require_reaction(s, d);
    });
  });
  if (!s.azimuths.empty())
    for (const double end : {s.displacements.front(), s.displacements.back()}) blame(c, "group.range", [&] { require_reaction(s, end); });
  s.masses = static_cast<int>(c.integer("lumped.masses"));
  if (const auto n = c.numbers("lumped.extra_weights").size(); n > 0 && n != static_cast<std::size_t>(s.masses))
    throw c.error("lumped.extra_weights", fmt::format("must hold one value for each of lumped.masses, {}, or none", s.masses));
  return s;
}

std::vector<std::string> check(const Configuration& c) { return guy_warnings(setup(c).guy); }

void write_curve(ResultFile& file, const Setup& s, const Statics& rest) {
  std::vector<Statics> states;
  for (const double d : s.curve) states.push_back(moved(rest, d));
  const std::size_t n = states.size();
  const bool exact = rest.form == Form::exact;
  std::vector<Column> columns{column("displacement", "m", "of the mast's end, away from the anchor", n, [&](auto i) { return s.curve[i]; }),
                              column("horizontal_tension", "N", "H", n, [&](auto i) { return states[i].horizontal_tension; }),
                              column("lower_tension", "N", "at the anchor", n, [&](auto i) { return states[i].lower_tension; }),
                              column("upper_tension", "N", "at the mast", n, [&](auto i) { return states[i].upper_tension; }),
                              column("sag", "m", "largest distance from the chord", n, [&](auto i) { return states[i].sag; }),
                              column("modulus", "N/m", "dH/dl", n, [&](auto i) { return horizontal_modulus(states[i]); })};
  if (exact) {
    columns.push_back(column("modulus_xy", "N/m", "horizontal force per vertical displacement", n, [&](auto i) { return tangent(states[i]).xy; }));
    columns.push_back(column("modulus_yy", "N/m", "vertical force per vertical displacement", n, [&](auto i) { return tangent(states[i]).yy; }));
    columns.push_back(column("modulus_zz", "N/m", "H/l", n, [&](auto i) { return tangent(states[i]).zz; }));
  }
  file.table(exact ? "/curve/exact" : "/curve/first_order", columns);
}

// A group moved in one direction: its curve into the file, its tangents and extremes as well into the report and the printed table.
Json write_group(ResultFile& file, RunContext& context, const Setup& s, double direction) {
  const Group group = group_of(s);
  std::vector<Reaction> axial, full;
  for (const double d : s.displacements) {
    axial.push_back(reaction(group, d, direction * degree, GroupTerms::axial));
    full.push_back(reaction(group, d, direction * degree, GroupTerms::full_geometry));
  }
  const std::size_t n = full.size();
  const std::string name = fmt::format("/groups/direction{:g}", direction);
  file.table(name, {column("displacement", "m", "of the held point", n, [&](auto i) { return s.displacements[i]; }),
                    column("reaction", "N", "against the displacement, full geometry", n, [&](auto i) { return full[i].along; }),
                    column("reaction_axial", "N", "spans only, without the transverse part", n, [&](auto i) { return axial[i].along; }),
                    column("reaction_across", "N", "90 degrees counter-clockwise of the displacement", n, [&](auto i) { return full[i].across; }),
                    column("largest_tension", "N", "of the guys' upper ends", n, [&](auto i) { return full[i].largest_tension; }),
                    column("smallest_tension", "N", "of the guys' upper ends", n, [&](auto i) { return full[i].smallest_tension; })});
  file.attribute(name, "direction_deg", direction);
  file.attribute(name, "azimuths_deg", s.azimuths);
  const double tangent = group_modulus(group, direction * degree, GroupTerms::full_geometry);
  const double tangent_axial = group_modulus(group, direction * degree, GroupTerms::axial);
  file.attribute(name, "tangent", tangent);
  file.attribute(name, "tangent_axial", tangent_axial);
  const auto value = [&](auto member) {
    std::vector<double> values;
    for (const Reaction& r : full) values.push_back(r.*member);
    return values;
  };
  const auto tensions = value(&Reaction::largest_tension), least = value(&Reaction::smallest_tension), along = value(&Reaction::along);
  const double largest = *std::max_element(tensions.begin(), tensions.end()), smallest = *std::min_element(least.begin(), least.end());
  context.print(
      fmt::format("group of {} guys moved at {:g} deg: tangent {:.10g} N/m (spans only {:.10g}); from {:g} to {:g} m reaction {:.8g} to {:.8g} N, "
                  "tension at the mast {:.8g} to {:.8g} N\n",
                  s.azimuths.size(), direction, tangent, tangent_axial, s.displacements.front(), s.displacements.back(), along.front(), along.back(),
                  smallest, largest));
  Json o = Json::object();
  o.put("direction_deg", direction).put("tangent", tangent).put("tangent_axial", tangent_axial);
  o.put("largest_tension", largest).put("smallest_tension", smallest);
  o.put("displacement", Json::array(s.displacements))
      .put("reaction", Json::array(along))
      .put("reaction_across", Json::array(value(&Reaction::across)));
  return o;
}

void write_polygon(ResultFile& file, const std::string& name, const Polygon& p) {
  const std::size_t n = p.x.size();
  file.table(
      "/lumped/" + name,
      {column("x", "m", "ends and masses, from the anchor", n, [&](auto i) { return p.x[i]; }),
       column("y", "m", "ends and masses", n, [&](auto i) { return p.y[i]; }),
       column("weight", "N", "of the mass; 0 at the ends", n, [&](auto i) { return i == 0 || i + 1 == n ? 0.0 : p.weight[i - 1]; }),
       column("line_length", "m", "of the line above this point; 0 at the last", n, [&](auto i) { return i + 1 < n ? p.length[i] : 0.0; }),
       column("line_tension", "N", "of the line above this point; 0 at the last", n, [&](auto i) { return i + 1 < n ? p.tension[i] : 0.0; }),
       column("line_slope", "-", "dy/dx of the line above this point; 0 at the last", n, [&](auto i) { return i + 1 < n ? p.slope[i] : 0.0; })});
  file.attribute("/lumped/" + name, "horizontal_tension", p.horizontal_tension);
}

void write_lumped(ResultFile& file, const Configuration& c, const Setup& s) {
  if (s.masses == 0) return;
  const Statics& rest = s.guy.first_order;
  write_polygon(file, "funicular", funicular_polygon(rest, s.masses));
  const double part = rest.length / (s.masses + 1);
  std::vector<double> weights(static_cast<std::size_t>(s.masses), rest.guy.weight() * part);
  const auto& extra = c.numbers("lumped.extra_weights");
  for (std::size_t i = 0; i < extra.size(); ++i) weights[i] += extra[i];
  write_polygon(file, "hung", hung_masses(rest.guy, std::vector(weights.size() + 1, part), weights));
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : guy_warnings(s.guy)) context.warn(w);
  ResultFile file(context.output);
  write_study(file, c);
  context.report.put("special_points", Json::array()).put("branches", Json::array());
  write_guy(file, context, s.guy);
  write_curve(file, s, s.guy.first_order);
  write_curve(file, s, s.guy.exact);
  file.flush();
  Json groups = Json::array();
  if (!s.azimuths.empty())
    for (const double direction : s.directions) groups.add(write_group(file, context, s, direction));
  context.report.put("groups", std::move(groups));
  ExitStatus status = ExitStatus::ok;
  std::vector<std::string> reasons{"all parts computed"};
  try {
    write_lumped(file, c, s);
  } catch (const std::exception& e) {
    context.warn(fmt::format("lumped masses: {}", e.what()));
    reasons = {context.warnings.back()};
    status = ExitStatus::numerical_failure;
  }
  return finish(file, context, status, reasons);
}

}  // namespace

StudyKind guy_statics_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
