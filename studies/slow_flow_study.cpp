#include "studies/slow_flow_study.hpp"

#include <fmt/format.h>

#include <random>

#include "continuation/deflation.hpp"
#include "continuation/network.hpp"
#include "core/newton.hpp"
#include "core/parallel.hpp"
#include "studies/branch_output.hpp"
#include "studies/common_keys.hpp"
#include "studies/extremes.hpp"
#include "studies/modulation_output.hpp"
#include "studies/shown_columns.hpp"
#include "studies/slow_flow_ansatz.hpp"
#include "studies/slow_flow_verification.hpp"

namespace whirl::studies {
namespace {

using namespace models;
using continuation::Branch;
using continuation::Network;

constexpr NewtonOptions patient{.tolerance = 1e-11, .max_iterations = 50};

struct Setup {
  std::string parameter;
  continuation::NetworkOptions network;
  ForcedSystem forced;
  AveragedEquations averaged;
};

void add_seed_keys(Schema& s) {
  s.add_count("seeds.grid", "parameter values at which further solutions are looked for; 0: only what the linear response leads to", 5, 0, 10000);
  s.add({.name = "seeds.starts",
         .unit = "m",
         .description = "displacements at rest from which the equations of motion are integrated there, one number a coordinate, start after start; "
                        "by default rest, 3 in the first coordinate, 10 in all",
         .default_value = std::vector<double>{}});
  s.add_count("seeds.max_periods", "excitation periods of each of these integrations; 0: none", 1000, 0, 10000000);
  s.add_count("seeds.random", "random states from which deflated Newton starts there", 6, 0, 10000);
  s.add({.name = "seeds.size", .unit = "m", .description = "largest entry of a random state", .default_value = 3.0, .lower = 0.0});
}

Schema schema() {
  Schema s("slow-flow", "averaged equations for any list of harmonics: branches, special points, combinatorial responses, time integration");
  add_forced_system_keys(s);
  add_ansatz_keys(s);
  add_continuation_keys(s, "omega");
  add_seed_keys(s);
  add_verification_keys(s);
  add_modulation_keys(s);
  s.add_count("verification.transient_periods", "excitation periods recorded from the start of each run from rest", 60, 0, 100000);
  return s;
}

// ---- set-up ----------------------------------------------------------------------------------------------------------------

// Displacements at rest, n numbers each. The default for any n: rest, 3 in the first coordinate, 10 in all.
std::vector<std::vector<double>> starts_of(const Configuration& c, const std::string& key, std::size_t n) {
  std::vector<std::vector<double>> starts;
  const auto& all = c.numbers(key);
  if (all == std::get<std::vector<double>>(c.schema().find(key)->default_value)) {
    starts.assign(3, std::vector<double>(n, 0.0));
    starts[1][0] = 3.0;
    starts[2].assign(n, 10.0);
    return starts;
  }
  if (all.size() % n != 0) throw c.error(key, fmt::format("must hold {} numbers for each start", n));
  for (std::size_t i = 0; i < all.size(); i += n)
    starts.emplace_back(all.begin() + static_cast<std::ptrdiff_t>(i), all.begin() + static_cast<std::ptrdiff_t>(i + n));
  return starts;
}

SettleOptions settle_options(const Configuration& c) {
  SettleOptions o;
  o.tolerance = c.number("verification.tolerance");
  o.max_periods = static_cast<int>(c.integer("verification.max_periods"));
  o.integrator.relative_tolerance = c.number("verification.relative_tolerance");
  o.integrator.absolute_tolerance = c.number("verification.absolute_tolerance");
  return o;
}

void check_range(const Configuration& c, const Setup& s) {
  if (s.parameter != "omega") {
    if (c.is_given("cable.chord_length")) check_lens_range(c, s.parameter, s.network.walk);
    return;
  }
  if (!(s.network.walk.lower > 0.0)) throw c.error("continuation.range", "must lie in (0, inf) [rad/s], the range of omega");
  if (c.is_given("omega")) throw c.error("omega", "is the continuation parameter: remove it, or choose another continuation.parameter");
}

std::unique_ptr<Setup> setup(const Configuration& c) {
  const std::string& parameter = c.text("continuation.parameter");
  auto network = network_of(c);
  ForcedSystem forced = forced_system_of(c, {parameter});
  auto s = std::make_unique<Setup>(Setup{parameter, std::move(network), std::move(forced), {}});  // the averaged equations point into it
  check_range(c, *s);
  s->averaged = averaged_of(c, s->forced);
  const std::size_t n = s->forced.coordinates.size();
  (void)starts_of(c, "seeds.starts", n);
  (void)starts_of(c, "verification.starts", n);
  return s;
}

std::vector<std::string> check(const Configuration& c) {
  const auto s = setup(c);
  auto warnings = check_forced_system(c);
  for (auto& w : dropped_forces(s->forced, s->averaged.ansatz)) warnings.push_back(std::move(w));
  const std::string kind = ansatz_kind(c, s->forced);
  if (kind == "combinatorial-32-printed")
    warnings.emplace_back("the printed equations drop terms: ansatz.kind = \"combinatorial-32\" keeps all of them on the same harmonics");
  if (kind == "complete" && c.integer("ansatz.nu") == 1)
    warnings.emplace_back("with ansatz.nu = 1 no subharmonic motion is seen: period doublings need ansatz.nu = 2");
  return warnings;
}

// ---- columns ---------------------------------------------------------------------------------------------------------------

// Largest modulus of the Floquet multipliers of the averaged motion taken as it is, over nu periods.
std::function<double(In)> floquet_modulus(const Setup& s) {
  Vector p = Vector::Constant(1, s.network.walk.lower);
  const auto floquet = std::make_shared<Floquet>(s.forced.at(p), s.averaged.balance_harmonics, s.averaged.ansatz.nu);
  return [floquet, &s](In u) {
    const auto& result = floquet->compute(s.forced.at(u.tail(1)), s.averaged.balance_state(u));
    return result.converged ? result.multipliers.cwiseAbs().maxCoeff() : std::nan("");
  };
}

BranchOutput output_of(const Setup& s) {
  BranchOutput out;
  out.parameter = s.parameter;
  out.parameter_unit = s.forced.lens_units.front();
  const Ansatz& a = s.averaged.ansatz;
  out.columns = harmonic_columns(s.forced, a);
  append_unshown(out.columns, extreme_columns(s.forced.coordinates, s.forced.length_unit, a.frozen ? ", the frozen linear response included" : "",
                                              [&s](In u, int i) {
                                                const Vector q = s.averaged.balance_state(u);
                                                const int width = 2 * s.averaged.balance_harmonics + 1;
                                                std::vector<std::complex<double>> z{q[i * width]};
                                                for (int k = 1; 2 * k < width; ++k) z.emplace_back(q[i * width + 2 * k - 1], -q[i * width + 2 * k]);
                                                return z;
                                              }));
  out.columns.push_back({"floquet_modulus", "-",
                         fmt::format("largest modulus of the Floquet multipliers of this motion over {} excitation periods; above 1: unstable", a.nu),
                         floquet_modulus(s)});
  return out;
}

// ---- finding branches ------------------------------------------------------------------------------------------------------

double grid_value(const Setup& s, std::int64_t i, std::int64_t count) {
  const auto& walk = s.network.walk;
  return walk.lower + (walk.upper - walk.lower) * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
}

// Where the equations of motion settle, at each grid value from each start.
std::vector<std::vector<SteadyMotion>> settled_motions(const Configuration& c, const Setup& s, RunContext& context) {
  const auto grid = c.integer("seeds.grid"), periods = c.integer("seeds.max_periods");
  const auto starts = starts_of(c, "seeds.starts", s.forced.coordinates.size());
  std::vector<std::vector<SteadyMotion>> motions(static_cast<std::size_t>(grid));
  if (periods == 0 || starts.empty()) return motions;
  for (auto& at : motions) at.resize(starts.size());
  std::atomic<std::size_t> done{0};
  const std::size_t jobs = motions.size() * starts.size();
  parallel_for(jobs, [&](std::size_t job) {
    if (interrupted) return;
    const std::size_t g = job / starts.size(), k = job % starts.size();
    auto options = settle_options(c);
    options.max_periods = static_cast<int>(periods);
    options.lyapunov_periods = 0;
    options.interrupted = &interrupted;
    const auto system = s.forced.at(Vector::Constant(1, grid_value(s, static_cast<std::int64_t>(g), grid)));
    Vector y = Vector::Zero(2 * system.size());
    for (std::size_t i = 0; i < starts[k].size(); ++i) y[static_cast<Eigen::Index>(i)] = starts[k][i];
    motions[g][k] = settle(system, off_symmetry(s.forced, y, c.number("verification.perturbation")), options);
    context.progress.show(fmt::format("seeds: {} of {} motions", ++done, jobs));
  });
  return motions;
}

void add(const Setup& s, Network& net, const Vector& solution, const std::string& origin) {
  const NewtonResult r = newton(*s.averaged.flow, symmetric_to_the_bit(*s.averaged.flow, solution), patient);
  if (r.ok() && net.add_seed(r.x, origin)) net.switch_branches();
}

void try_seed(const Setup& s, Network& net, const Vector& start, const std::string& origin) {
  const NewtonResult r = newton(*s.averaged.flow, start, patient);
  if (r.ok()) add(s, net, r.x, origin);
}

void explore(const Configuration& c, const Setup& s, Network& net, RunContext& context) {
  const Problem& flow = *s.averaged.flow;
  const int n = flow.size();
  const auto with = [&](const Vector& x, double p) {
    Vector u(n + 1);
    u << x, p;
    return u;
  };
  for (const double p : {s.network.walk.lower, s.network.walk.upper}) {
    const Vector x = linear_state(s.averaged.ansatz, s.forced.at(Vector::Constant(1, p)));
    try_seed(s, net, with(x, p), fmt::format("linear response at {} = {:.6g}", s.parameter, p));
  }
  const auto grid = c.integer("seeds.grid");
  const auto motions = settled_motions(c, s, context);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> entry(-c.number("seeds.size"), c.number("seeds.size"));
  std::vector<int> longer;
  for (std::int64_t g = 0; g < grid && !net.stopped() && !interrupted; ++g) {
    const double p = grid_value(s, g, grid);
    std::vector<Vector> starts;
    for (const SteadyMotion& m : motions[static_cast<std::size_t>(g)]) {
      if (m.kind != MotionKind::periodic) continue;
      if (s.averaged.ansatz.nu % m.multiple != 0) {
        if (std::find(longer.begin(), longer.end(), m.multiple) == longer.end()) longer.push_back(m.multiple);
        continue;
      }
      starts.push_back(with(state_of(s.averaged.ansatz, m), p));
      try_seed(s, net, starts.back(), fmt::format("settled motion at {} = {:.6g}", s.parameter, p));
    }
    for (std::int64_t k = 0; k < c.integer("seeds.random"); ++k) starts.push_back(with(Vector::NullaryExpr(n, [&] { return entry(random); }), p));
    std::vector<Vector> known;
    for (const auto& [branch, u] : net.solutions_at(p)) known.push_back(u);
    const std::size_t count = known.size();
    const auto all = continuation::deflated_solutions(flow, std::move(known), starts);
    for (std::size_t i = count; i < all.size(); ++i) add(s, net, all[i], fmt::format("deflation at {} = {:.6g}", s.parameter, p));
  }
  for (const int m : longer)
    context.warn(fmt::format("a motion of period {}T was met that the ansatz cannot hold: it needs nu = {} or a multiple", m, m));
  for (const auto& note : net.notes()) context.warn(note);
  if (net.branches().empty()) context.warn("no steady state was found in the range");
}

// ---- verification ----------------------------------------------------------------------------------------------------------

// The averaged equations in time, from the starts at rest.
void run_modulations(const Configuration& c, const Setup& s, ResultFile& file, RunContext& context) {
  ModulationOptions o;
  o.periods = static_cast<int>(c.integer("verification.modulation_periods"));
  if (o.periods == 0 || interrupted) return;
  o.integrator = settle_options(c).integrator;
  const ModulationLabels labels{s.forced.coordinates, s.forced.length_unit, s.averaged.ansatz.nu};
  std::vector<ModulationRun> runs;
  for (const double omega : c.numbers("verification.omega"))
    for (const auto& start : starts_of(c, "verification.starts", s.forced.coordinates.size())) {
      if (interrupted) break;
      Vector y = Vector::Zero(2 * static_cast<Eigen::Index>(start.size()));
      y.head(y.size() / 2) = Eigen::Map<const Vector>(start.data(), static_cast<Eigen::Index>(start.size()));
      std::string name;
      for (std::size_t i = 0; i < start.size(); ++i) name += fmt::format("{}{} = {:g}", i > 0 ? ", " : "", s.forced.coordinates[i], start[i]);
      const Vector p = Vector::Constant(1, omega);
      runs.push_back({omega, name,
                      modulation(s.forced.at(p), {*s.averaged.flow, s.averaged.ansatz, s.averaged.motion}, p,
                                 off_symmetry(s.forced, y, c.number("verification.perturbation")), o)});
    }
  tell_modulations(file, context, labels, runs);
}

// Integrated runs beside the branches; what did not settle.
std::vector<std::string> run_verification(const Configuration& c, const Setup& s, const Network& net, ResultFile& file, RunContext& context) {
  const auto& omegas = c.numbers("verification.omega");
  if (omegas.empty()) return {};
  IntegrationOptions o;
  o.perturbation = c.number("verification.perturbation");
  o.starts = starts_of(c, "verification.starts", s.forced.coordinates.size());
  o.settle = settle_options(c);
  o.transient_periods = static_cast<int>(c.integer("verification.transient_periods"));
  std::vector<std::vector<AveragedSolution>> solutions;
  for (const double omega : omegas) {
    solutions.emplace_back();
    for (const auto& [branch, u] : net.solutions_at(omega))
      solutions.back().push_back({net.branches()[static_cast<std::size_t>(branch)].name, u, net.unstable_at(branch, u) == 0});
  }
  write_averaged(file, s.forced, s.averaged, solutions);
  const auto runs = integrate_beside(s.forced, s.averaged, omegas, solutions, o, context);
  if (!runs.empty()) write_integrated(file, s.forced, s.averaged, runs);
  file.flush();
  context.progress.clear();
  if (!runs.empty()) context.print(fmt::format("\n{}", integrated_text(s.forced, s.averaged, runs)));
  report_integrated(context.report, s.forced, s.averaged, runs);
  run_modulations(c, s, file, context);
  return not_settled(runs);
}

ExitStatus run(const Configuration& c, RunContext& context) {
  for (const auto& w : check(c)) context.warn(w);
  const auto s = setup(c);
  const BranchOutput output = output_of(*s);
  ResultFile file(context.output);
  write_study(file, c);
  write_forced_system(file, context, c);
  file.attribute("/study", "mirrored", mirrored_coordinates(s->forced));
  file.attribute("/study", "nu", static_cast<double>(s->averaged.ansatz.nu));
  Network net(*s->averaged.flow, s->network);
  net.set_namer([&](const Branch& b) { return motion_prefix(s->forced, s->averaged.ansatz, b); });
  net.set_observer([&](const Branch& b, int i) {
    if (i % 50 == 0) context.progress.show(fmt::format("branch at {} = {:.6g}, {} points", s->parameter, b.parameter(i), i));
    return !interrupted;
  });
  net.on_branch([&](const Branch& b) {
    output.write_branch(file, b);
    file.flush();
  });
  explore(c, *s, net, context);
  const auto branches = with_fast_marked(s->forced, s->averaged.ansatz, net.branches(), context);
  output.write_special_points(file, branches);
  file.flush();
  context.progress.clear();
  output.report(context.report, branches);
  context.print(output.text(branches));
  std::vector<std::string> failures;
  if (c.flag("verification.enabled") && !interrupted) {
    if (s->parameter == "omega") failures = run_verification(c, *s, net, file, context);
    else if (!c.numbers("verification.omega").empty())
      context.warn("verification compares at frequencies: it is left out because continuation.parameter is not omega");
  }
  return finish(file, context, branches, failures);
}

}  // namespace

StudyKind slow_flow_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
