#include "studies/cycle_branches.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <numbers>

#include "core/newton.hpp"
#include "models/dynamics/periodic/settle_on_cycle.hpp"

namespace whirl::studies {

using namespace continuation;
using namespace models;

namespace {

constexpr double end_part = 0.2;          // of the start's first harmonic: where a family that shrinks ends
constexpr double motion_end_part = 0.01;  // the same of a family met by integration, whose start is large
constexpr double same_period = 1e-7;
constexpr double near_hopf = 0.01;        // of range and period: an end this near a Hopf point is at it
constexpr int most_tries = 14;            // of an amplitude for the first cycle
constexpr double first_amplitude = 1e-3;  // of the size of the equilibrium: the first try
constexpr double shift_window = 30.0;     // a start is taken if it moves the parameter by start_shift up to this factor either way

/// The cycle of a given first harmonic, the parameter unknown: A and p change places.
class AtAmplitude : public Problem {
 public:
  explicit AtAmplitude(const LimitCycle& cycle) : Problem(cycle.size(), 1, false), cycle_(cycle) {}
  Vector swapped(Vector u) const {
    std::swap(u[LimitCycle::first_harmonic], u[size()]);
    return u;
  }

 private:
  void do_residual(In u, Out r) const override { cycle_.residual(swapped(u), r); }
  void do_jacobian(In u, MatrixOut j) const override {
    cycle_.jacobian(swapped(u), j);
    j.col(LimitCycle::first_harmonic).swap(j.col(size()));
  }
  void do_linearise(In u, Out r, MatrixOut j) const override {
    cycle_.linearise(swapped(u), r, j);
    j.col(LimitCycle::first_harmonic).swap(j.col(size()));
  }
  const LimitCycle& cycle_;
};

Eigen::VectorXcd critical_vector(const Problem& flow, const SpecialPoint& hopf) {
  const int n = flow.size();
  Matrix j(n, n + 1);
  flow.jacobian(hopf.u, j);
  const Eigen::EigenSolver<Matrix> solver(Matrix(j.leftCols(n)));
  const Eigen::VectorXcd values = solver.eigenvalues();
  Eigen::Index best = 0;
  (values.array() - std::complex<double>(0.0, hopf.frequency)).abs().minCoeff(&best);
  return solver.eigenvectors().col(best).normalized();
}

}  // namespace

CycleEnd CycleFamily::end(In u, int level) const {
  if (level == 0 && u[LimitCycle::first_harmonic] <= 1.000001 * least_harmonic) return CycleEnd::equilibrium;
  if (u[LimitCycle::log_period] >= std::log(longest_period) - 1e-9) return CycleEnd::long_period;
  return CycleEnd::other;
}

CycleBranches::CycleBranches(const Problem& flow, CycleOptions options) : flow_(flow), options_(std::move(options)) {}

// A cycle of small amplitude: the parameter moves with its square, so that the amplitude is set right in a few tries whatever the units.
Vector CycleBranches::start(const LimitCycle& cycle, const SpecialPoint& hopf) const {
  const int n = flow_.size();
  const double range = options_.network.walk.upper - options_.network.walk.lower, period = 2.0 * std::numbers::pi / hopf.frequency;
  const Eigen::VectorXcd q = critical_vector(flow_, hopf);
  const AtAmplitude problem(cycle);
  double amplitude = first_amplitude * std::max(hopf.u.head(n).norm(), 1e-3 * range);
  Vector best;
  double best_factor = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most_tries; ++i) {
    const auto orbit = [&](double s) { return Vector(hopf.u.head(n) + amplitude * (q * std::polar(1.0, 2.0 * std::numbers::pi * s)).real()); };
    const Vector guess = cycle.guess(orbit, period, hopf.u.tail(1));
    const NewtonResult at = newton(problem, problem.swapped(guess), {.tolerance = 1e-11, .max_iterations = 20});
    const double shift = std::abs(at.x[LimitCycle::first_harmonic] - hopf.u[n]) / range;
    const bool a_cycle = at.ok() && std::abs(at.x[LimitCycle::log_period] - std::log(period)) < 0.5;
    if (!a_cycle) {
      amplitude *= 0.1;
      continue;
    }
    const double factor = options_.start_shift / std::max(shift, 1e-14);
    if (std::abs(std::log(factor)) < best_factor) {
      best_factor = std::abs(std::log(factor));
      best = problem.swapped(at.x);
    }
    if (best_factor < std::log(shift_window)) break;
    amplitude *= std::clamp(std::sqrt(factor), 0.05, 20.0);
  }
  return best;
}

