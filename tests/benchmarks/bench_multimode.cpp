// Cost of the N-mode cable against the number of modes: tensors, right-hand side, exact periodic point with multipliers.
#include <benchmark/benchmark.h>

#include "core/newton.hpp"
#include "models/multimode/cable_model.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

// Half the modes out of plane, half in plane.
CableModel cable(std::int64_t modes, Longitudinal longitudinal) {
  CableModel m{.stay = oresund(0.3, 1.5)};
  m.out_of_plane = lowest_half_waves(static_cast<int>(modes / 2));
  m.in_plane = lowest_half_waves(static_cast<int>(modes - modes / 2));
  m.longitudinal = longitudinal;
  return m;
}

Longitudinal of(std::int64_t i) { return i == 0 ? Longitudinal::galerkin : Longitudinal::quasi_static; }

void tensors(benchmark::State& state) {
  const CableModel m = cable(state.range(0), of(state.range(1)));
  std::size_t terms = 0;
  for (auto _ : state) terms = cable_equations(m).terms.size();
  state.counters["terms"] = static_cast<double>(terms);
}
BENCHMARK(tensors)->ArgNames({"modes", "quasi_static"})->ArgsProduct({{2, 4, 10, 20, 40}, {0, 1}})->Unit(benchmark::kMillisecond);

void right_hand_side(benchmark::State& state) {
  const auto system = cable_equations(cable(state.range(0), of(state.range(1))));
  std::vector<double> y(2 * system.stiffness.size(), 0.1), d(y.size());
  for (auto _ : state) {
    system.flow<double>(0.3, y, d);
    benchmark::DoNotOptimize(d.data());
  }
  state.counters["ns_per_term"] = benchmark::Counter(static_cast<double>(system.terms.size()) * 1e-9,
                                                     benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(right_hand_side)->ArgNames({"modes", "quasi_static"})->ArgsProduct({{2, 4, 10, 20, 40}, {0, 1}})->Unit(benchmark::kMicrosecond);

struct Orbit10 {
  HarmonicBalance balance;
  Vector start, planar;
  explicit Orbit10(const CableModel& m) : balance(cable_system(m, {Lens("omega")}), {.harmonics = 10, .reflections = cable_reflections(m)}) {
    const auto at = newton(balance, balance.linear_response(Vector::Constant(1, m.stay.omega)), {.max_iterations = 30});
    if (!at.ok()) throw std::runtime_error("no periodic motion");
    planar = at.x;
    start = planar;
    start[balance.size()] *= 1.003;  // a step of continuation
  }
};

void jacobian(benchmark::State& state) {
  const Orbit10 o(cable(state.range(0), of(state.range(1))));
  Matrix j(o.balance.size(), o.balance.size() + 1);
  Vector r(o.balance.size());
  for (auto _ : state) o.balance.linearise(o.planar, r, j);
}
BENCHMARK(jacobian)->ArgNames({"modes", "quasi_static"})->ArgsProduct({{2, 4, 10, 20}, {0, 1}})->Unit(benchmark::kMillisecond);

void multipliers(benchmark::State& state, bool coupled) {
  const Orbit10 o(cable(state.range(0), of(state.range(1))));
  Vector u = o.planar;
  if (coupled) u[o.balance.index(0, 1)] += 1e-3;  // not planar any more: one block
  const auto system = o.balance.system_at(u);
  Floquet floquet(system, 10, 1);
  int steps = 0;
  for (auto _ : state) steps = floquet.compute(system, u.head(o.balance.size())).steps;
  state.counters["steps"] = steps;
}
BENCHMARK_CAPTURE(multipliers, planar, false)
    ->ArgNames({"modes", "quasi_static"})
    ->ArgsProduct({{2, 4, 10, 20}, {0, 1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(multipliers, whirling, true)
    ->ArgNames({"modes", "quasi_static"})
    ->ArgsProduct({{2, 4, 10, 20}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

/// Newton from a step away, then multipliers: what one point of a branch costs.
void periodic_point(benchmark::State& state) {
  const Orbit10 o(cable(state.range(0), of(state.range(1))));
  const auto system = o.balance.system_at(o.planar);
  Floquet floquet(system, 10, 1);
  int iterations = 0;
  for (auto _ : state) {
    const auto at = newton(o.balance, o.start);
    iterations = at.iterations;
    benchmark::DoNotOptimize(floquet.compute(o.balance.system_at(at.x), at.x.head(o.balance.size())).multipliers.data());
  }
  state.counters["newton"] = iterations;
}
BENCHMARK(periodic_point)->ArgNames({"modes", "quasi_static"})->ArgsProduct({{2, 4, 10, 20}, {0, 1}})->Unit(benchmark::kMillisecond);

}  // namespace
