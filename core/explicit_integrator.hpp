#pragma once
/// Fast explicit integration of y' = f(t, y) for smooth, non-stiff systems: steps of Runge-Kutta-Fehlberg 7(8) from Boost.odeint (or any other of its
/// error steppers), with a tolerance for every component. Ensembles, sweeps and basins use it; CVODE (core/cvode.hpp) is the independent check and
/// the stiff integrator. Measured beside the alternatives in tests/benchmarks/bench_integrate.cpp.
///
///     error norm   max_i |e_i| / (absolute_i + relative max(|y_i|, |y_i + dy_i|))  <= 1;     what remains to an output time is cut into equal steps
///
/// `State` is std::array<double, N> (fastest) or std::vector<double>. After construction nothing is allocated.
/// Throws std::invalid_argument for options out of range. A numerical failure returns false from `advance` and `why()` says why.
///
///     struct Decay { void operator()(const std::array<double, 1>& y, std::array<double, 1>& d, double) const { d[0] = -y[0]; } };
///     ExplicitIntegrator<std::array<double, 1>, Decay> run(Decay{}, {.relative_tolerance = 1e-10});
///     run.restart(0.0, {1.0});
///     run.advance(1.0);   run.state();

#include <algorithm>
#include <array>
#include <boost/numeric/odeint/algebra/algebra_dispatcher.hpp>
#include <boost/numeric/odeint/algebra/array_algebra.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <boost/numeric/odeint/util/resizer.hpp>
#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace whirl {

struct ExplicitOptions {
  double relative_tolerance = 1e-9;
  double absolute_tolerance = 1e-11;  ///< in the unit of the state, for components that `absolute` does not name
  std::vector<double> absolute = {};  ///< per component; empty: `absolute_tolerance` for all
  double first_step = 0.0;            ///< 0: a hundredth of the first output time
  double largest_norm = 1e9;          ///< a component beyond it ends the run: the motion diverges
  long max_steps = 1000000;           ///< between two output times
  void validate() const {
    if (!(relative_tolerance > 0.0 && relative_tolerance < 1.0)) throw std::invalid_argument("relative_tolerance must be in (0, 1)");
    if (!(absolute_tolerance > 0.0)) throw std::invalid_argument("absolute_tolerance must be > 0");
    for (const double a : absolute)
      if (!(a > 0.0)) throw std::invalid_argument("absolute tolerances of the components must be > 0");
    if (!(first_step >= 0.0) || !(largest_norm > 0.0) || max_steps < 1)
      throw std::invalid_argument("first_step must be >= 0, largest_norm > 0, max_steps >= 1");
  }
};

enum class IntegrationStop { none, diverged, step_too_small, too_many_steps };

template <class State>
using Fehlberg78 = boost::numeric::odeint::runge_kutta_fehlberg78<State>;

template <class State, class System, class Stepper = Fehlberg78<State>>
class ExplicitIntegrator {
  static constexpr bool last_is_first =
      std::is_same_v<typename Stepper::stepper_category, boost::numeric::odeint::explicit_error_stepper_fsal_tag>;  // the last stage of a step

 public:
  explicit ExplicitIntegrator(System system, const ExplicitOptions& options = {}) : system_(std::move(system)), options_(options) {
    options_.validate();
  }

  /// Starts from (t, y); the step of the run before is kept as a first guess.
  void restart(double t, const State& y) {
    t_ = t;
    y_ = y;
    if (dydt_.size() != y.size()) {
      dydt_ = y;
      next_ = y;
      error_ = y;
      slope_ = y;
    }
    if (tolerance_.size() != y.size()) {
      if (!options_.absolute.empty() && options_.absolute.size() != y.size())
        throw std::invalid_argument("as many absolute tolerances as components are needed");
      tolerance_ = options_.absolute.empty() ? std::vector<double>(y.size(), options_.absolute_tolerance) : options_.absolute;
    }
    slope_known_ = false;
    stop_ = IntegrationStop::none;
  }

