#include "studies/cycles_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "studies/common_keys.hpp"
#include "studies/cycle_chart.hpp"
#include "studies/cycle_motions.hpp"
#include "studies/cycle_output.hpp"
#include "studies/equilibrium_source.hpp"
#include "studies/second_parameter.hpp"

namespace whirl::studies {
namespace {

using namespace continuation;

constexpr int orbit_samples = 400;  // of an orbit in the file

struct Setup {
  std::unique_ptr<EquilibriumSource> source;
  std::string parameter, unit_of_time;
  CycleOptions cycles;
  std::vector<Vector> integrate_from;
  SecondParameter second;  // no name: no chart
};

Schema schema() {
  Schema s("cycles", "limit cycles born at the Hopf points of any system given as expressions, or of a cable's averaged slow flow");
  add_equilibrium_source_keys(s);
  add_continuation_keys(s, "omega");
  s.add_count("cycles.period_doublings", "levels of doubled families that are followed", 1, 0, 6);
  s.add({.name = "cycles.integrate_at",
         .description =
             "parameter values at which the system is integrated from cycles.integrate_from: the family of the stable cycle met is followed too",
         .default_value = std::vector<double>{}});
  s.add({.name = "cycles.integrate_from",
         .description = "the variables, one start after the other; by default one state of size one",
         .default_value = std::vector<double>{}});
  s.add({.name = "cycles.transient",
         .description = "in units of the system's time, before a cycle is looked for; as long again to find it",
         .default_value = 500.0,
         .lower = 0.0});
  s.add_count("cycles.exponents", "intervals over which the Lyapunov exponents of each integrated motion are means; 0: none", 2000, 0, 1e8);
  s.add({.name = "cycles.exponent_interval",
         .description = "in units of the system's time, about 1 over the largest exponent or less; 0: a thousandth of cycles.transient",
         .default_value = 0.0,
         .lower = 0.0,
         .closed_lower = true});
  s.add({.name = "cycles.longest_period",
         .description =
             "in units of the system's time: families end where the period of the single cycle passes it; 0: eight periods of the Hopf point",
         .default_value = 0.0,
         .lower = 0.0,
         .closed_lower = true});
  s.add({.name = "cycles.tolerance",
         .description = "error of the cycles, relative to their size: the mesh follows it",
         .default_value = 1e-11,
         .lower = 1e-14,
         .upper = 1e-4,
         .closed_lower = true,
         .closed_upper = true});
  s.add_count("cycles.segments", "parts of the period whose ends are unknowns; more where multipliers are very large", 8, 1, 200);
  s.add_count("cycles.max_points", "of one branch of cycles in one direction", 1000, 2, 1e6);
  add_second_keys(s, {.what = "second parameter of the chart of special points of cycles; without it no chart",
                      .parameter = "",
                      .curves = {"LP", "BP", "PD", "TR"}});
  return s;
}

Setup setup(const Configuration& c) {
  Setup s;
  s.source = equilibrium_source(c);
  check_parameter_given(c, "continuation.parameter");
  s.parameter = c.text("continuation.parameter");
  s.unit_of_time = std::string(c.has("equilibrium_model") ? "-" : "s");
  s.cycles.network = network_of(c);
  s.source->check_lens("continuation.parameter", s.parameter, "continuation.range", s.cycles.network.walk.lower, s.cycles.network.walk.upper);
  s.cycles.period_doublings = static_cast<int>(c.integer("cycles.period_doublings"));
  s.cycles.longest_period = c.number("cycles.longest_period");
  s.cycles.cycle.tolerance = c.number("cycles.tolerance");
  s.cycles.cycle.segments = static_cast<int>(c.integer("cycles.segments"));
  const int n = s.source->problem({s.parameter})->size();
  if (const auto counted = c.integer("cycles.exponents"); counted > 0 && counted < 20)
    throw c.error("cycles.exponents", fmt::format("must be 0 or at least 20, got {}", counted));
  const auto& from = c.numbers("cycles.integrate_from");
  if (from.size() % static_cast<std::size_t>(n) != 0) throw c.error("cycles.integrate_from", fmt::format("must hold groups of {} numbers", n));
  for (std::size_t i = 0; i < from.size(); i += static_cast<std::size_t>(n)) s.integrate_from.push_back(Eigen::Map<const Vector>(from.data() + i, n));
  if (from.empty()) s.integrate_from.push_back(Vector::Constant(n, 1.0 / std::sqrt(n)));
  for (const double p : c.numbers("cycles.integrate_at"))
    if (p < s.cycles.network.walk.lower || p > s.cycles.network.walk.upper)
      throw c.error("cycles.integrate_at", "each value must lie in continuation.range");
  const bool ranged = c.has("second.range") && !c.numbers("second.range").empty();
  if (c.text("second.parameter").empty()) {
    if (ranged) throw c.error("second.range", "goes with second.parameter, which is not given");
  } else {
    const EquilibriumSource& source = *s.source;
    if (!ranged) throw c.error("second.range", "must hold two increasing values");
    s.second = read_second(c, s.parameter, s.cycles.network.walk, lens_of(source));
    s.second.follow.walk.max_points = static_cast<int>(c.integer("cycles.max_points"));
  }
  if (n < 2) throw c.error("study", "\"cycles\" needs a system of at least two variables");
  return s;
}

std::vector<std::string> check(const Configuration& c) { return setup(c).source->warnings(); }

/// From the Hopf point outwards.
Branch from_hopf(const Branch& b, const CycleFamily& family, int level) {
  const bool reversed =
      level == 0 && family.end(b.u(b.points() - 1), level) == CycleEnd::equilibrium && family.end(b.u(0), level) != CycleEnd::equilibrium;
  return reversed ? b.reversed() : b;
}

void write_family_branch(ResultFile& file, const Branch& b, const CycleFamily& family, int level, CycleReader& reader, const Setup& s,
                         const Problem& flow, RunContext& context) {
  for (std::size_t i = 0; i < b.special.size(); ++i)
    file.table(fmt::format("/orbits/{}_{}", b.name, label(b, i)), reader.orbit(b.special[i].u, orbit_samples, s.unit_of_time));
  const std::string group = "/branches/" + b.name;
  file.attribute(group, "kind", std::string("cycles"));
  for (const int i : {0, b.points() - 1}) {
    const Vector u = b.u(i);
    const CycleEnd end = family.end(u, level);
    const char* const which = i == 0 ? "start" : "end";
    if (end == CycleEnd::equilibrium) file.attribute(group, which, std::string("shrinks to an equilibrium"));
    if (end != CycleEnd::long_period) continue;
    const double period = family.problem(level).period(u);
    const auto near = equilibrium_approached(flow, family.problem(level), u);
    const std::string text = near ? describe(*near) : std::string("no equilibrium is near");
    file.attribute(group, which, fmt::format("period {:.10g}, {}", period, text));
    context.warn(fmt::format("branch {} ends at {} = {:.12g} where its period passes cycles.longest_period ({:.6g}): {}", b.name, s.parameter,
                             u[u.size() - 1], family.longest_period, text));
  }
}

// The motions that integration leads to, and the families of those that are cycles.
std::vector<IntegratedMotion> integrate(const Configuration& c, const Setup& s, const Problem& flow, CycleBranches& cycles, RunContext& context) {
  std::vector<IntegratedMotion> motions;
  const double transient = c.number("cycles.transient"), interval = c.number("cycles.exponent_interval");
  models::LyapunovSpectrumOptions options;
  options.interval = interval > 0.0 ? interval : 1e-3 * transient;
  options.skip = static_cast<int>(std::ceil(transient / options.interval));
  options.counted = static_cast<int>(c.integer("cycles.exponents"));
  options.interrupted = &interrupted;
  for (const double p : c.numbers("cycles.integrate_at"))
    for (const Vector& x : s.integrate_from) {
      if (interrupted) return motions;
      const std::string origin = fmt::format("integrated at {} = {:.6g}", s.parameter, p);
      context.progress.show(origin);
      const std::string why = cycles.add_motion(x, p, transient, origin);
      if (!why.empty()) context.warn(fmt::format("{}: {}", origin, why));
      if (options.counted == 0 || interrupted) continue;
      motions.push_back({p, x, models::lyapunov_spectrum(flow, x, Vector::Constant(1, p), options)});
      if (interrupted) {
        motions.pop_back();  // broken off
        return motions;
      }
      models::LyapunovSpectrum& spectrum = motions.back().spectrum;
      if (spectrum.kind == models::FlowMotion::torus && why != CycleBranches::not_periodic) spectrum.kind = models::FlowMotion::cycle;  // it closed
      if (!spectrum.ok()) context.warn(fmt::format("{}: no Lyapunov exponents, the motion diverges", origin));
    }
  return motions;
}

// Every special point of every family in the second parameter.
void follow_chart(const Setup& s, const CycleBranches& cycles, ResultFile& file, RunContext& context) {
  const auto flow2 = s.source->problem({s.parameter, s.second.name});
  CycleReader reader(*flow2, s.source->columns(*flow2), s.cycles.cycle);
  CycleChart chart(*flow2, {s.second.follow, s.second.curves, s.second.value, s.cycles.cycle}, reader.extremes(s.unit_of_time), context);
  const ChartOutput output{s.parameter, s.source->unit(s.parameter), s.second.name, s.source->unit(s.second.name)};
  chart.on_curve([&](const ChartCurve& curve) {
    output.write_curve(file, curve);
    file.flush();
  });
  for (const auto& family : cycles.families())
    if (!interrupted) chart.follow(*family);
  context.progress.clear();
  const std::vector<ChartCurve> curves = chart.curves();
  output.write_points(file, "/curve_points", curves);
  file.flush();
  context.report.put("curve_points", output.points_json(curves)).put("curves", ChartOutput::curves_json(curves));
  context.print(fmt::format("\n{}", output.text(curves)));
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : s.source->warnings()) context.warn(w);
  const auto flow = s.source->problem({s.parameter});
  CycleReader reader(*flow, s.source->columns(*flow), s.cycles.cycle);
  BranchOutput output;
  output.parameter = s.parameter;
  output.parameter_unit = s.source->unit(s.parameter);
  output.columns = reader.extremes(s.unit_of_time);
  output.period_of = [&reader](In u) { return static_cast<double>(reader.multiple(u)); };
  ResultFile file(context.output);
  write_study(file, c);
  s.source->write(file, context);
  const auto observer = [&](const std::string& what) {
    return [&context, &s, what](const Branch& b, int i) {
      if (i % 20 == 0)
        context.progress.show(fmt::format("{} at {} = {:.6g}, {} points", what, s.parameter, b.parameter(std::min(i, b.points() - 1)), i));
      return !interrupted;
    };
  };

