#include "studies/superharmonic_study.hpp"

#include <fmt/format.h>

#include <numbers>

#include "continuation/network.hpp"
#include "core/kinsol.hpp"
#include "core/parallel.hpp"
#include "models/closed_forms.hpp"
#include "studies/branch_output.hpp"
#include "studies/common_keys.hpp"
#include "studies/extremes.hpp"
#include "studies/modulation_output.hpp"
#include "studies/shown_columns.hpp"
#include "studies/verification.hpp"

namespace whirl::studies {
namespace {

using namespace models;
using continuation::Branch;
using continuation::Network;

struct Setup {
  StayParameters<double> stay;
  SuperharmonicOptions flow;
  Terms terms;
  std::string parameter;
  continuation::NetworkOptions network;
  int seed_grid;
};

Schema schema() {
  Schema s("superharmonic", "superharmonic response of a stay: averaged branches, whirling points, time integration");
  add_stay_keys(s);
  s.add_count("response.order", "superharmonic order n", 2, 2, 50);
  add_continuation_keys(s, "omega");
  s.add_count("continuation.seed_grid", "parameter values at which all closed-form solutions are tried as starts of further branches; 0: none", 61, 0,
              100000);
  add_verification_keys(s);
  add_modulation_keys(s);
  s.add({.name = "orbits.omega",
         .unit = "rad/s",
         .description = "frequency at which whirling orbits are drawn for several dampings",
         .optional = true,
         .lower = 0.0,
         .example = Value{1.65}});
  s.add({.name = "orbits.damping_pairs",
         .unit = "-",
         .description = "damping ratios out of plane and in plane, pair after pair",
         .default_value = std::vector<double>{},
         .lower = 0.0,
         .upper = 1.0,
         .closed_lower = true});
  return s;
}

Setup setup(const Configuration& c) {
  Setup s;
  s.stay = stay_of(c);
  s.flow = {static_cast<int>(c.integer("response.order")), coefficients_of(c)};
  s.terms = terms_of(c);
  s.parameter = c.text("continuation.parameter");
  s.network = network_of(c);
  s.seed_grid = static_cast<int>(c.integer("continuation.seed_grid"));
  check_lens_range(c, s.parameter, s.network.walk);
  (void)settle_of(c);  // complains of its keys
  if (c.numbers("orbits.damping_pairs").size() % 2 != 0) throw c.error("orbits.damping_pairs", "must hold pairs: an even number of values");
  if (!c.numbers("orbits.damping_pairs").empty() && !c.has("orbits.omega")) throw c.error("orbits.damping_pairs", "needs orbits.omega");
  return s;
}

std::vector<std::string> check(const Configuration& c) {
  const Setup s = setup(c);
  auto warnings = check_cable(c);
  if (s.terms == Terms::full)
    warnings.emplace_back(
        "model.terms = \"full\": the averaged equations stay those of the reduced coupling (35); only the integration uses all terms");
  const double w1 = modes(s.stay.cable).omega1, n = s.flow.order;
  if (s.parameter == "omega" && (s.network.walk.lower > 1.5 * w1 / n || s.network.walk.upper < 0.7 * w1 / n))
    warnings.push_back(fmt::format("the range [{:g}, {:g}] rad/s is far from the superharmonic resonance w1/n = {:.4g} rad/s", s.network.walk.lower,
                                   s.network.walk.upper, w1 / n));
  if (n >= 3)
    warnings.emplace_back(
        "first-order averaging of order n >= 3 leaves out the second-order parametric forcing, which dominates at large support motion");
  return warnings;
}

BranchOutput output_of(const SuperharmonicFlow& flow, const Setup& s) {
  BranchOutput out;
  const Lens lens(s.parameter);
  out.parameter = lens.name();
  out.parameter_unit = lens.unit();
  const int n = s.flow.order;
  const auto add = [&](const std::string& name, const std::string& unit, const std::string& description, auto value) {
    out.columns.push_back({name, unit, description, [&flow, value](In u) { return value(flow.observe(u)); }});
  };
  add(fmt::format("q1_h{}", n), "m", "A: amplitude of cos(n omega t + phase) in q1, out of plane", [](const Superharmonic& o) { return o.A; });
  add(fmt::format("q2_h{}", n), "m", "B: amplitude of cos(n omega t + phase) in q2, in plane", [](const Superharmonic& o) { return o.B; });
  add("q2_h1", "m", "B0: amplitude of cos(omega t + phase) in q2, linear forced response", [](const Superharmonic& o) { return o.B0; });
  add(fmt::format("q1_h{}_phase", n), "rad", "Psi1", [](const Superharmonic& o) { return o.Psi1; });
  add(fmt::format("q2_h{}_phase", n), "rad", "Psi2", [](const Superharmonic& o) { return o.Psi2; });
  add("q2_h1_phase", "rad", "Psi0", [](const Superharmonic& o) { return o.Psi0; });
  append_unshown(out.columns, extreme_columns(flow, n));
  static constexpr const char* state[] = {"u1", "v1", "u2", "v2"};
  for (int i = 0; i < 4; ++i) out.columns.push_back({state[i], "m", "Cartesian van der Pol coordinate", [i](In u) { return u[i]; }});
  if (s.parameter == "omega") {
    const double w1 = modes(s.stay.cable).omega1;
    out.columns.push_back({"omega_ratio", "-", "omega / w1", [w1](In u) { return u[4] / w1; }});
    out.columns.push_back({"frequency", "Hz", "omega / 2 pi", [](In u) { return u[4] / (2.0 * std::numbers::pi); }});
  }
  out.columns.push_back({"tension_max", "N", "largest chord tension over a period: T + AE (mean axial strain along the chord)",
                         [&flow, s](In u) { return largest_tension(flow, s.flow.coefficients, u); }});
  return out;
}

// First point by KINSOL from rest, then every closed-form solution on the grid that no branch passes through. Any of them starts the study.
void explore(const SuperharmonicFlow& flow, const Setup& s, Network& net, RunContext& context) {
  const auto& walk = s.network.walk;
  Vector start = Vector::Zero(5);
  start[4] = walk.lower;
  const NewtonResult first = line_search_solve(flow, start);
  if (first.ok()) net.add_seed(first.x, "start");
  const auto seed = [&](auto states_at, const std::string& origin) {
    for (int i = 0; i < s.seed_grid && !net.stopped(); ++i) {
      const double p = s.seed_grid == 1 ? 0.5 * (walk.lower + walk.upper) : walk.lower + (walk.upper - walk.lower) * i / (s.seed_grid - 1);
      for (const auto& x : states_at(flow.model().coefficients<double>(std::array<double, 1>{p}))) {
        Vector u(5);
        u << x, p;
        net.add_seed(u, fmt::format("{} at {} = {:.6g}", origin, s.parameter, p));
      }
    }
  };
  seed(in_plane_states, "closed form (51)");
  net.switch_branches();
  seed(coupled_states, "closed form (56)");
  net.switch_branches();
  for (const auto& note : net.notes()) context.warn(note);
  if (net.branches().empty()) context.warn("no steady state was found in the range");
}

void write_cable(ResultFile& file, RunContext& context, const Setup& s) {
  const auto k = modal_coefficients(modes(s.stay.cable), s.flow.coefficients);
  write_cable_numbers(file, context, s.stay.cable);
  const std::pair<const char*, double> coefficients[] = {{"m1", k.m1}, {"m2", k.m2}, {"a1", k.a1}, {"a2", k.a2}, {"c1", k.c1}, {"c2", k.c2},
                                                         {"d1", k.d1}, {"d2", k.d2}, {"d3", k.d3}, {"C1", k.C1}, {"C2", k.C2}, {"C3", k.C3},
                                                         {"C4", k.C4}, {"G1", k.G1}, {"G2", k.G2}, {"G3", k.G3}, {"G4", k.G4}};
  Numbers numbers;
  std::string line = "modal coefficients:";
  for (const auto& [name, value] : coefficients) {
    numbers.push_back({name, "-", "modal coefficient, Nielsen & Kirkegaard eq. (24)", value});
    line += fmt::format(" {} {:.6g}", name, value);
  }
  write_numbers(file, "/cable/coefficients", numbers);
  context.report.put("coefficients", numbers_json(numbers));
  context.print(line + "\n");
}

VerificationOptions verification_of(const Configuration& c, const Setup& s) {
  VerificationOptions o;
  o.stay = s.stay;
  o.coefficients = s.flow.coefficients;
  o.terms = s.terms;
  o.order = s.flow.order;
  o.perturbation = c.number("verification.perturbation");
  o.starts = c.numbers("verification.starts");
  o.settle = settle_of(c);
  return o;
}

// The averaged equations in time, from the starts at rest.
void run_modulations(const Configuration& c, const Setup& s, const SuperharmonicFlow& flow, ResultFile& file, RunContext& context) {
  models::ModulationOptions o;
  o.periods = static_cast<int>(c.integer("verification.modulation_periods"));
  if (o.periods == 0 || interrupted || !c.has("verification.omega")) return;
  const VerificationOptions v = verification_of(c, s);
  o.integrator = v.settle.integrator;
  const models::Ansatz ansatz = models::Ansatz::superharmonic(2, s.flow.order);
  std::vector<ModulationRun> runs;
  for (const double omega : c.numbers("verification.omega"))
    for (std::size_t i = 0; i + 1 < v.starts.size() && !interrupted; i += 2) {
      auto stay = s.stay;
      stay.omega = omega;
      const auto system = nielsen_kirkegaard(stay, stay_model(stay.cable, s.flow.coefficients), s.terms);
      const Eigen::Vector4d y(v.starts[i] + v.perturbation, v.starts[i + 1], 0.0, 0.0);
      const models::AveragedFlow averaged{flow, ansatz, [&](In u, double t) { return flow.motion(u, t); }};
      runs.push_back({omega, fmt::format("q1 = {:g}, q2 = {:g}", v.starts[i], v.starts[i + 1]),
                      models::modulation(system, averaged, Vector::Constant(1, omega), y, o)});
    }
  const ModulationLabels labels{{"q1", "q2"}, "m", 1};
  tell_modulations(file, context, labels, runs);
}

// Integrated runs and sweeps beside the branches; what did not settle.
std::vector<std::string> run_verification(const Configuration& c, const Setup& s, const SuperharmonicFlow& flow, const Network& net, ResultFile& file,
                                          RunContext& context) {
  const VerificationOptions o = verification_of(c, s);
  const auto omegas = c.has("verification.omega") ? c.numbers("verification.omega") : std::vector<double>{};
  std::vector<std::vector<AveragedState>> states;
  for (const double omega : omegas) {
    states.emplace_back();
    for (const auto& [branch, u] : net.solutions_at(omega))
      states.back().push_back({net.branches()[std::size_t(branch)].name, u, net.unstable_at(branch, u) == 0});
    int k = 0;
    for (const auto& state : states.back())
      write_averaged_orbit(file, fmt::format("/verification/averaged/{}-{}", frequency_label(omega), ++k), flow, state);
  }
  const auto runs = verify(flow, omegas, states, o, context);
  if (!runs.empty()) write_runs(file, runs, flow, s.flow.order);
  file.flush();
  context.progress.clear();
  if (!runs.empty()) context.print(fmt::format("\n{}", runs_text(runs, flow, s.flow.order)));
  std::vector<std::string> failures = not_settled(runs);
  report_runs(context.report, runs, flow, s.flow.order);
  run_modulations(c, s, flow, file, context);
  const int points = static_cast<int>(c.integer("verification.sweep_points"));
  if (points < 2 || interrupted) return failures;
  std::vector<double> up, down;
  for (int i = 0; i < points; ++i) up.push_back(s.network.walk.lower + (s.network.walk.upper - s.network.walk.lower) * i / (points - 1));
  down.assign(up.rbegin(), up.rend());
  std::vector<VerificationRun> swept[2];
  parallel_for(2, [&](std::size_t i) { swept[i] = sweep(i == 0 ? up : down, o, context); });
  write_sweep(file, "/verification/sweep_up", swept[0]);
  write_sweep(file, "/verification/sweep_down", swept[1]);
  file.flush();
  for (const int way : {0, 1})
    if (!interrupted && static_cast<int>(swept[way].size()) < points)
      failures.push_back(
          fmt::format("sweep {} ended early at {:g} rad/s: {}", way == 0 ? "up" : "down", swept[way].back().omega, swept[way].back().motion.why));
  return failures;
}

// Stable whirling orbits at one frequency for several damping pairs, averaged and integrated; what did not settle.
std::vector<std::string> run_orbits(const Configuration& c, const Setup& s, ResultFile& file, RunContext& context) {
  const auto& pairs = c.numbers("orbits.damping_pairs");
  if (pairs.empty()) return {};
  const double omega = c.number("orbits.omega");
  struct Case {
    std::string group;
    std::unique_ptr<SuperharmonicFlow> flow;
    AveragedState state;
    VerificationRun run;
    bool found = false;
  };
  std::vector<Case> cases(pairs.size() / 2);
  const VerificationOptions options = verification_of(c, s);
  parallel_for(cases.size(), [&](std::size_t i) {
    if (interrupted) return;
    Case& k = cases[i];
    auto o = options;
    o.stay.damping_out_of_plane = pairs[2 * i];
    o.stay.damping_in_plane = pairs[2 * i + 1];
    k.group = fmt::format("/orbits/pair{}", i + 1);
    k.flow = std::make_unique<SuperharmonicFlow>(o.stay, s.flow, std::vector{Lens("omega")});
    continuation::NetworkOptions network = s.network;
    Network net(*k.flow, network);
    for (const auto& x : coupled_states(k.flow->model().coefficients<double>(std::array<double, 1>{omega}))) {
      Vector u(5);
      u << x, omega;
      const NewtonResult r = newton(*k.flow, u);
      if (!r.ok()) continue;
      Matrix j(4, 5);
      k.flow->jacobian(r.x, j);
      const continuation::Blocks blocks = continuation::make_blocks(*k.flow, {});
      continuation::Spectrum spectrum(blocks);
      const bool stable = spectrum.compute(j) && spectrum.unstable() == 0;
      if (k.found && !stable) continue;
      k.state = {stable ? "stable whirling" : "unstable whirling", r.x, stable};
      k.found = true;
    }
    Vector y(4);
    if (k.found) y = k.flow->motion(k.state.u, 0.0);
    else y << 1.0, 1.0, 0.0, 0.0;
    o.settle.interrupted = &interrupted;
    auto stay = o.stay;
    stay.omega = omega;
    k.run = {omega, y, k.found ? "averaged state" : "q1 = q2 = 1", std::nullopt,
             settle(nielsen_kirkegaard(stay, stay_model(stay.cable, s.flow.coefficients), s.terms), y, o.settle)};
    context.progress.show(fmt::format("orbits: damping {:g}, {:g}", pairs[2 * i], pairs[2 * i + 1]));
  });
  std::vector<std::string> failures;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& k = cases[i];
    if (!k.flow) continue;
    if (k.found) write_averaged_orbit(file, k.group + "/averaged", *k.flow, k.state);
    write_motion(file, k.group + "/integrated", k.group + "/spectrum", k.run);
    file.attribute(k.group, "damping_out_of_plane", pairs[2 * i]);
    file.attribute(k.group, "damping_in_plane", pairs[2 * i + 1]);
    file.attribute(k.group, "omega", omega);
    for (const auto& failure : not_settled({k.run}))
      failures.push_back(fmt::format("orbits, damping {:g}, {:g}: {}", pairs[2 * i], pairs[2 * i + 1], failure));
  }
  file.flush();
  return failures;
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : check(c)) context.warn(w);
  const SuperharmonicFlow flow(s.stay, s.flow, {Lens(s.parameter)});
  const BranchOutput output = output_of(flow, s);
  ResultFile file(context.output);
  write_study(file, c);
  write_cable(file, context, s);
  Network net(flow, s.network);
  net.set_namer([](const Branch& b) { return b.active_reflections.empty() ? "W" : "IP"; });
  net.set_observer([&](const Branch& b, int i) {
    if (i % 50 == 0) context.progress.show(fmt::format("branch at {} = {:.6g}, {} points", s.parameter, b.parameter(i), i));
    return !interrupted;
  });
  net.on_branch([&](const Branch& b) {
    output.write_branch(file, b);
    file.flush();
  });
  explore(flow, s, net, context);
  output.write_special_points(file, net.branches());
  file.flush();
  context.progress.clear();
  output.report(context.report, net.branches());
  context.print(output.text(net.branches()));
  std::vector<std::string> failures;
  if (c.flag("verification.enabled") && !interrupted) {
    if (s.parameter == "omega") failures = run_verification(c, s, flow, net, file, context);
    else if (c.has("verification.omega"))
      context.warn("verification compares at frequencies: it is left out because continuation.parameter is not omega");
    if (!interrupted)
      for (auto& failure : run_orbits(c, s, file, context)) failures.push_back(std::move(failure));
  }
  return finish(file, context, net.branches(), failures);
}

}  // namespace

StudyKind superharmonic_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
