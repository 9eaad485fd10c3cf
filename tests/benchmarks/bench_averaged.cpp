// Cost of the averaged problem, per point and per part. Compare ratios within one run: machines are noisy.
#include <benchmark/benchmark.h>

#include "continuation/network.hpp"
#include "continuation/two_parameter.hpp"
#include "models/closed_forms.hpp"
#include "models/steady_motion.hpp"
#include "models/superharmonic.hpp"

using namespace whirl;
using namespace whirl::models;
using namespace whirl::continuation;

namespace {

const StayParameters<double> stay{{260.0, 2.17e9, 5.5e6, 81.05, 30.4, 9.81}, 0.01, 0.01, 0.5, 1.8};

struct Oresund {
  SuperharmonicFlow flow{stay, {.order = 2}, {Lens("omega")}};
  WalkOptions options = [] {
    WalkOptions o;
    o.lower = 1.2;
    o.upper = 2.4;
    return o;
  }();
  Vector start = Vector::Zero(5);
  Branch planar;
  Oresund() {
    start.head(4) = in_plane_states(flow.model().coefficients<double>(std::array<double, 1>{1.2})).front();
    start[4] = 1.2;
    planar = Walker(flow, options).walk(start);
  }
};

void report(benchmark::State& state, const Branch& b) {
  double iterations = 0.0;
  for (int i = 0; i < b.points(); ++i) iterations += b.iterations(i);
  state.counters["points"] = b.points();
  state.counters["newton_per_point"] = iterations / b.points();
  state.counters["time_per_point"] =
      benchmark::Counter(static_cast<double>(b.points()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["points_per_second"] = benchmark::Counter(static_cast<double>(b.points()), benchmark::Counter::kIsIterationInvariantRate);
}

void planar_branch(benchmark::State& state) {
  Oresund o;
  Branch b;
  for (auto _ : state) b = Walker(o.flow, o.options).walk(o.start);
  report(state, b);
}
BENCHMARK(planar_branch)->Unit(benchmark::kMicrosecond);

void whirling_branch(benchmark::State& state) {  // 3 folds, 2 Hopf points, 1 branch point located; argument 0: none located
  Oresund o;
  const auto& bp = o.planar.special.front();
  Vector direction = Vector::Zero(5);
  direction.head(4) = bp.null_vector;
  o.options.locate_events = state.range(0) != 0;
  if (!o.options.locate_events) o.options.max_points = 180;
  Branch b;
  for (auto _ : state) b = Walker(o.flow, o.options).walk_from(bp.u, direction, true);
  report(state, b);
}
BENCHMARK(whirling_branch)->Arg(1)->Arg(0)->Unit(benchmark::kMicrosecond);

void threshold_chart(benchmark::State& state) {  // the curve of whirling points in (omega, U), with its codimension-2 points
  Oresund o;
  const SuperharmonicFlow flow2(stay, {.order = 2}, {Lens("omega"), Lens("support_amplitude")});
  TwoParameterOptions t;
  t.range1[0] = 1.2;
  t.range1[1] = 2.8;
  t.range2[0] = 0.05;
  t.range2[1] = 0.8;
  DefiningCurve c;
  for (auto _ : state) c = follow(flow2, o.planar.special.front(), 0.5, t);
  state.counters["points"] = static_cast<double>(c.u.cols());
}
BENCHMARK(threshold_chart)->Unit(benchmark::kMillisecond);

// A dense problem of 200 unknowns, x' = K x + p e^x with all neighbours coupled: a point against the LU and the eigenvalues it cannot do without.
struct Dense200 {
  static constexpr std::size_t n = 200;
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    using std::exp;
    S mean(0.0);
    for (std::size_t i = 0; i < n; ++i) mean += u[i] * (1.0 / n);
    for (std::size_t i = 0; i < n; ++i) {
      const S left = i > 0 ? u[i - 1] : S(0.0), right = i + 1 < n ? u[i + 1] : S(0.0);
      r[i] = left - 2.0 * u[i] + right + 0.01 * mean + 1e-4 * u[n] * S(exp(u[i]));
    }
  }
};

void dense_200_walk(benchmark::State& state) {
  const DualProblem<Dense200> f({}, 200, 1, true);
  WalkOptions o;
  o.lower = 0.0;
  o.upper = 0.2;
  Branch b;
  for (auto _ : state) b = Walker(f, o).walk(Vector::Zero(201));
  report(state, b);
}
BENCHMARK(dense_200_walk)->Unit(benchmark::kMillisecond);

void dense_200_part(benchmark::State& state) {  // 0: Jacobian, 1: LU, 2: eigenvalues
  const DualProblem<Dense200> f({}, 200, 1, true);
  const Vector u = Vector::Constant(201, 0.1);
  Matrix j(200, 201);
  Vector r(200);
  f.linearise(u, r, j);
  const Matrix a = j.leftCols(200);
  for (auto _ : state) {
    if (state.range(0) == 0) f.linearise(u, r, j);
    if (state.range(0) == 1) benchmark::DoNotOptimize(Eigen::PartialPivLU<Matrix>(a).matrixLU().data());
    if (state.range(0) == 2) benchmark::DoNotOptimize(Eigen::EigenSolver<Matrix>(a, false).eigenvalues().data());
  }
}
BENCHMARK(dense_200_part)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

void jacobian(benchmark::State& state) {
  Oresund o;
  Vector r(4);
  Matrix j(4, 5);
  for (auto _ : state) {
    o.flow.linearise(o.start, r, j);
    benchmark::DoNotOptimize(j.data());
  }
}
BENCHMARK(jacobian);

void jacobian_by_duals(benchmark::State& state) {
  Oresund o;
  const DualProblem<SuperharmonicModel> dual(SuperharmonicModel(stay, {.order = 2}, {Lens("omega")}), 4, 1, true);
  Vector r(4);
  Matrix j(4, 5);
  for (auto _ : state) {
    dual.linearise(o.start, r, j);
    benchmark::DoNotOptimize(j.data());
  }
}
BENCHMARK(jacobian_by_duals);

void eigenvalues(benchmark::State& state) {  // argument 1: planar point, two 2 x 2 blocks; 0: the whole 4 x 4
  Oresund o;
  Vector u = o.start;
  const bool planar = state.range(0) != 0;
  if (!planar) u.head(4) = coupled_states(o.flow.model().coefficients<double>(std::array<double, 1>{1.8})).front();
  Matrix j(4, 5);
  o.flow.jacobian(u, j);
  const Blocks blocks = make_blocks(o.flow, planar ? std::vector<int>{0} : std::vector<int>{});
  Spectrum spectrum(blocks);
  for (auto _ : state) benchmark::DoNotOptimize(spectrum.compute(j));
}
BENCHMARK(eigenvalues)->Arg(1)->Arg(0);

void cvode_period(benchmark::State& state) {
  auto s = stay;
  s.omega = 1.65;
  const auto system = nielsen_kirkegaard(s, stay_model(s.cable, Coefficients::exact), Terms::reduced);
  const auto m = settle(system, Eigen::Vector4d(1.0, 1.0, 0.0, 0.0));
  const double period = 2.0 * pi / s.omega;
  Integrator run([&](double t, std::span<const double> y, std::span<double> d) { system.flow<double>(system.omega * t, y, d); }, 0.0, m.state,
                 {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12});
  int k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(run.advance(++k * period));
}
BENCHMARK(cvode_period)->Unit(benchmark::kMicrosecond);

}  // namespace