bool CycleBranches::ends_at(const SpecialPoint& hopf) const {
  const int n = flow_.size();
  const double range = options_.network.walk.upper - options_.network.walk.lower;
  for (const auto& family : families_)
    for (const Branch& b : family->net->network(0).branches())
      for (const int i : {0, b.points() - 1}) {
        const Vector u = b.u(i);
        if (family->end(u, 0) != CycleEnd::equilibrium) continue;
        const double apart = std::abs(u[u.size() - 1] - hopf.u[n]) / range;
        if (apart < near_hopf && std::abs(std::exp(u[LimitCycle::log_period]) * hopf.frequency / (2.0 * std::numbers::pi) - 1.0) < near_hopf)
          return true;
      }
  return false;
}

std::string CycleBranches::add_hopf(const SpecialPoint& hopf, const std::string& origin) {
  if (ends_at(hopf)) return "a family met before ends there";
  auto family = std::make_unique<CycleFamily>();
  family->origin = origin;
  family->hopf = hopf.u;
  const Eigen::VectorXcd q = critical_vector(flow_, hopf);
  Eigen::Index most = 0;
  q.cwiseAbs().maxCoeff(&most);
  family->single = std::make_unique<LimitCycle>(flow_, Vector::Unit(flow_.size(), most), options_.cycle);
  const Vector u0 = start(*family->single, hopf);
  if (u0.size() == 0) return "no cycle was found beside it";
  const double period = 2.0 * std::numbers::pi / hopf.frequency;
  family->least_harmonic = end_part * u0[LimitCycle::first_harmonic];
  family->longest_period = options_.longest_period > 0.0 ? options_.longest_period : options_.longest_multiple * period;
  return follow(std::move(family), u0);
}

std::string CycleBranches::follow(std::unique_ptr<CycleFamily> family, const Vector& u0) {
  NetworkOptions network = options_.network;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  network.walk.bounds.push_back({LimitCycle::first_harmonic, family->least_harmonic, infinity});
  network.walk.bounds.push_back({LimitCycle::log_period, -infinity, std::log(family->longest_period)});
  family->net = std::make_unique<OrbitNetwork>(*family->single, network, options_.period_doublings);
  family->net->set_namer([number = families_.size() + 1](const Branch&, int level) {
    const std::string doubled = level == 0 ? "" : level == 1 ? "D" : fmt::format("P{}", 1 << level);
    return fmt::format("C{}{}.", number, doubled);
  });
  if (observer_) family->net->set_observer(observer_);
  CycleFamily& kept = *families_.emplace_back(std::move(family));
  kept.net->on_branch([this, &kept](const Branch& b, int level) {
    if (on_branch_) on_branch_(b, kept, level);
  });
  kept.net->add_seed(u0, kept.origin);
  kept.net->switch_branches();
  if (!kept.net->network(0).branches().empty()) return "";
  const auto& notes = kept.net->network(0).notes();
  std::string why = notes.empty() ? "a cycle was found beside it, which no branch could be walked from" : notes.front();
  families_.pop_back();
  return why;
}

// The same period at the same parameter value: one family, unless two have it by chance.
bool CycleBranches::knows(double period, double p) const {
  for (const auto& family : families_)
    for (int level = 0; level < family->net->levels(); ++level)
      for (const auto& [branch, u] : family->net->network(level).solutions_at(p))
        if (std::abs(family->problem(level).period(u) / period - 1.0) < same_period) return true;
  return false;
}

std::string CycleBranches::add_motion(const Vector& x0, double p, double transient, const std::string& origin) {
  const std::optional<FlowCycle> met = settle_on_cycle(flow_, x0, Vector::Constant(1, p), {.transient = transient});
  if (!met) return not_periodic;
  if (knows(met->period, p)) return "the motion met is on a branch known";
  Eigen::Index most = 0;
  (met->x.rowwise().maxCoeff() - met->x.rowwise().minCoeff()).maxCoeff(&most);
  auto family = std::make_unique<CycleFamily>();
  family->origin = origin;
  family->single = std::make_unique<LimitCycle>(flow_, Vector::Unit(flow_.size(), most), options_.cycle);
  const auto count = met->x.cols();
  const auto orbit = [&](double s) {
    const double at = s * static_cast<double>(count);
    const auto i = static_cast<Eigen::Index>(at) % count;
    const double part = at - std::floor(at);
    return Vector((1.0 - part) * met->x.col(i) + part * met->x.col((i + 1) % count));
  };
  const NewtonResult at =
      newton(*family->single, family->single->guess(orbit, met->period, Vector::Constant(1, p)), {.tolerance = 1e-11, .max_iterations = 20});
  if (!at.ok()) return "Newton does not converge on the motion met";
  family->least_harmonic = motion_end_part * at.x[LimitCycle::first_harmonic];
  family->longest_period = options_.longest_period > 0.0 ? options_.longest_period : options_.longest_multiple * met->period;
  return follow(std::move(family), at.x);
}

}  // namespace whirl::studies
