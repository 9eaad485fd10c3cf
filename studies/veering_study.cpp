#include "studies/veering_study.hpp"

#include <fmt/format.h>

#include <cmath>

#include "continuation/walker.hpp"
#include "models/catenary/veering.hpp"
#include "studies/catenary_keys.hpp"
#include "studies/common_keys.hpp"

namespace whirl::studies {
namespace {

using namespace models::catenary;

struct Setup {
  HangingCable cable;
  std::vector<Geometry> shapes;  // one a height
  std::vector<double> heights;   // h/b
  double lower, upper;           // of kappa
  int modes, points;
};

Schema schema() {
  Schema s("veering", "frequencies of a hanging cable against its flexibility: crossings (level) and veering (inclined), hybrid modes");
  add_hanging_cable_keys(s, false);
  s.add({.name = "veering.flexibility",
         .description = "range of kappa = H/EA",
         .default_value = std::vector<double>{1e-4, 0.3},
         .lower = 0.0,
         .upper = 10.0,
         .min_items = 2,
         .max_items = 2});
  s.add_count("veering.modes", "frequencies followed", 6, 2, 40);
  s.add_count("veering.points", "flexibilities in the range, evenly spaced in its logarithm", 240, 10, 100000);
  s.add({.name = "veering.height_over_span",
         .description = "h/b of further cables with the same b/2a and the same horizontal tension; empty: this cable only",
         .default_value = std::vector<double>{},
         .lower = 0.0,
         .upper = 100.0,
         .closed_lower = true,
         .example = Value{std::vector<double>{0.0, 0.1}}});
  return s;
}

Setup setup(const Configuration& c) {
  Setup s{
      hanging_cable_of(c), {}, c.numbers("veering.height_over_span"), 0.0, 0.0, int(c.integer("veering.modes")), int(c.integer("veering.points"))};
  const auto& range = c.numbers("veering.flexibility");
  if (!(range[0] < range[1])) throw c.error("veering.flexibility", "must be increasing");
  s.lower = range[0];
  s.upper = range[1];
  const Geometry& g = s.cable.shape;
  if (s.heights.empty()) {
    s.heights = {g.height / g.span};
    s.shapes = {g};
    return s;
  }
  for (const double h : s.heights) try {
      s.shapes.push_back(geometry({.span = g.span, .height = h * g.span, .horizontal_tension = g.a, .weight_per_length = 1.0}));
    } catch (const std::invalid_argument& e) {
      throw c.error("veering.height_over_span", e.what());
    }
  return s;
}

std::vector<std::string> check(const Configuration& c) {
  const Setup s = setup(c);
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < s.shapes.size(); ++i) {
    HangingCable cable = s.cable;
    cable.shape = s.shapes[i];
    cable.axial_stiffness = horizontal_tension(cable) / s.upper;  // the softest
    for (const auto& w : hanging_cable_warnings(cable)) warnings.push_back(fmt::format("h/b = {:g}, kappa = {:g}: {}", s.heights[i], s.upper, w));
  }
  return warnings;
}

std::string name_of(double h) { return fmt::format("h{}", h); }

void write_fan(ResultFile& file, const Setup& s, std::size_t i, std::vector<std::string>& failures) {
  const Geometry& g = s.shapes[i];
  const Vector kappa = Vector::LinSpaced(s.points, std::log(s.lower), std::log(s.upper)).array().exp();
  const FrequencyFan fan = frequency_fan(g.x1, g.x2, kappa, s.modes);
  const double unit = frequency_unit(s.cable);
  const Vector stiffness = horizontal_tension(s.cable) * kappa.cwiseInverse();
  std::vector<Column> t{{"flexibility", "-", "kappa = H/EA", to_std(kappa)},
                        {"axial_stiffness", "N", "EA", to_std(stiffness)},
                        {"irvine_lambda2", "-", "(b/a)^2 (b/Le) EA/H", to_std(irvine_lambda2(g, 1.0) * kappa.cwiseInverse())}};
  for (int k = 0; k < s.modes; ++k) t.push_back({fmt::format("omega{}", k + 1), "rad/s", "natural frequency", to_std(unit * fan.omega.col(k))});
  for (int k = 0; k < s.modes; ++k)
    t.push_back({fmt::format("odd{}", k + 1), "-", "odd share of V: 0 symmetric, 1 antisymmetric", to_std(fan.odd_share.col(k))});
  const std::string group = "/fan/" + name_of(s.heights[i]);
  file.table(group, t);
  file.attribute(group, "height_over_span", s.heights[i]);
  if (!fan.resolved) failures.push_back(group + ": some cables could not be resolved");
}

struct Found {
  double height;
  Approach approach;
  double lambda2;
};

void write_approaches(ResultFile& file, const Setup& s, const std::vector<Found>& found) {
  const double unit = frequency_unit(s.cable), H = horizontal_tension(s.cable);
  std::vector<Column> t;
  const auto add = [&](const char* name, const char* u, const char* description, auto value) {
    Column c{name, u, description, {}};
    for (const Found& f : found) c.values.push_back(value(f));
    t.push_back(std::move(c));
  };
  add("height_over_span", "-", "h/b", [](const Found& f) { return f.height; });
  add("lower_mode", "-", "the pair is this mode and the next", [](const Found& f) { return double(f.approach.lower_mode); });
  add("flexibility", "-", "kappa where they are closest", [](const Found& f) { return f.approach.kappa; });
  add("axial_stiffness", "N", "EA there", [&](const Found& f) { return H / f.approach.kappa; });
  add("irvine_lambda2", "-", "lambda^2 there", [](const Found& f) { return f.lambda2; });
  add("omega_lower", "rad/s", "lower frequency", [&](const Found& f) { return unit * f.approach.lower; });
  add("omega_upper", "rad/s", "upper frequency", [&](const Found& f) { return unit * f.approach.upper; });
  add("gap", "-", "difference over mean", [](const Found& f) { return f.approach.crossing ? 0.0 : f.approach.gap; });
  add("odd_lower", "-", "odd share of the lower mode", [](const Found& f) { return f.approach.odd_lower; });
  add("odd_upper", "-", "odd share of the upper mode", [](const Found& f) { return f.approach.odd_upper; });
  add("bracket", "-", "width of the bracket in kappa, relative", [](const Found& f) { return f.approach.width; });
  TextColumn what{"what", "crossing (level cable) or veering", {}};
  for (const Found& f : found) what.values.emplace_back(f.approach.crossing ? "crossing" : "veering");
  file.table("/approaches", t, {what});
}

// Level cable: each symmetric mode followed by the walker; where it crosses an antisymmetric one is a branch point.
void write_crossings(ResultFile& file, const Setup& s, const Geometry& g, std::vector<std::string>& failures) {
  const ModeSet first = in_plane_modes({.x1 = g.x1, .x2 = g.x2, .kappa = s.lower}, {.count = s.modes, .shapes = false, .verify = false});
  const FrequencyCurve curve(g.x1, g.x2, functions_for_range(g.x1, g.x2, s.lower, s.upper, s.modes), first.modes[0].omega);
  continuation::WalkOptions walk;
  walk.lower = std::sqrt(s.lower);
  walk.upper = std::sqrt(s.upper);
  const double unit = frequency_unit(s.cable);
  std::vector<Column> t{
      {"flexibility", "-", "kappa", {}}, {"omega", "rad/s", "common frequency", {}}, {"residual", "-", "of the defining system", {}}};
  TextColumn branch{"branch", "symmetric mode followed", {}};
  for (int mode = 1; 2 * mode <= s.modes && !interrupted; ++mode) {
    continuation::Walker walker(curve, walk);
    continuation::Branch path;
    try {
      path = walker.walk(curve.start(s.lower * 1.0001, mode, Parity::symmetric), [](const auto&, int) { return !interrupted.load(); });
    } catch (const std::exception& e) {
      failures.push_back(fmt::format("branch S{}: {}", mode, e.what()));
      continue;
    }
    std::vector<double> kappa, omega;
    for (int i = 0; i < path.points(); ++i) {
      kappa.push_back(FrequencyCurve::kappa(path.u(i)));
      omega.push_back(unit * curve.omega(path.u(i)));
    }
    const std::string name = fmt::format("S{}", mode);
    file.table("/branches/" + name, {{"flexibility", "-", "kappa", kappa}, {"omega", "rad/s", "frequency of the symmetric mode", omega}});
    if (path.stop_reason != continuation::StopReason::parameter_bound && !interrupted)
      failures.push_back(fmt::format("branch {} ended early: {}", name, to_string(path.stop_reason)));
    for (const auto& p : path.special) {
      if (p.type == continuation::EventType::unresolved)
        failures.push_back(fmt::format("branch {}: a change at kappa = {:.6g} that no crossing explains: it may have left its mode", name,
                                       FrequencyCurve::kappa(p.u)));
      if (p.type != continuation::EventType::branch_point) continue;
      t[0].values.push_back(FrequencyCurve::kappa(p.u));
      t[1].values.push_back(unit * curve.omega(p.u));
      t[2].values.push_back(p.residual);
      branch.values.push_back(name);
    }
  }
  file.table("/crossings", t, {branch});
}

// V of both modes at a third of the flexibility, at it and at three times it.
void write_hybrid(ResultFile& file, const Geometry& g, double h, const Approach& a) {
  const Vector x = Vector::LinSpaced(161, g.x1, g.x2);
  const double factors[] = {1.0 / 3.0, 1.0, 3.0};
  const char* names[] = {"stiffer", "closest", "softer"};
  for (int i = 0; i < 3; ++i) {
    const ModeSet set = in_plane_modes({.x1 = g.x1, .x2 = g.x2, .kappa = factors[i] * a.kappa}, {.count = a.lower_mode + 1, .verify = false});
    const auto shape = [&](int k) { return to_std(set.modes[std::size_t(k)].field.at(x, Quantity::V)); };
    const std::string group = fmt::format("/hybrid/{}/{}", name_of(h), names[i]);
    file.table(group, {{"x", "-", "horizontal distance from the lower end over the span", to_std((x.array() - g.x1).matrix() / (2.0 * g.m))},
                       {"V_lower", "m", "normal displacement of the lower mode", shape(a.lower_mode - 1)},
                       {"V_upper", "m", "of the upper mode", shape(a.lower_mode)}});
    file.attribute(group, "flexibility", factors[i] * a.kappa);
    file.attribute(group, "lower_mode", double(a.lower_mode));
    file.attribute(group, "odd_lower", set.modes[std::size_t(a.lower_mode) - 1].odd_share);
    file.attribute(group, "odd_upper", set.modes[std::size_t(a.lower_mode)].odd_share);
  }
}

std::string text(const Setup& s, const std::vector<Found>& found) {
  const double unit = frequency_unit(s.cable);
  std::string out = fmt::format("{:<9} {:>8} {:>7} {:>16} {:>13} {:>15} {:>15} {:>12}\n", "", "h/b", "modes", "kappa", "lambda^2", "lower [rad/s]",
                                "upper [rad/s]", "gap");
  for (const Found& f : found) {
    const Approach& a = f.approach;
    out += fmt::format("{:<9} {:>8.4g} {:>7} {:>16.10g} {:>13.8g} {:>15.10g} {:>15.10g} {:>12.6g}\n", a.crossing ? "crossing" : "veering", f.height,
                       fmt::format("{}-{}", a.lower_mode, a.lower_mode + 1), a.kappa, f.lambda2, unit * a.lower, unit * a.upper,
                       a.crossing ? 0.0 : a.gap);
  }
  return out;
}

Json json(const Setup& s, const std::vector<Found>& found) {
  const double unit = frequency_unit(s.cable);
  Json rows = Json::array();
  for (const Found& f : found) {
    Json o = Json::object();
    o.put("type", f.approach.crossing ? "crossing" : "veering").put("height_over_span", f.height).put("lower_mode", f.approach.lower_mode);
    o.put("flexibility", f.approach.kappa).put("irvine_lambda2", f.lambda2);
    o.put("omega_lower", unit * f.approach.lower).put("omega_upper", unit * f.approach.upper);
    rows.add(std::move(o.put("gap", f.approach.crossing ? 0.0 : f.approach.gap)));
  }
  return rows;
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : check(c)) context.warn(w);
  ResultFile file(context.output);
  write_study(file, c);
  write_hanging_cable(file, context, s.cable);
  std::vector<std::string> failures;
  std::vector<Found> found;
  for (std::size_t i = 0; i < s.shapes.size() && !interrupted; ++i) {
    const Geometry& g = s.shapes[i];
    context.progress.show(fmt::format("h/b = {:g}", s.heights[i]));
    write_fan(file, s, i, failures);
    const auto here = closest_approaches(g.x1, g.x2, s.lower, s.upper, s.modes);
    for (const auto& a : here) found.push_back({s.heights[i], a, irvine_lambda2(g, a.kappa)});
    if (s.heights[i] == 0.0) write_crossings(file, s, g, failures);
    else if (!here.empty()) write_hybrid(file, g, s.heights[i], here.front());
    file.flush();
  }
  context.progress.clear();
  write_approaches(file, s, found);
  context.report.put("special_points", json(s, found));
  context.print(text(s, found));
  return finish_tables(file, context, failures);
}

}  // namespace

StudyKind veering_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