  [[nodiscard]] bool advance(double end) {
    const double direction = end >= t_ ? 1.0 : -1.0;
    if (h_ == 0.0) h_ = options_.first_step > 0.0 ? options_.first_step : 0.01 * std::abs(end - t_);
    for (long count = 0; t_ != end; ++count) {
      if (count >= options_.max_steps) return fail(IntegrationStop::too_many_steps);
      const double pieces = std::max(1.0, std::ceil(std::abs(end - t_) / h_ * (1.0 - 1e-10)));
      const bool last = pieces == 1.0;
      const long rejected = rejected_;
      if (!step((end - t_) / pieces, direction)) return false;
      if (last && rejected_ == rejected) t_ = end;  // not t_ + (end - t_), which may round; a step that was shortened has not arrived
    }
    return true;
  }

  const State& state() const { return y_; }
  double time() const { return t_; }
  long steps() const { return steps_; }
  long rejected() const { return rejected_; }
  IntegrationStop stop() const { return stop_; }
  System& system() { return system_; }
  std::string why() const {
    switch (stop_) {
      case IntegrationStop::none:
        return "";
      case IntegrationStop::diverged:
        return "the motion grew beyond the largest norm at t = " + std::to_string(t_);
      case IntegrationStop::step_too_small:
        return "the step fell to nothing at t = " + std::to_string(t_);
      case IntegrationStop::too_many_steps:
        return "too many steps before t = " + std::to_string(t_);
    }
    return "";
  }

 private:
  // One accepted step of at most |h|; shorter if the error says so.
  bool step(double h, double direction) {
    if (!slope_known_) system_(y_, dydt_, t_);
    slope_known_ = true;
    for (;;) {
      if constexpr (last_is_first) stepper_.do_step(std::ref(system_), y_, dydt_, t_, next_, slope_, h, error_);
      else stepper_.do_step(std::ref(system_), y_, dydt_, t_, next_, h, error_);
      const double e = error_norm();
      if (e <= 1.0) {
        const double factor = e > 1e-9 ? std::min(4.0, 0.9 * std::pow(e, -1.0 / Stepper::order_value)) : 4.0;
        // A step cut short to reach an output time says little about how long one may be: never shrink by it.
        h_ = std::max(h_ * std::min(1.0, factor), std::abs(h) * factor);
        t_ += h;
        std::swap(y_, next_);
        if constexpr (last_is_first) std::swap(dydt_, slope_);
        slope_known_ = last_is_first;
        ++steps_;
        for (const double x : y_)
          if (!(std::abs(x) < options_.largest_norm)) return fail(IntegrationStop::diverged);
        return true;
      }
      ++rejected_;
      const double factor = std::isfinite(e) ? std::max(0.2, 0.9 * std::pow(e, -1.0 / Stepper::order_value)) : 0.1;
      h_ = std::abs(h) * factor;
      h = direction * h_;
      if (t_ + h == t_) return fail(std::isfinite(e) ? IntegrationStop::step_too_small : IntegrationStop::diverged);
    }
  }

  double error_norm() const {
    double worst = 0.0;
    for (std::size_t i = 0; i < y_.size(); ++i) {
      const double scale = tolerance_[i] + options_.relative_tolerance * std::max(std::abs(y_[i]), std::abs(next_[i]));
      const double e = std::abs(error_[i]) / scale;
      if (!(e <= worst)) worst = e;  // also a NaN
      if (std::isnan(worst)) return worst;
    }
    return worst;
  }

  bool fail(IntegrationStop why) {
    stop_ = why;
    return false;
  }

  System system_;
  ExplicitOptions options_;
  Stepper stepper_;
  std::vector<double> tolerance_;
  State y_{}, dydt_{}, next_{}, error_{};
  State slope_{};  // of next_, if the stepper gives it
  bool slope_known_ = false;
  double t_ = 0.0, h_ = 0.0;
  long steps_ = 0, rejected_ = 0;
  IntegrationStop stop_ = IntegrationStop::none;
};

}  // namespace whirl