  Network equilibria(*flow, s.cycles.network);
  equilibria.set_namer(s.source->namer());
  equilibria.set_observer(observer("equilibria"));
  equilibria.on_branch([&](const Branch& b) {
    output.write_branch(file, b);
    file.flush();
  });
  for (const Start& start : s.source->starts(*flow, s.parameter, s.cycles.network.walk.lower, s.cycles.network.walk.upper)) {
    try_seed(equilibria, start.u, start.origin, context);
    equilibria.switch_branches();
  }
  if (equilibria.branches().empty()) context.warn("no equilibrium was found in the range");
  std::vector<Branch> all = s.source->marked(equilibria.branches(), context);

  CycleOptions options = s.cycles;
  options.network.walk.max_points = static_cast<int>(c.integer("cycles.max_points"));
  options.network.walk.user_values = c.numbers("continuation.user_values");
  CycleBranches cycles(*flow, options);
  cycles.set_observer(observer("cycles"));
  const std::size_t first_cycle = all.size();
  cycles.on_branch([&](const Branch& walked, const CycleFamily& family, int level) {
    if (walked.points() == 0) return;
    const Branch b = from_hopf(walked, family, level);
    output.multipliers = true;
    output.write_branch(file, b);
    write_family_branch(file, b, family, level, reader, s, *flow, context);
    file.flush();
    all.push_back(b);
  });
  for (std::size_t i = 0; i < first_cycle && !interrupted; ++i) {
    const Branch b = all[i];
    for (std::size_t k = 0; k < b.special.size() && !interrupted; ++k) {
      if (b.special[k].type != EventType::hopf) continue;
      const std::string origin = fmt::format("{}:{}", b.name, label(b, k));
      if (const std::string why = cycles.add_hopf(b.special[k], origin); !why.empty()) context.warn(fmt::format("{}: {}", origin, why));
    }
  }
  const std::vector<IntegratedMotion> motions = integrate(c, s, *flow, cycles, context);
  MotionTable table{s.parameter, s.source->unit(s.parameter), s.unit_of_time, {}};
  for (int i = 0; i < flow->size(); ++i) table.variables.push_back(fmt::format("x{}", i + 1));
  table.write(file, motions);
  output.write_special_points(file, all);
  file.flush();
  context.progress.clear();
  if (cycles.families().empty())
    context.warn("no cycles were found: no Hopf point lies in the range, and nothing was met by integration (cycles.integrate_at)");
  output.report(context.report, all);
  if (!motions.empty()) context.report.put("motions", MotionTable::json(motions, s.parameter));
  context.print(output.text(all));
  if (!motions.empty()) context.print(fmt::format("\n{}", table.text(motions)));
  if (!s.second.name.empty() && !interrupted) follow_chart(s, cycles, file, context);
  return finish(file, context, all);
}

}  // namespace

StudyKind cycles_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
