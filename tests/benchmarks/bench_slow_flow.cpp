// Averaged equations of any list of harmonics: residual with Jacobian, and a point of a branch, against the number of harmonics.
// Argument: harmonics H of the complete ansatz in both coordinates (nu = 1), 2 (2 H + 1) unknowns; 0: the combinatorial ansatz (60), 9 unknowns.
#include <benchmark/benchmark.h>

#include "continuation/network.hpp"
#include "models/slow_flow/combinatorial_printed.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

const StayParameters<double> stay{{260.0, 2.17e9, 5.5e6, 81.05, 30.4, 9.81}, 0.01, 0.01, 0.5, 2.1};

ParametricSystem system_of_stay() { return stay_system(stay, {Lens("omega")}, Terms::reduced, Coefficients::exact); }

SlowFlow flow_of(std::int64_t harmonics) {
  const Ansatz ansatz = harmonics > 0 ? Ansatz::complete(2, static_cast<int>(harmonics)) : Ansatz::combinatorial_coupled();
  return SlowFlow(system_of_stay(), ansatz, {{{-1, 1}, "WH"}});
}

Vector somewhere(const Problem& f) {
  Vector u(f.size() + 1);
  for (int i = 0; i < f.size(); ++i) u[i] = std::sin(1.7 + 2.9 * i) / (1.0 + 0.3 * i);
  u[f.size()] = 2.1;
  return u;
}

void linearise(benchmark::State& state, const Problem& f) {
  const Vector u = somewhere(f);
  Vector r(f.size());
  Matrix j(f.size(), f.size() + 1);
  for (auto _ : state) {
    f.linearise(u, r, j);
    benchmark::DoNotOptimize(j.data());
  }
  state.counters["unknowns"] = f.size();
}

void slow_flow_jacobian(benchmark::State& state) { linearise(state, flow_of(state.range(0))); }
BENCHMARK(slow_flow_jacobian)->Arg(0)->Arg(2)->Arg(4)->Arg(8)->Arg(15)->Arg(30)->Unit(benchmark::kMicrosecond);

void slow_flow_jacobian_by_duals(benchmark::State& state) {
  const SlowFlow flow = flow_of(state.range(0));
  linearise(state, DualProblem<SlowFlowModel>(flow.model(), flow.size(), 1, true));
}
BENCHMARK(slow_flow_jacobian_by_duals)->Arg(0)->Arg(8)->Unit(benchmark::kMicrosecond);

void harmonic_balance_jacobian(benchmark::State& state) {  // the same unknowns
  linearise(state, stay_harmonic_balance(stay, {Lens("omega")}, {.harmonics = static_cast<int>(state.range(0))}));
}
BENCHMARK(harmonic_balance_jacobian)->Arg(8)->Arg(15)->Unit(benchmark::kMicrosecond);

void printed_combinatorial_jacobian(benchmark::State& state) {
  linearise(state, PrintedCombinatorialFlow(system_of_stay(), CombinatorialMotion::coupled));
}
BENCHMARK(printed_combinatorial_jacobian)->Unit(benchmark::kMicrosecond);

void slow_flow_residual(benchmark::State& state) {
  const SlowFlow flow = flow_of(state.range(0));
  const Vector u = somewhere(flow);
  Vector r(flow.size());
  for (auto _ : state) {
    flow.residual(u, r);
    benchmark::DoNotOptimize(r.data());
  }
}
BENCHMARK(slow_flow_residual)->Arg(0)->Arg(8)->Arg(15)->Unit(benchmark::kMicrosecond);

// In-plane branch with eigenvalues of every point and all events located; 0: the coupled branch of the combinatorial ansatz.
void slow_flow_branch(benchmark::State& state) {
  const SlowFlow flow = flow_of(state.range(0));
  const bool combinatorial = state.range(0) == 0;
  continuation::WalkOptions options;
  options.lower = combinatorial ? 1.9 : 1.2;
  options.upper = combinatorial ? 2.3 : 2.0;
  const NewtonResult start = newton(flow, flow.linear_response(Vector::Constant(1, options.lower)), {.max_iterations = 50});
  continuation::Branch b = continuation::Walker(flow, options).walk(start.x);
  Vector origin = start.x, direction = Vector::Zero(flow.size() + 1);
  if (combinatorial) {
    origin = b.special.front().u;
    direction.head(flow.size()) = b.special.front().null_vector;
  }
  for (auto _ : state) {
    continuation::Walker walker(flow, options);
    b = combinatorial ? walker.walk_from(origin, direction, true) : walker.walk(origin);
  }
  state.counters["points"] = b.points();
  state.counters["time_per_point"] =
      benchmark::Counter(static_cast<double>(b.points()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(slow_flow_branch)->Arg(0)->Arg(2)->Arg(4)->Arg(8)->Arg(15)->Unit(benchmark::kMillisecond);

}  // namespace
