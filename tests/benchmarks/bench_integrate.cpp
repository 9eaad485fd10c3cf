// Time integration of the Oresund stay: the explicit integrators of Boost.odeint beside CVODE in one run, and starts per second of a basin map.
// Compare ratios within one run: machines are noisy. `error` is that of one period against a run at 1e-14.
#include <benchmark/benchmark.h>

#include <boost/numeric/odeint/stepper/runge_kutta_cash_karp54.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>

#include "core/cvode.hpp"
#include "core/explicit_integrator.hpp"
#include "models/basins.hpp"
#include "models/nielsen_kirkegaard.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

using State = std::array<double, 4>;

ModalSystem<double> oresund(double omega) {
  const StayParameters<double> stay{{260.0, 2.17e9, 5.5e6, 81.05, 30.4, 9.81}, 0.01, 0.01, 0.5, omega};
  return nielsen_kirkegaard(stay, stay_model(stay.cable, Coefficients::exact), Terms::reduced);
}
const double period = 2.0 * pi / 1.65;
const State start{1.1179, 1.6146, -6.6346, 3.5477};  // on the whirling motion at 1.65 rad/s

struct Flow {
  FlatFlow flow{oresund(1.65)};
  void operator()(const State& y, State& d, double t) const { flow(t, y.data(), d.data()); }
};

const State& reference() {
  static const State end = [] {
    ExplicitIntegrator<State, Flow> run(Flow{}, {.relative_tolerance = 1e-14, .absolute_tolerance = 1e-15});
    run.restart(0.0, start);
    (void)run.advance(period);
    return run.state();
  }();
  return end;
}
double error(const State& y) {
  double e = 0.0;
  for (std::size_t i = 0; i < 4; ++i) e = std::max(e, std::abs(y[i] - reference()[i]));
  return e;
}
double tolerance(const benchmark::State& state) { return std::pow(10.0, -static_cast<double>(state.range(0))); }

template <class Stepper>
void explicit_period(benchmark::State& state) {  // argument: -log10 of the relative tolerance
  ExplicitIntegrator<State, Flow, Stepper> run(Flow{}, {.relative_tolerance = tolerance(state), .absolute_tolerance = 0.01 * tolerance(state)});
  for (auto _ : state) {
    run.restart(0.0, start);
    benchmark::DoNotOptimize(run.advance(period));
  }
  state.counters["error"] = error(run.state());
  state.counters["steps"] = static_cast<double>(run.steps()) / static_cast<double>(state.iterations());
}
BENCHMARK_TEMPLATE(explicit_period, Fehlberg78<State>)->Arg(6)->Arg(8)->Arg(10)->Arg(12)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(explicit_period, boost::numeric::odeint::runge_kutta_dopri5<State>)->Arg(6)->Arg(8)->Arg(10)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(explicit_period, boost::numeric::odeint::runge_kutta_cash_karp54<State>)->Arg(6)->Arg(8)->Arg(10)->Unit(benchmark::kMicrosecond);

void cvode(benchmark::State& state, bool stiff) {
  const auto system = oresund(1.65);
  const Vector y0 = Eigen::Map<const Eigen::Vector4d>(start.data());
  Integrator run([&](double t, std::span<const double> y, std::span<double> d) { system.flow<double>(system.omega * t, y, d); }, 0.0, y0,
                 {.relative_tolerance = tolerance(state), .absolute_tolerance = 0.01 * tolerance(state), .stiff = stiff});
  State end{};
  for (auto _ : state) {
    run.restart(0.0, y0);
    benchmark::DoNotOptimize(run.advance(period));
  }
  for (std::size_t i = 0; i < 4; ++i) end[i] = run.state()[static_cast<Eigen::Index>(i)];
  state.counters["error"] = error(end);
}
void cvode_adams(benchmark::State& state) { cvode(state, false); }
void cvode_bdf(benchmark::State& state) { cvode(state, true); }
BENCHMARK(cvode_adams)->Arg(6)->Arg(8)->Arg(10)->Arg(12)->Unit(benchmark::kMicrosecond);
BENCHMARK(cvode_bdf)->Arg(8)->Arg(10)->Unit(benchmark::kMicrosecond);

void right_hand_side(benchmark::State& state) {  // argument 1: flat list, 0: the modal system's own
  const auto system = oresund(1.65);
  const FlatFlow flat(system);
  State y = start, d{};
  double t = 0.0;
  for (auto _ : state) {
    t += 1e-3;
    if (state.range(0) != 0) flat(t, y.data(), d.data());
    else system.flow<double>(system.omega * t, y, d);
    benchmark::DoNotOptimize(d);
  }
}
BENCHMARK(right_hand_side)->Arg(1)->Arg(0);

void monodromy(benchmark::State& state) {
  Stroboscope strobe(oresund(1.65), {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12});
  Matrix m;
  for (auto _ : state) {
    Vector y = Eigen::Map<const Eigen::Vector4d>(start.data());
    benchmark::DoNotOptimize(strobe.map(y, m));
  }
}
BENCHMARK(monodromy)->Unit(benchmark::kMicrosecond);

void basin_map(benchmark::State& state) {  // argument: starts along an axis; 2.15 rad/s, q1 and q2 from -12 to 12 m
  const auto system = oresund(2.15);
  Vector signs(4);
  signs << -1, 1, -1, 1;
  BasinOptions o;
  o.x = {0, -12, 12, static_cast<int>(state.range(0))};
  o.y = {1, -12, 12, static_cast<int>(state.range(0))};
  o.base = Vector::Zero(4);
  o.check_share = 0.02;
  o.settle.transient = {.relative_tolerance = 1e-8, .absolute_tolerance = 1e-10};
  BasinMap map;
  for (auto _ : state) map = basins(system, {{signs, "WH"}}, o);
  state.counters["disagreed"] = static_cast<double>(map.disagreed);
  state.counters["periods"] = map.periods.cast<double>().mean();
  state.counters["per_start"] =
      benchmark::Counter(static_cast<double>(map.integrated), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["starts_per_second"] = benchmark::Counter(static_cast<double>(map.integrated), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(basin_map)->Arg(60)->Arg(200)->Unit(benchmark::kSecond)->UseRealTime()->Iterations(1)->MeasureProcessCPUTime();

}  // namespace
