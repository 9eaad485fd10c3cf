// Cost of exact periodic motions of the two-mode stay: one point's parts, and a walk with multipliers, events and all (time divided by points).
#include <benchmark/benchmark.h>

#include <Eigen/LU>

#include "continuation/orbit_network.hpp"
#include "core/newton.hpp"
#include "models/harmonic_balance.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;
using namespace whirl::continuation;

namespace {

HarmonicBalance balance(int harmonics) { return stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = harmonics}); }

void jacobian(benchmark::State& state) {
  const HarmonicBalance hb = balance(static_cast<int>(state.range(0)));
  const Vector u = newton(hb, hb.linear_response(Vector::Constant(1, 1.3))).x;
  Vector r(hb.size());
  Matrix j(hb.size(), hb.size() + 1);
  for (auto _ : state) hb.linearise(u, r, j);
}
BENCHMARK(jacobian)->Arg(8)->Arg(15)->Arg(30);

void factorisation(benchmark::State& state) {
  const HarmonicBalance hb = balance(static_cast<int>(state.range(0)));
  Matrix j(hb.size(), hb.size() + 1);
  hb.jacobian(newton(hb, hb.linear_response(Vector::Constant(1, 1.3))).x, j);
  Eigen::PartialPivLU<Matrix> lu(hb.size());
  for (auto _ : state) lu.compute(j.leftCols(hb.size()));
}
BENCHMARK(factorisation)->Arg(8)->Arg(15)->Arg(30);

void multipliers(benchmark::State& state) {
  const HarmonicBalance hb = balance(static_cast<int>(state.range(0)));
  const Vector u = newton(hb, hb.linear_response(Vector::Constant(1, 1.3))).x;
  for (auto _ : state) benchmark::DoNotOptimize(hb.floquet(u).error);
}
BENCHMARK(multipliers)->Arg(8)->Arg(15)->Arg(30);

// The in-plane branch and the whirling branch over [1.4, 2.0] rad/s; range(1): events located or not.
void walk(benchmark::State& state) {
  const HarmonicBalance hb = balance(static_cast<int>(state.range(0)));
  NetworkOptions o;
  o.walk.lower = 1.4;
  o.walk.upper = 2.0;
  o.walk.locate_events = state.range(1) != 0;
  const Vector start = newton(hb, hb.linear_response(Vector::Constant(1, 1.4))).x;
  int points = 0;
  double truncation = 0.0;
  for (auto _ : state) {
    OrbitNetwork net(hb, o, 0);
    net.add_seed(start, "start");
    net.switch_branches();
    points = 0;
    for (const auto& b : net.network(0).branches()) points += b.points();
    state.PauseTiming();
    for (const auto& b : net.network(0).branches())
      for (int i = 0; i < b.points(); i += 10) truncation = std::max(truncation, hb.truncation(b.u(i), b.tangent(i)).error);
    state.ResumeTiming();
  }
  state.counters["points"] = points;
  state.counters["truncation"] = truncation;
  state.counters["us_per_point"] = benchmark::Counter(1e-6 * points, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(walk)->Args({15, 0})->Args({15, 1})->Args({20, 1})->Unit(benchmark::kMillisecond);

}  // namespace
