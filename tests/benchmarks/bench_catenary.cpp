// Cost of hanging-cable frequencies, sweeps and forced motion. Compare ratios within one run: machines are noisy.
#include <benchmark/benchmark.h>

#include "core/memory.hpp"
#include "core/parallel.hpp"
#include "models/catenary/forced.hpp"
#include "models/catenary/gale_series.hpp"
#include "models/catenary/geometry.hpp"
#include "models/catenary/veering.hpp"

using namespace whirl;
using namespace whirl::models::catenary;

namespace {

const bool as_the_program_does = (keep_freed_memory(), true);

CoreCable cable(double m, double h, double kappa) {
  const Geometry g = unit_geometry(m, h);
  return {.x1 = g.x1, .x2 = g.x2, .kappa = kappa};
}

// Arguments: 100 b/2a, 100 h/b, elastic, count by inertia.
void first_eight(benchmark::State& state) {
  const CoreCable c = cable(0.01 * double(state.range(0)), 0.01 * double(state.range(1)), state.range(2) ? 1e-3 : 0.0);
  const ModeOptions options{.count = 8, .verify = state.range(3) != 0};
  ModeSet set;
  for (auto _ : state) benchmark::DoNotOptimize(set = in_plane_modes(c, options));
  state.counters["functions"] = set.functions;
}
BENCHMARK(first_eight)->ArgsProduct({{10, 100, 200, 350}, {0, 50}, {0, 1}, {0, 1}})->Unit(benchmark::kMillisecond);

void sweep_thousand(benchmark::State& state) {  // geometries, first 8 modes each; argument: elastic
  std::vector<double> first(1000);
  for (auto _ : state)
    parallel_for(first.size(), [&](std::size_t i) {
      const Geometry g = unit_geometry(half_width_of(0.5 + 0.48 * double(i) / 999.0), 0.5);
      const CoreCable c{.x1 = g.x1, .x2 = g.x2, .kappa = state.range(0) ? 1e-3 : 0.0};
      first[i] = in_plane_modes(c, {.count = 8, .shapes = false, .verify = false}).modes[0].omega;
    });
}
BENCHMARK(sweep_thousand)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();

void hundred_modes(benchmark::State& state) {
  const CoreCable c = cable(1.0, 0.5, state.range(0) ? 1e-3 : 0.0);
  bool complete = false;
  for (auto _ : state) complete = in_plane_modes(c, {.count = 100}).complete();
  state.counters["complete"] = complete;
}
BENCHMARK(hundred_modes)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void damped_eight(benchmark::State& state) {
  CoreCable c = cable(1.0, 0.5, 1e-3);
  c.eta1 = 0.05;
  c.eta2 = 0.5;
  for (auto _ : state) benchmark::DoNotOptimize(damped_modes(c, {.count = 8, .shapes = false}));
}
BENCHMARK(damped_eight)->Unit(benchmark::kMillisecond);

void forced_frequency(benchmark::State& state) {  // one frequency of a resonance diagram; argument: elastic
  CoreCable c = cable(0.8, 0.5, state.range(0) ? 1e-3 : 0.0);
  c.eta2 = 0.1;
  const ForcedSolver solver(c, 10.0);
  const PeakFinder peaks(solver.mesh());
  double w = 0.1;
  for (auto _ : state) {
    w = w > 9.9 ? 0.1 : w + 0.013;
    benchmark::DoNotOptimize(peaks.largest(solver.at(w, {.U2 = 0.01}).in_plane, Quantity::T));
  }
  state.counters["functions"] = solver.functions();
}
BENCHMARK(forced_frequency)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

void crossing(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(closest_approaches(-0.3, 0.3, 5e-3, 2e-2, 2, 10));
}
BENCHMARK(crossing)->Unit(benchmark::kMillisecond);

void series_eight(benchmark::State& state) {
  const Geometry g = unit_geometry(half_width_of(0.85), 0.5);
  for (auto _ : state) benchmark::DoNotOptimize(series_modes(g.x1, g.x2, 8, Plane::in_plane));
}
BENCHMARK(series_eight)->Unit(benchmark::kMillisecond);

}  // namespace
