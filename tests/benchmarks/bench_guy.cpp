// Cost of guys: a static state, a stiffness curve of 2000 frequencies, its parts. Compare ratios within one run: machines are noisy.
#include <benchmark/benchmark.h>

#include <vector>

#include "models/guy/closed_stiffness.hpp"
#include "models/guy/collocation.hpp"
#include "models/guy/linear_guy.hpp"
#include "models/guy/mode_count.hpp"
#include "models/guy/tangent.hpp"

using namespace whirl::models::guy;

namespace {

// The Oklahoma City guy of [Sarvi1968], in SI.
Statics rest() {
  const Guy g{.horizontal_span = 289.56,
              .rise = 411.1752,
              .axial_stiffness = 2.5835271141432983e8,
              .mass_per_length = 13.393495705321765,
              .gravity = 9.8066352};
  return at_horizontal_tension(g, 157022.22301869563);
}

constexpr double highest = 9.4;  // rad/s: ten and a half times the string's first frequency

std::vector<double> frequencies() {
  std::vector<double> p;
  for (int i = 1; i <= 2000; ++i) p.push_back(highest * i / 2000.0);
  return p;
}

void stiffness_curve(
    benchmark::State& state) {  // from the static state to 2000 values of the dynamic modulus; argument: highest frequency over 9.4 rad/s
  const Statics s = rest();
  auto p = frequencies();
  for (double& w : p) w *= static_cast<double>(state.range(0));
  std::vector<std::complex<double>> k(p.size());
  int degree = 0;
  for (auto _ : state) {
    const LinearGuy guy(s, p.back());
    guy.modulus(Direction::horizontal, p, 0.009, k);
    benchmark::DoNotOptimize(k.data());
    degree = guy.degree();
  }
  state.counters["degree"] = degree;
}
BENCHMARK(stiffness_curve)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);

void eigenproblem(benchmark::State& state) {
  const Statics s = rest();
  for (auto _ : state) benchmark::DoNotOptimize(LinearGuy(s, highest).degree());
}
BENCHMARK(eigenproblem)->Unit(benchmark::kMillisecond);

void full_matrix_one_frequency(benchmark::State& state) {
  const LinearGuy guy(rest(), highest);
  for (auto _ : state) benchmark::DoNotOptimize(guy.stiffness(3.14, 0.009));
}
BENCHMARK(full_matrix_one_frequency)->Unit(benchmark::kMicrosecond);

void collocation_one_frequency(benchmark::State& state) {
  const Statics s = rest();
  for (auto _ : state) benchmark::DoNotOptimize(collocated_stiffness(s, 3.14, 0.009, 48));
}
BENCHMARK(collocation_one_frequency)->Unit(benchmark::kMicrosecond);

void closed_forms_2000(benchmark::State& state) {
  const ClosedStiffness closed(rest());
  const auto p = frequencies();
  const auto form = all_closed_forms[static_cast<std::size_t>(state.range(0))];
  for (auto _ : state)
    for (const double w : p) benchmark::DoNotOptimize(closed.modulus(form, w, 0.009));
  state.SetLabel(std::string(to_string(form)));
}
BENCHMARK(closed_forms_2000)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);

void mode_count(benchmark::State& state) {
  const Statics s = rest();
  for (auto _ : state) benchmark::DoNotOptimize(modes_below(s, Plane::in_plane, highest));
}
BENCHMARK(mode_count)->Unit(benchmark::kMicrosecond);

void static_state(benchmark::State& state) {  // unstressed length known: a point of the curve H(l)
  const Statics s = rest();
  Guy g = s.guy;
  g.horizontal_span += 0.3;
  for (auto _ : state) benchmark::DoNotOptimize(solve(g, Known::unstressed_length, s.unstressed_length, s.form));
}
BENCHMARK(static_state)->Unit(benchmark::kMicrosecond);

}  // namespace
