#include "studies/periodic_study.hpp"

#include <fmt/format.h>

#include "continuation/two_parameter.hpp"
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
  std::vector<std::string> curves;
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
  s.add({.name = "second.parameter",
         .description = "second parameter of the chart of special points",
         .default_value = std::string("support_motion.amplitude")});
  s.add({.name = "second.range",
         .description = "its lower and upper end; without it no chart",
         .default_value = std::vector<double>{},
         .optional = true,
         .max_items = 2});
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
  s.follow.walk.user_values.clear();
  s.follow.range1[0] = s.orbits.network.walk.lower;
  s.follow.range1[1] = s.orbits.network.walk.upper;
  s.follow.range2[0] = range[0];
  s.follow.range2[1] = range[1];
  s.curves = c.texts("second.curves");
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
  read_second(c, s);
  return s;
}

std::vector<std::string> check(const Configuration& c) {
  (void)setup(c);
  return check_forced_system(c);
}

void write_curve(ResultFile& file, const Setup& s, const std::vector<std::string>& units, const DefiningCurve& curve) {
  const Eigen::Index last = curve.u.rows() - 1;
  const auto column = [&](const std::string& name, const std::string& unit, const std::string& description, auto value) {
    Column c{name, unit, description, {}};
    for (Eigen::Index i = 0; i < curve.u.cols(); ++i) c.values.push_back(value(i));
    return c;
  };
  const std::string group = "/curves/" + curve.name;
  file.table(group, {column(s.parameter, units[0], "first parameter", [&](auto i) { return curve.u(last - 1, i); }),
                     column(s.second, units[1], "second parameter", [&](auto i) { return curve.u(last, i); }),
                     column("coefficient", "-", "normal-form coefficient", [&](auto i) { return curve.coefficient[i]; }),
                     column("frequency", "rad/s", "torus curves: of the second motion", [&](auto i) { return curve.frequency[i]; }),
                     column("residual", "-", "largest residual of the defining system", [&](auto i) { return curve.residual[i]; })});
  file.attribute(group, "type", std::string(to_string(curve.type)));
  file.attribute(group, "subtype", curve.subtype);
  file.attribute(group, "born_at", curve.born_at);
  file.attribute(group, "start_reason", std::string(to_string(curve.start_reason)));
  file.attribute(group, "stop_reason", std::string(to_string(curve.stop_reason)));
}

// Does a curve already followed pass through the point? Both parameters and the motion's size there tell.
bool on_known_curve(const std::vector<DefiningCurve>& curves, const SpecialPoint& p, double p2, const Setup& s) {
  const double w1 = s.follow.range1[1] - s.follow.range1[0], w2 = s.follow.range2[1] - s.follow.range2[0], p1 = p.u[p.u.size() - 1];
  return std::any_of(curves.begin(), curves.end(), [&](const DefiningCurve& c) {
    if (c.type != p.type || c.subtype != (p.type == EventType::branch_point ? p.subtype : "")) return false;
    const Eigen::Index last = c.u.rows() - 1;
    for (Eigen::Index i = 0; i + 1 < c.u.cols(); ++i) {
      const double a = c.u(last, i), b = c.u(last, i + 1);
      if ((a - p2) * (b - p2) > 0.0 || a == b) continue;
      const double t = (p2 - a) / (b - a), at = c.u(last - 1, i) + t * (c.u(last - 1, i + 1) - c.u(last - 1, i));
      const double chord = std::hypot((c.u(last - 1, i + 1) - c.u(last - 1, i)) / w1, (b - a) / w2);
      if (std::abs(at - p1) / w1 < 0.1 * chord * chord + 1e-6) return true;
    }
    return false;
  });
}

struct Chart {
  std::vector<DefiningCurve> curves;
};

