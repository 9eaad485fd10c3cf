#include "models/dynamics/periodic/settle_on_cycle.hpp"

#include "core/explicit_integrator.hpp"

namespace whirl::models {
namespace {

using State = std::vector<double>;

struct Field {
  const Problem* flow;
  Vector u, f;
  void operator()(const State& x, State& dx, double) {
    u.head(flow->size()) = Eigen::Map<const Vector>(x.data(), flow->size());
    flow->residual(u, f);
    Eigen::Map<Vector>(dx.data(), flow->size()) = f;
  }
};

constexpr int looks = 4000;  // instants of a second stretch as long as the transient at which the plane is looked at
constexpr int bisections = 60;
constexpr double at_rest = 1e-9;  // of the size of the state: such a motion is an equilibrium

}  // namespace

std::optional<FlowCycle> settle_on_cycle(const Problem& flow, const Vector& x0, const Vector& p, const SettleOnCycleOptions& options) {
  const int n = flow.size();
  Field field{&flow, Vector(n + flow.parameters()), Vector(n)};
  field.u.tail(flow.parameters()) = p;
  ExplicitIntegrator<State, Field> run(field,
                                       {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-13 * std::max(1e-6, x0.norm()), .first_step = 1e-3});
  const auto vector = [&](const State& x) { return Vector(Eigen::Map<const Vector>(x.data(), n)); };
  run.restart(0.0, State(x0.data(), x0.data() + n));
  if (!run.advance(options.transient)) return std::nullopt;
  const Vector start = vector(run.state());
  Vector u(n + flow.parameters()), normal(n);
  u << start, p;
  flow.residual(u, normal);
  const auto height = [&](const State& x) { return normal.dot(vector(x) - start); };
  double size = 0.0;
  int returns = 0;
  State before = run.state();
  double t_before = options.transient;
  for (int i = 1; i <= looks; ++i) {
    const double t = options.transient * (1.0 + static_cast<double>(i) / looks);
    if (!run.advance(t)) return std::nullopt;
    const State now = run.state();
    size = std::max(size, (vector(now) - start).norm());
    if (height(before) < 0.0 && height(now) >= 0.0) {
      double low = t_before, high = t;
      State at = before;
      for (int k = 0; k < bisections && high - low > 1e-14 * high; ++k) {
        const double middle = 0.5 * (low + high);
        run.restart(low, at);
        if (!run.advance(middle)) return std::nullopt;
        if (height(run.state()) < 0.0) {
          low = middle;
          at = run.state();
        } else {
          high = middle;
        }
      }
      ++returns;
      if (size < at_rest * (1.0 + start.norm())) return std::nullopt;
      if ((vector(at) - start).norm() < options.same * size) {
        FlowCycle cycle{low - options.transient, Matrix(n, options.samples)};
        run.restart(0.0, State(start.data(), start.data() + n));
        for (int k = 0; k < options.samples; ++k) {
          if (!run.advance(cycle.period * k / options.samples)) return std::nullopt;
          cycle.x.col(k) = vector(run.state());
        }
        return cycle;
      }
      if (returns >= options.most_returns) return std::nullopt;
      run.restart(t, now);
    }
    before = now;
    t_before = t;
  }
  return std::nullopt;
}

}  // namespace whirl::models
