#include "studies/periodic_study.hpp"

#include <fmt/format.h>

#include "continuation/chart.hpp"
#include "studies/chart_output.hpp"
#include "studies/common_keys.hpp"
#include "studies/orbit_output.hpp"
#include "studies/second_parameter.hpp"

namespace whirl::studies {
namespace {

using namespace continuation;
using namespace models;

struct Setup {
  std::string parameter;
  OrbitBranchOptions orbits;
  int shown_harmonics = 3;
  SecondParameter second;  // no name: no curves
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
  s.add_count("seeds.grid", "parameter values at which the linear response and all averaged motions start branches", 9, 1, 10000);
  s.add({.name = "seeds.values",
         .description = "parameter values at which integrated motions start branches that nothing else reaches",
         .default_value = std::vector<double>{}});
  s.add({.name = "seeds.starts",
         .description = "displacements at rest from which to integrate there, one for each coordinate, start after start",
         .default_value = std::vector<double>{}});
  s.add_count("seeds.check",
              "starts integrated at each value of seeds.check_values, to see whether a stable motion is missing; 0: none; without it at most 10, and "
              "fewer where that would cost more than the branches",
              10, 0, 100000);
  s.add_count("seeds.check_values", "parameter values, evenly in the range, at which they are integrated", 12, 1, 10000);
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
  add_second_keys(
      s, {.what = "second parameter of the chart of special points", .parameter = "support_motion.amplitude", .curves = {"LP", "BP", "PD", "TR"}});
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
  s.orbits.check.starts = static_cast<int>(c.integer("seeds.check"));
  s.orbits.check.values = static_cast<int>(c.integer("seeds.check_values"));
  s.orbits.check.bounded = !c.is_given("seeds.check") && !c.is_given("seeds.check_values");
  s.orbits.seeds = starts_of(c, forced_system_of(c, {s.parameter}).coordinates.size());
  if (s.orbits.seed_values.empty() != s.orbits.seeds.empty()) throw c.error("seeds.values", "and seeds.starts go together");
  s.shown_harmonics = static_cast<int>(c.integer("periodic.amplitudes"));
  for (const double p : c.numbers("verification.omega"))
    if (p < walk.lower || p > walk.upper) throw c.error("verification.omega", fmt::format("must lie in continuation.range, got {:g}", p));
  s.checked = c.numbers("verification.omega");
  if (c.has("second.range") && !c.numbers("second.range").empty())
    s.second = read_second(c, s.parameter, walk,
                           {[&](const std::string& lens) { return forced_lens_value(c, lens); },
                            [&](const std::string& key, const std::string& lens, const std::string& range_key, double lower, double upper) {
                              check_forced_lens(c, key, lens, range_key, lower, upper);
                            }});
  return s;
}

std::vector<std::string> check(const Configuration& c) {
  (void)setup(c);
  return check_forced_system(c);
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
  const ForcedSystem wide = forced_system_of(c, {s.parameter, s.second.name});
  all.output = {s.parameter, wide.lens_units[0], s.second.name, wide.lens_units[1]};
  const double p2 = s.second.value;
  for (int level = 0; level < orbits.levels(); ++level) {
    all.balances.push_back(std::make_unique<HarmonicBalance>(
        wide.system,
        HarmonicBalanceOptions{
            .harmonics = orbits.balance(level).harmonics(), .nu = orbits.balance(level).nu(), .reflections = wide.reflections, .floquet = {}}));
    const HarmonicBalance& hb = *all.balances.back();
    Chart chart(hb, s.second.follow);
    chart.want(s.second.curves);
    chart.set_observer([](const Branch&, int) { return !interrupted; });
    chart.on_warning([&](const std::string& text) { context.warn(text); });
    chart.on_curve([&](DefiningCurve& curve) {
      curve.name = curve_name(curve, all.curves.size() + 1);
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

// What integration says against the branches.
std::vector<std::string> verify(const Setup& s, const OrbitBranches& orbits, ResultFile& file, RunContext& context) {
  const auto checks = check_orbits(orbits, s.checked, context);
  if (checks.empty()) return {};
  write_checks(file, orbits, checks);
  int number = 0;
  for (const auto& check : checks) write_orbit(file, fmt::format("/verification/motions/{:03}", ++number), orbits, check.motion);
  file.flush();
  context.print(fmt::format("\n{}", checks_text(orbits, checks, s.parameter)));
  return contradictions(checks, s.parameter, 1e3 * std::max(s.orbits.truncation_tolerance, 1e-9));
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : check_forced_system(c)) context.warn(w);
  ResultFile file(context.output);
  write_study(file, c);
  write_forced_system(file, context, c);
  OrbitBranches orbits(forced_system_of(c, {s.parameter}), s.orbits, context);
  const BranchOutput output = orbit_output(orbits, s.parameter, s.shown_harmonics);
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
  output.report(context.report, branches);
  context.print(output.text(branches));
  const AttractorCheck& settled = orbits.check();
  settled.write(file, s.parameter);
  file.flush();
  context.report.put("attractor_check", settled.json(s.parameter));
  if (const std::string text = settled.text(s.parameter); !text.empty()) {
    if (!settled.complete()) context.warn(text);
    else context.print(fmt::format("{}\n", text));
  }
  const auto failures = interrupted ? std::vector<std::string>{} : verify(s, orbits, file, context);
  if (!s.second.name.empty() && !interrupted) {
    const FollowedChart chart = follow_all(c, s, orbits, file, context);
    chart.output.write_points(file, "/curve_points", chart.curves);
    context.report.put("curve_points", chart.output.points_json(chart.curves)).put("curves", ChartOutput::curves_json(chart.curves));
    context.print(fmt::format("\n{}", chart.output.text(chart.curves)));
  }
  return finish(file, context, branches, failures);
}

}  // namespace

StudyKind periodic_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