// Every special point of every branch followed in the second parameter, each curve once.
Chart follow_all(const Configuration& c, const Setup& s, const OrbitBranches& orbits, ResultFile& file, RunContext& context) {
  Chart chart;
  const ForcedSystem wide = forced_system_of(c, {s.parameter, s.second});
  const double p2 = forced_lens_value(c, s.second);
  const Observer observer = [](const Branch&, int) { return !interrupted; };
  int number = 0;
  for (int level = 0; level < orbits.levels(); ++level) {
    const HarmonicBalance& hb = orbits.balance(level);
    const HarmonicBalance hb2(wide.system, {.harmonics = hb.harmonics(), .nu = hb.nu(), .reflections = wide.reflections, .floquet = {}});
    for (const auto& b : orbits.network(level).branches())
      for (std::size_t i = 0; i < b.special.size() && !interrupted; ++i) {
        const auto& point = b.special[i];
        const bool wanted = std::find(s.curves.begin(), s.curves.end(), to_string(point.type)) != s.curves.end();
        const bool arrival = b.stop_reason == StopReason::symmetric_branch && i + 1 == b.special.size();  // stands on the other branch
        if (!wanted || arrival || on_known_curve(chart.curves, point, p2, s)) continue;
        DefiningCurve curve;
        try {
          curve = follow(hb2, point, p2, s.follow, observer);
        } catch (const std::invalid_argument& e) {
          context.warn(fmt::format("{} on {}: {}", label(b, i), b.name, e.what()));
          continue;
        }
        curve.name = fmt::format("{}{}", curve.subtype.empty() ? to_string(curve.type) : curve.subtype.c_str(), ++number);
        curve.born_at = fmt::format("{}:{}", b.name, label(b, i));
        write_curve(file, s, wide.lens_units, curve);
        file.flush();
        context.progress.show(fmt::format("curve {}", curve.name));
        chart.curves.push_back(std::move(curve));
      }
  }
  context.progress.clear();
  return chart;
}

void write_chart_points(ResultFile& file, const Setup& s, const std::vector<std::string>& units, const Chart& chart) {
  std::vector<Column> table{
      {s.parameter, units[0], "first parameter", {}}, {s.second, units[1], "second parameter", {}}, {"residual", "-", "of the defining system", {}}};
  TextColumn names{"curve", "curve the point lies on", {}},
      types{"type", "CP cusp, DP degenerate pitchfork, FP fold and pitchfork, PP two pitchforks, MIN and MAX of the second parameter", {}};
  for (const auto& curve : chart.curves)
    for (const auto& z : curve.special) {
      const Eigen::Index last = z.u.size() - 1;
      table[0].values.push_back(z.u[last - 1]);
      table[1].values.push_back(z.u[last]);
      table[2].values.push_back(z.residual);
      names.values.push_back(curve.name);
      types.values.push_back(z.type);
    }
  file.table("/curve_points", table, {names, types});
}

std::string chart_text(const Setup& s, const Chart& chart) {
  std::string out = fmt::format("{:<8} {:<6} {:>22} {:>26} {:>9}\n", "curve", "point", s.parameter, s.second, "residual");
  for (const auto& c : chart.curves)
    for (const auto& z : c.special)
      out += fmt::format("{:<8} {:<6} {:>22.11f} {:>26.11f} {:>9.1e}\n", c.name, z.type, z.u[z.u.size() - 2], z.u[z.u.size() - 1], z.residual);
  for (const auto& c : chart.curves)
    out += fmt::format("curve {:<8} {:>5} points, born at {}, ends: {}, {}\n", c.name, c.u.cols(), c.born_at, to_string(c.start_reason),
                       to_string(c.stop_reason));
  return out;
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

// A JSON object with one more member at its end.
std::string with_member(std::string object, const std::string& key, const std::string& value) {
  object.erase(object.find_last_not_of("}\n") + 1);
  return fmt::format("{},\n  \"{}\": {}\n}}\n", object, key, value);
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : check_forced_system(c)) context.warn(w);
  ResultFile file(context.output);
  write_study(file, c);
  write_forced_system(file, c);
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
  const AttractorCheck& settled = orbits.check();
  settled.write(file, s.parameter);
  file.flush();
  if (context.json) fmt::print("{}", with_member(output.json(branches), "attractor_check", settled.json(s.parameter)));
  if (!context.quiet) fmt::print(stderr, "{}", output.text(branches));
  if (const std::string text = settled.text(s.parameter); !text.empty()) {
    if (!settled.complete()) context.warn(text);
    else if (!context.quiet) fmt::print(stderr, "{}\n", text);
  }
  if (!interrupted) verify(s, orbits, file, context);
  if (!s.second.empty() && !interrupted) {
    const Chart chart = follow_all(c, s, orbits, file, context);
    const auto units = forced_system_of(c, {s.parameter, s.second}).lens_units;
    write_chart_points(file, s, units, chart);
    if (!context.quiet) fmt::print(stderr, "\n{}", chart_text(s, chart));
  }
  return finish(file, context, branches);
}

}  // namespace

StudyKind periodic_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
