#include "studies/periodic_study.hpp"

#include <fmt/format.h>

#include "continuation/chart.hpp"
#include "models/closed_forms.hpp"
#include "studies/chart_output.hpp"
#include "studies/common_keys.hpp"
#include "studies/orbit_output.hpp"

namespace whirl::studies {
namespace {

using namespace continuation;
using namespace models;

struct Setup {
  std::string parameter;
  OrbitBranchOptions orbits;
  int shown_harmonics = 3;
  std::string second;  // "": no curves
  TwoParameterOptions follow;
  std::vector<EventType> curves;
  std::vector<double> checked;
};

void add_periodic_keys(Schema& s) {
  s.add_count("periodic.nu", "base period in excitation periods: 2 or 3 for subharmonic motions started from integration", 1, 1, 12);
  s.add_count("periodic.harmonics", "harmonics of omega/nu; 0: as many as periodic.tolerance needs", 0, 0, 500);
  s.add({.name = "periodic.tolerance",
         .description = "bound on what the harmonics left out may change, relative to the largest amplitude",
         .default_value = 1e-9,
         .lower = 0.0,
         .upper = 0.1});
  s.add_count("periodic.max_harmonics", "harmonics are not raised beyond", 120, 1, 1000);
  s.add_count("periodic.period_doublings", "how often the branch born at a period doubling is followed", 1, 0, 4);
  s.add_count("periodic.amplitudes", "amplitudes of the harmonics up to this multiple of omega are columns of the result", 3, 1, 50);
}

void add_seed_keys(Schema& s) {
  s.add_count("seeds.grid", "parameter values at which the linear response (and a cable's averaged motions) start branches", 9, 1, 10000);
  s.add({.name = "seeds.values",
         .description = "parameter values at which integrated motions start branches that nothing else reaches",
         .default_value = std::vector<double>{}});
  s.add({.name = "seeds.starts",
         .description = "displacements at rest from which to integrate there, one for each coordinate, start after start",
         .default_value = std::vector<double>{}});
  s.add({.name = "seeds.max_periods",
         .description = "excitation periods after which a start counts as not settled",
         .default_value = std::int64_t{3000},
         .lower = 1,
         .upper = 1e8,
         .closed_lower = true});
}

Schema schema() {
  Schema s("periodic",
           "exact periodic responses (harmonic balance), Floquet stability, every special point, period-doubled branches, curves in two parameters");
  add_forced_system_keys(s);
  add_continuation_keys(s, "omega");
  add_periodic_keys(s);
  add_seed_keys(s);
  s.add({.name = "second.parameter",
         .description = "second parameter of the chart of special points",
         .default_value = std::string("support_motion.amplitude")});
  s.add({.name = "second.range",
         .description = "its lower and upper end; without it no chart",
         .default_value = std::vector<double>{},
         .optional = true,
         .max_items = 2});
  s.add({.name = "second.user_values",
         .description = "values of the second parameter at which points of every curve are listed (UZ)",
         .default_value = std::vector<double>{}});
  s.add({.name = "second.curves",
         .description = "which special points to follow",
         .default_value = std::vector<std::string>{"LP", "BP", "PD", "TR"},
         .choices = {"LP", "BP", "PD", "TR"}});
  s.add({.name = "verification.omega",
         .description = "values of the continuation parameter at which every motion is carried over its period by CVODE and drawn",
         .default_value = std::vector<double>{}});
  return s;
}

std::vector<Vector> starts_of(const Configuration& c, std::size_t coordinates) {
  const auto& numbers = c.numbers("seeds.starts");
  if (numbers.size() % coordinates != 0)
    throw c.error("seeds.starts", fmt::format("must hold {} values a start, one for each coordinate", coordinates));
  std::vector<Vector> starts;
  for (std::size_t i = 0; i < numbers.size(); i += coordinates)
    starts.emplace_back(Eigen::Map<const Vector>(numbers.data() + i, static_cast<Eigen::Index>(coordinates)));
  return starts;
}

std::vector<EventType> wanted_types(const std::vector<std::string>& names) {
  std::vector<EventType> types;
  for (const auto& name : names)
    for (const EventType type : {EventType::fold, EventType::branch_point, EventType::period_doubling, EventType::torus})
      if (name == to_string(type)) types.push_back(type);
  return types;
}

void read_second(const Configuration& c, Setup& s) {
  const auto range = c.has("second.range") ? c.numbers("second.range") : std::vector<double>{};
  if (range.empty()) return;
  if (range.size() != 2 || !(range[0] < range[1])) throw c.error("second.range", "must hold two increasing values");
  s.second = c.text("second.parameter");
  if (s.second == s.parameter) throw c.error("second.parameter", "must differ from continuation.parameter");
  check_forced_lens(c, "second.parameter", s.second, "second.range", range[0], range[1]);
  const double here = forced_lens_value(c, s.second);
  if (here < range[0] || here > range[1])
    throw c.error("second.range", fmt::format("must contain the value {:g} that {} has in this file", here, s.second));
  s.follow.walk = s.orbits.network.walk;
  s.follow.walk.user_values = c.numbers("second.user_values");
  for (const double x : s.follow.walk.user_values)
    if (x < range[0] || x > range[1]) throw c.error("second.user_values", fmt::format("must lie in second.range, got {:g}", x));
  s.follow.range1[0] = s.orbits.network.walk.lower;
  s.follow.range1[1] = s.orbits.network.walk.upper;
  s.follow.range2[0] = range[0];
  s.follow.range2[1] = range[1];
  s.curves = wanted_types(c.texts("second.curves"));
}

Setup setup(const Configuration& c) {
  Setup s;
  s.parameter = c.text("continuation.parameter");
  s.orbits.network = network_of(c);
  const auto& walk = s.orbits.network.walk;
  check_forced_lens(c, "continuation.parameter", s.parameter, "continuation.range", walk.lower, walk.upper);
  s.orbits.nu = static_cast<int>(c.integer("periodic.nu"));
  s.orbits.harmonics = static_cast<int>(c.integer("periodic.harmonics"));
  s.orbits.truncation_tolerance = c.number("periodic.tolerance");
  s.orbits.max_harmonics = static_cast<int>(c.integer("periodic.max_harmonics"));
  s.orbits.period_doublings = static_cast<int>(c.integer("periodic.period_doublings"));
  s.orbits.seed_grid = static_cast<int>(c.integer("seeds.grid"));
  s.orbits.seed_values = c.numbers("seeds.values");
  s.orbits.settle.max_periods = static_cast<int>(c.integer("seeds.max_periods"));
  s.orbits.seeds = starts_of(c, forced_system_of(c, {s.parameter}).coordinates.size());
  if (s.orbits.seed_values.empty() != s.orbits.seeds.empty()) throw c.error("seeds.values", "and seeds.starts go together");
  s.shown_harmonics = static_cast<int>(c.integer("periodic.amplitudes"));
  for (const double p : c.numbers("verification.omega"))
    if (p < walk.lower || p > walk.upper) throw c.error("verification.omega", fmt::format("must lie in continuation.range, got {:g}", p));
  s.checked = c.numbers("verification.omega");
  read_second(c, s);
  return s;
}

std::vector<std::string> check(const Configuration& c) {
  (void)setup(c);
  return check_forced_system(c);
}

// The averaged motions of a two-mode cable as starts: they reach what no branch of the linear response leads to.
std::vector<Vector> averaged_starts(const Configuration& c, const Setup& s, const HarmonicBalance& hb) {
  std::vector<Vector> starts;
  if (!c.has("cable.chord_length") || hb.coordinates() != 2 || hb.nu() != 1) return starts;
  for (const int n : {2, 3}) {
    const SuperharmonicFlow flow(stay_of(c), {n, coefficients_of(c)}, {Lens(s.parameter)});
    for (int i = 0; i < s.orbits.seed_grid; ++i) {
      const auto& walk = s.orbits.network.walk;
      const double p = walk.lower + (walk.upper - walk.lower) * (i + 0.5) / s.orbits.seed_grid;
      const auto k = flow.model().coefficients<double>(std::array<double, 1>{p});
      for (const auto& states : {in_plane_states(k), coupled_states(k)})
        for (const auto& x : states) {
          Vector u = Vector::Zero(hb.size() + 1);
          u[hb.size()] = p;
          for (int q = 0; q < 2 && n <= hb.harmonics(); ++q) {  // Z = u + i v stands for u cos - v sin
            u[hb.index(q, n)] = x[2 * q];
            u[hb.index(q, n) + 1] = -x[2 * q + 1];
          }
          u[hb.index(1, 1)] = k.Z0_re;
          u[hb.index(1, 1) + 1] = -k.Z0_im;
          starts.push_back(u);
        }
    }
  }
  return starts;
}

// Of a motion of a balance: its largest displacements, and where it starts, as the kind `integrate` takes it.
std::vector<PointColumn> motion_columns(const HarmonicBalance& hb, const ForcedSystem& source) {
  std::vector<PointColumn> all;
  const int n = static_cast<int>(source.coordinates.size());
  for (int i = 0; i < n; ++i) {
    const std::string& q = source.coordinates[static_cast<std::size_t>(i)];
    all.push_back({q + "_max", source.length_unit, "largest |" + q + "| over the period", [&hb, i](In u) { return peak(hb, u, i); }});
    all.push_back({q + "_start", source.length_unit, q + " where cos(omega t) = 1", [&hb, i](In u) { return hb.state_at(u, 0.0)[i]; }});
    all.push_back(
        {q + "_rate_start", source.length_unit == "m" ? "m/s" : "1/s", "its rate there", [&hb, i, n](In u) { return hb.state_at(u, 0.0)[n + i]; }});
  }
  return all;
}

struct FollowedChart {
  std::vector<std::unique_ptr<HarmonicBalance>> balances;  // one for each level of period doubling: the columns of the curves ask them
  std::vector<ChartCurve> curves;
  ChartOutput output;
};

// Every special point of every branch followed in the second parameter, each curve once.
FollowedChart follow_all(const Configuration& c, const Setup& s, const OrbitBranches& orbits, ResultFile& file, RunContext& context) {
  FollowedChart all;
  const ForcedSystem wide = forced_system_of(c, {s.parameter, s.second});
  all.output = {s.parameter, wide.lens_units[0], s.second, wide.lens_units[1]};
  const double p2 = forced_lens_value(c, s.second);
  for (int level = 0; level < orbits.levels(); ++level) {
    all.balances.push_back(std::make_unique<HarmonicBalance>(
        wide.system,
        HarmonicBalanceOptions{
            .harmonics = orbits.balance(level).harmonics(), .nu = orbits.balance(level).nu(), .reflections = wide.reflections, .floquet = {}}));
    const HarmonicBalance& hb = *all.balances.back();
    Chart chart(hb, s.follow);
    chart.want(s.curves);
    chart.set_observer([](const Branch&, int) { return !interrupted; });
    chart.on_warning([&](const std::string& text) { context.warn(text); });
    chart.on_curve([&](DefiningCurve& curve) {
      curve.name = fmt::format("{}{}", curve.subtype.empty() ? to_string(curve.type) : curve.subtype.c_str(), all.curves.size() + 1);
      const bool doubled = curve.type == EventType::period_doubling;
      all.curves.push_back({.curve = curve, .columns = motion_columns(doubled ? dynamic_cast<const HarmonicBalance&>(hb.doubled()) : hb, wide)});
      all.output.write_curve(file, all.curves.back());
      file.flush();
      context.progress.show(fmt::format("curve {}", curve.name));
    });
    for (const auto& b : orbits.network(level).branches())
      for (std::size_t i = 0; i < b.special.size() && !interrupted; ++i) {
        const bool arrival = b.stop_reason == StopReason::symmetric_branch && i + 1 == b.special.size();  // stands on the other branch
        if (!arrival) chart.follow_from(b.special[i], p2, fmt::format("{}:{}", b.name, label(b, i)));
      }
  }
  context.progress.clear();
  return all;
}

void verify(const Setup& s, const OrbitBranches& orbits, ResultFile& file, RunContext& context) {
  const auto checks = check_orbits(orbits, s.checked, context);
  if (checks.empty()) return;
  write_checks(file, orbits, checks);
  int number = 0;
  for (const auto& check : checks) write_orbit(file, fmt::format("/verification/motions/{:03}", ++number), orbits, check.motion);
  file.flush();
  if (!context.quiet) fmt::print(stderr, "\n{}", checks_text(orbits, checks, s.parameter));
  for (const auto& check : checks)
    if (check.ok && check.defect > 1e3 * std::max(s.orbits.truncation_tolerance, 1e-9) && check.motion.stable)
      context.warn(fmt::format("the motion of {} at {:g} misses its start by {:.1e} when integrated", check.motion.branch, check.p, check.defect));
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : check_forced_system(c)) context.warn(w);
  ResultFile file(context.output);
  write_study(file, c);
  write_forced_system(file, c);
  OrbitBranches orbits(forced_system_of(c, {s.parameter}), s.orbits, context);
  const BranchOutput output = orbit_output(orbits, s.parameter, s.shown_harmonics);
  orbits.add_starts([&](const HarmonicBalance& hb) { return averaged_starts(c, s, hb); });
  orbits.on_branch([&](const Branch& b, int level, double error) {
    output.write_branch(file, b);
    file.attribute("/branches/" + b.name, "period", static_cast<double>(orbits.period(level)));
    file.attribute("/branches/" + b.name, "harmonics", static_cast<double>(orbits.balance(level).harmonics()));
    file.attribute("/branches/" + b.name, "truncation_error", error);
    file.flush();
    if (error > s.orbits.truncation_tolerance)
      context.warn(fmt::format("branch {}: {} harmonics leave a truncation error of {:.1e}", b.name, orbits.balance(level).harmonics(), error));
  });
  orbits.find();
  const std::vector<Branch> branches = orbits.all();
  if (branches.empty()) context.warn("no periodic motion was found in the range");
  output.write_special_points(file, branches);
  file.flush();
  if (!context.quiet) fmt::print(stderr, "{}", output.text(branches));
  if (!interrupted) verify(s, orbits, file, context);
  std::string chart_json;
  if (!s.second.empty() && !interrupted) {
    const FollowedChart chart = follow_all(c, s, orbits, file, context);
    chart.output.write_points(file, "/curve_points", chart.curves);
    chart_json = fmt::format(",\n  \"curve_points\": [{}\n  ],\n  \"curves\": [{}\n  ]", chart.output.points_json(chart.curves),
                             ChartOutput::curves_json(chart.curves));
    if (!context.quiet) fmt::print(stderr, "\n{}", chart.output.text(chart.curves));
  }
  if (context.json) {
    std::string all = output.json(branches);
    fmt::print("{}", all.insert(all.rfind("\n}"), chart_json));
  }
  return finish(file, context, branches);
}

}  // namespace

StudyKind periodic_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
