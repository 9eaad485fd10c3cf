#include "studies/catenary_modes_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.hpp"
#include "models/catenary/asymptotic.hpp"
#include "models/catenary/backbone.hpp"
#include "models/catenary/gale_series.hpp"
#include "studies/catenary_keys.hpp"
#include "studies/catenary_modes_output.hpp"
#include "studies/common_keys.hpp"

namespace whirl::studies {
namespace {

using namespace models::catenary;

Schema schema() {
  Schema s("catenary-modes", "natural frequencies and modes of a hanging cable of any sag, in plane and out of plane");
  add_hanging_cable_keys(s, true);
  const auto count = [&](const char* name, const char* description, std::int64_t value) {
    s.add({.name = name, .description = description, .default_value = value, .lower = 0, .upper = 300, .closed_lower = true, .closed_upper = true});
  };
  count("modes.in_plane", "modes wanted in plane", 8);
  count("modes.out_of_plane", "modes wanted out of plane", 8);
  s.add_count("modes.points", "points along the cable at which shapes are written; 0: no shapes", 201, 0, 100000);
  s.add({.name = "series.compare",
         .description = "solve again by the source's series, inextensible cable with |xi| < 4 at both ends, and compare",
         .default_value = false});
  const auto reduced = [&](const char* name, const char* description) {
    s.add({.name = name,
           .description = description,
           .default_value = std::int64_t{0},
           .lower = 0,
           .upper = 12,
           .closed_lower = true,
           .closed_upper = true});
  };
  reduced("reduced.out_of_plane", "lowest modes out of plane of a nonlinear model on catenary modes, written as [modal_model]");
  reduced("reduced.in_plane", "its lowest modes in plane, after those out of plane; both 0: no such model");
  s.add({.name = "sweep.sag_parameter",
         .description = "range of b/sqrt(l^2 - h^2), 1 taut, over which frequencies in sqrt(g/a) are tabulated",
         .default_value = std::vector<double>{0.5, 0.98},
         .lower = 0.0,
         .upper = 1.0,
         .min_items = 2,
         .max_items = 2});
  s.add({.name = "sweep.height_over_span",
         .description = "h/b of the cables of the sweep; empty: no sweep",
         .default_value = std::vector<double>{},
         .lower = 0.0,
         .upper = 100.0,
         .closed_lower = true,
         .example = Value{std::vector<double>{0.0, 0.5}}});
  s.add_count("sweep.points", "cables of each sweep", 60, 2, 100000);
  return s;
}

HangingCable setup(const Configuration& c) {
  const auto& range = c.numbers("sweep.sag_parameter");
  if (!(range[0] < range[1])) throw c.error("sweep.sag_parameter", "must be increasing");
  for (const double h : c.numbers("sweep.height_over_span")) try {
      for (const double sag : range) (void)unit_geometry(half_width_of(sag), h);
    } catch (const std::invalid_argument& e) {
      throw c.error("sweep.height_over_span", e.what());
    }
  if (c.integer("modes.points") == 1) throw c.error("modes.points", "must be 0, for no shapes, or at least 2");
  const HangingCable cable = hanging_cable_of(c);
  if (c.flag("series.compare")) try {
      if (core_of(cable).kappa > 0.0) throw std::invalid_argument("the series method is for inextensible cables: leave out cable.axial_stiffness");
      (void)series_determinant(cable.shape.x1, cable.shape.x2, 1.0, Plane::in_plane);
    } catch (const std::invalid_argument& e) {
      throw c.error("series.compare", e.what());
    }
  return cable;
}

ReducedOptions reduced_options(const Configuration& c) {
  const ReducedOptions o{int(c.integer("reduced.out_of_plane")), int(c.integer("reduced.in_plane"))};
  if (o.out_of_plane + o.in_plane > 12) throw c.error("reduced.in_plane", "with reduced.out_of_plane at most 12 modes");
  return o;
}

std::vector<std::string> check(const Configuration& c) {
  (void)reduced_options(c);
  return hanging_cable_warnings(setup(c));
}

const char* plane_name(bool lateral) { return lateral ? "out_of_plane" : "in_plane"; }

// How a frequency out of plane depends on the amplitude.
struct Swing {
  double curvature, detuning;  // 1/m^2, -
};

struct Found {
  ModeSet set;
  std::vector<std::complex<double>> lambda;  // with drag, in sqrt(g/a), one a mode; nan for a mode that drag leaves no likeness of
  DampedSet damped;                          // in plane
  std::vector<Swing> swings;                 // out of plane, one a mode; nan beyond the eighth
};

Found find(const CoreCable& core, int count, bool lateral) {
  const ModeOptions options{.count = count};
  Found f{lateral ? out_of_plane_modes(core, options) : in_plane_modes(core, options), {}, {}, {}};
  if (lateral && core.eta3 > 0.0)
    for (const auto& mode : f.set.modes) f.lambda.push_back(damped_root(mode.omega, core.eta3));
  if (!lateral && (core.eta1 > 0.0 || core.eta2 > 0.0)) {
    f.damped = damped_modes(core, {.count = count, .functions = f.set.functions});
    for (const int partner : partners(f.set.modes, f.damped.modes))
      f.lambda.push_back(partner < 0 ? std::complex<double>(std::nan(""), std::nan("")) : f.damped.modes[std::size_t(partner)].lambda);
  }
  return f;
}

std::vector<Column> mode_columns(const Found& found, double unit) {
  std::vector<Column> t{
      {"mode", "-", "number", {}},
      {"omega", "rad/s", "natural frequency without drag", {}},
      {"frequency", "Hz", "omega / 2 pi", {}},
      {"omega_ratio", "-", "omega / sqrt(g/a)", {}},
      {"odd_share", "-", "share of the normal (lateral) displacement squared that is odd about the middle, in travel time of a wave", {}},
      {"elastic_share", "-", "share of the potential energy in stretching", {}}};
  for (std::size_t i = 0; i < found.set.modes.size(); ++i) {
    const Mode& mode = found.set.modes[i];
    const double values[] = {double(i + 1), mode.omega * unit, mode.omega * unit / (2.0 * std::numbers::pi),
                             mode.omega,    mode.odd_share,    mode.elastic_share};
    for (std::size_t k = 0; k < t.size(); ++k) t[k].values.push_back(values[k]);
  }
  if (found.lambda.empty()) return t;
  Column decay{"decay", "1/s", "decay rate of the damped mode of the same shape, -Re lambda; nan where there is none", {}},
      damped{"damped_omega", "rad/s", "its Im lambda", {}};
  for (const auto& lambda : found.lambda) {
    decay.values.push_back(-lambda.real() * unit);
    damped.values.push_back(lambda.imag() * unit);
  }
  t.push_back(decay);
  t.push_back(damped);
  return t;
}

std::vector<Swing> swings_of(const HangingCable& cable, CoreCable core, int count) {
  constexpr int highest = 8;                // mode of which it is asked
  core.kappa = std::max(core.kappa, 1e-7);  // stands for an inextensible cable
  const double a = cable.shape.a;
  std::vector<Swing> swings;
  for (int mode = 1; mode <= count; ++mode) {
    Backbone b;
    if (mode <= highest) b = lateral_backbone(core, mode);
    else b.curvature = b.detuning = std::nan("");
    swings.push_back({b.curvature / (a * a), b.detuning});
  }
  return swings;
}

void add_backbone(std::vector<Column>& t, const std::vector<Swing>& swings) {
  Column curvature{"curvature", "1/m^2", "relative change of the frequency per square of the largest displacement, to second order", {}};
  Column detuning{
      "detuning", "-", "relative distance of twice the frequency from the nearest one in plane; small: internal resonance, curvature fails", {}};
  for (const Swing& s : swings) {
    curvature.values.push_back(s.curvature);
    detuning.values.push_back(s.detuning);
  }
  t.push_back(curvature);
  t.push_back(detuning);
}

void write_shapes(ResultFile& file, const HangingCable& cable, const Found& found, bool lateral, int points) {
  const Along line = along(cable, points);
  const double H = horizontal_tension(cable), a = cable.shape.a;
  const Vector c = line.x.array().cosh();
  for (std::size_t i = 0; i < found.set.modes.size(); ++i) {
    const Matrix f = found.set.modes[i].field.at(line.x);
    auto columns = line.columns;
    if (lateral) columns.push_back({"W", "m", "out of plane displacement, largest 1 m", to_std(f.col(0))});
    else {
      columns.push_back({"U", "m", "tangential displacement; the largest displacement is 1 m", to_std(f.col(0))});
      columns.push_back({"V", "m", "normal displacement", to_std(f.col(1))});
      columns.push_back({"rotation", "rad", "change of slope, to first order", to_std(f.col(2).cwiseQuotient(c) / a)});
      columns.push_back({"tension", "N", "dynamic tension, to first order", to_std(f.col(3) * (H / a))});
    }
    file.table(fmt::format("/shapes/{}/mode{}", plane_name(lateral), i + 1), columns);
  }
}

// Frequencies against the sag parameter at one h/b.
void write_sweep(ResultFile& file, const Configuration& c, double h, bool lateral, std::vector<std::string>& failures) {
  const int points = int(c.integer("sweep.points")), count = int(c.integer(lateral ? "modes.out_of_plane" : "modes.in_plane"));
  if (count == 0) return;
  const auto& range = c.numbers("sweep.sag_parameter");
  std::vector<Column> t{{"sag_parameter", "-", "b / sqrt(l^2 - h^2)", std::vector<double>(std::size_t(points))}};
  for (int k = 1; k <= count; ++k) t.push_back({fmt::format("w{}", k), "-", "omega / sqrt(g/a)", std::vector<double>(std::size_t(points))});
  if (lateral)
    t.push_back({"pendulum", "-", "the rigid cable swinging about its chord, Rayleigh's estimate of w1", std::vector<double>(std::size_t(points))});
  const bool asymptotic = !lateral && h == 0.0;
  for (int k = 1; asymptotic && k <= count; ++k)
    t.push_back({fmt::format("asymptotic{}", k), "-", "short-wave formula for omega / sqrt(g/a); nan where it has no root",
                 std::vector<double>(std::size_t(points))});
  std::atomic<int> unresolved{0};
  parallel_for(std::size_t(points), [&](std::size_t i) {
    const double sag = range[0] + (range[1] - range[0]) * double(i) / (points - 1);
    const Geometry g = unit_geometry(half_width_of(sag), h);
    const CoreCable core{.x1 = g.x1, .x2 = g.x2};
    const ModeOptions options{.count = count, .shapes = false};
    const ModeSet set = lateral ? out_of_plane_modes(core, options) : in_plane_modes(core, options);
    if (!set.complete()) ++unresolved;
    t[0].values[i] = sag;
    if (lateral) t.back().values[i] = pendulum_estimate(g);
    for (std::size_t k = 0; k < std::size_t(count); ++k) {
      t[k + 1].values[i] = k < set.modes.size() ? set.modes[k].omega : std::nan("");
      if (asymptotic) t[std::size_t(count) + k + 1].values[i] = asymptotic_frequency(g.m, int(k) + 1).value_or(std::nan(""));
    }
  });
  const std::string group = fmt::format("/sweep/{}/h{}", plane_name(lateral), h);
  file.table(group, t);
  file.attribute(group, "height_over_span", h);
  if (unresolved > 0) failures.push_back(fmt::format("{}: {} of {} cables could not be resolved", group, unresolved.load(), points));
}

// The series method beside the spectral frequencies; modes it refuses are left out.
void write_series(ResultFile& file, const HangingCable& cable, int count, bool lateral, RunContext& context, std::vector<std::string>& failures) {
  const SeriesModes s = series_modes(cable.shape.x1, cable.shape.x2, count, lateral ? Plane::out_of_plane : Plane::in_plane);
  std::vector<Column> t{{"mode", "-", "number", {}},
                        {"omega_ratio", "-", "omega / sqrt(g/a) by series", {}},
                        {"difference", "-", "relative, from the spectral solver", {}},
                        {"digits_lost", "-", "decimal digits cancelled in the sums", {}}};
  if (!s.agrees())
    failures.push_back(fmt::format("series {}: {} modes missing, {} sign changes too many", plane_name(lateral), s.missing, s.spurious));
  else
    for (std::size_t k = 0; k < s.omega.size(); ++k) {
      const double row[] = {double(k + 1), s.omega[k], s.omega[k] / s.spectral[k] - 1.0, s.digits_lost[k]};
      for (std::size_t i = 0; i < t.size(); ++i) t[i].values.push_back(row[i]);
    }
  if (s.refused > 0)
    context.warn(fmt::format("series {}: the {} highest modes are refused, their sums lose more than nine digits", plane_name(lateral), s.refused));
  file.table(fmt::format("/series/{}", plane_name(lateral)), t);
  if (s.agrees() && !s.omega.empty())
    context.print(fmt::format("series {}: {} modes, {} terms, largest difference {:.1e}, {:.1f} digits lost at most\n", plane_name(lateral),
                              s.omega.size(), s.terms, s.worst_difference(), *std::max_element(s.digits_lost.begin(), s.digits_lost.end())));
}

std::string text(const Found& found, double unit, bool lateral) {
  std::string out = fmt::format("{:<13} {:>4} {:>18} {:>16} {:>16} {:>9} {:>9}  {}\n", lateral ? "out of plane" : "in plane", "mode", "omega [rad/s]",
                                "frequency [Hz]", "omega/sqrt(g/a)", "odd", "elastic", "kind");
  for (std::size_t i = 0; i < found.set.modes.size(); ++i) {
    const Mode& m = found.set.modes[i];
    out += fmt::format("{:<13} {:>4} {:>18.11g} {:>16.9g} {:>16.11g} {:>9.4f} {:>9.4f}  {}", "", i + 1, m.omega * unit,
                       m.omega * unit / (2.0 * std::numbers::pi), m.omega, m.odd_share, m.elastic_share, to_string(m.kind));
    if (i < found.swings.size() && std::isfinite(found.swings[i].curvature))
      out += fmt::format(", curvature {:.6g} 1/m^2", found.swings[i].curvature);
    out += '\n';
  }
  return out + fmt::format("{:<13} {} below {:.8g} rad/s by inertia, {} listed{}\n", "", found.set.counted, found.set.counted_below * unit,
                           found.set.expected, found.set.complete() ? ": none is missing" : "");
}

void report(Json& results, const Found found[2], double unit) {
  Json rows = Json::array();
  for (int lateral = 0; lateral < 2; ++lateral)
    for (std::size_t i = 0; i < found[lateral].set.modes.size(); ++i) {
      const Mode& m = found[lateral].set.modes[i];
      Json o = Json::object();
      o.put("plane", plane_name(lateral == 1)).put("mode", i + 1).put("omega", m.omega * unit);
      o.put("frequency", m.omega * unit / (2.0 * std::numbers::pi)).put("omega_ratio", m.omega).put("kind", to_string(m.kind));
      o.put("odd_share", m.odd_share).put("elastic_share", m.elastic_share);
      if (const auto& lambda = found[lateral].lambda; !lambda.empty()) {
        o.put("decay", -lambda[i].real() * unit).put("damped_omega", lambda[i].imag() * unit);
      }
      if (const auto& swings = found[lateral].swings; !swings.empty()) o.put("curvature", swings[i].curvature).put("detuning", swings[i].detuning);
      rows.add(std::move(o));
    }
  results.put("modes", std::move(rows)).put("complete", found[0].set.complete() && found[1].set.complete());
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const HangingCable cable = setup(c);
  for (const auto& w : hanging_cable_warnings(cable)) context.warn(w);
  const CoreCable core = core_of(cable);
  const double unit = frequency_unit(cable);
  ResultFile file(context.output);
  write_study(file, c);
  write_hanging_cable(file, context, cable);
  std::vector<std::string> failures;
  Found found[2];
  const int points = int(c.integer("modes.points"));
  for (const bool lateral : {false, true}) {
    const int count = int(c.integer(lateral ? "modes.out_of_plane" : "modes.in_plane"));
    Found& f = found[lateral];
    f.set.resolved = true;
    if (count == 0) continue;
    f = find(core, count, lateral);
    auto columns = mode_columns(f, unit);
    if (lateral) {
      f.swings = swings_of(cable, core, count);
      add_backbone(columns, f.swings);
    }
    TextColumn kinds{"kind", "symmetric, antisymmetric or hybrid (5 to 95 % odd)", {}};
    for (const auto& mode : f.set.modes) kinds.values.emplace_back(to_string(mode.kind));
    const std::string group = fmt::format("/modes/{}", plane_name(lateral));
    file.table(group, columns, {kinds});
    file.attribute(group, "counted", double(f.set.counted));
    file.attribute(group, "expected", double(f.set.expected));
    file.attribute(group, "counted_below", f.set.counted_below * unit);
    file.attribute(group, "functions", double(f.set.functions));
    if (points > 1) write_shapes(file, cable, f, lateral, points);
    if (!lateral && f.damped.functions > 0) write_damped(file, cable, f.damped, points);
    if (!lateral && f.damped.functions > 0 && !f.damped.resolved)
      failures.push_back(fmt::format("with drag only {} of {} modes in plane are resolved by {} functions: the others are too short waves",
                                     f.damped.modes.size(), count, f.damped.functions));
    if (!f.set.resolved)
      failures.push_back(fmt::format("modes {} are not resolved by {} functions: last coefficients are {:.1e} of the whole", plane_name(lateral),
                                     f.set.functions, f.set.tail));
    else if (!f.set.complete())
      failures.push_back(fmt::format("modes {} are not proved complete: {} listed, {} counted", plane_name(lateral), f.set.expected, f.set.counted));
    context.print(text(f, unit, lateral));
    if (!lateral) context.print(damped_text(f.damped, unit));
    if (c.flag("series.compare")) write_series(file, cable, count, lateral, context, failures);
  }
  write_reduced(file, cable, reduced_options(c), context);
  file.flush();
  for (const double h : c.numbers("sweep.height_over_span"))
    for (const bool lateral : {false, true})
      if (!interrupted) write_sweep(file, c, h, lateral, failures);
  report(context.report, found, unit);
  return finish_tables(file, context, failures);
}

}  // namespace

std::string hanging_modes_table(const Configuration& c) {
  const HangingCable cable = hanging_cable_of(c);
  std::string out;
  for (const auto& w : hanging_cable_warnings(cable)) out += "warning: " + w + "\n";
  for (const bool lateral : {false, true}) out += text(find(core_of(cable), 8, lateral), frequency_unit(cable), lateral);
  return out;
}

StudyKind catenary_modes_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
