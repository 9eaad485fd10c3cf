#pragma once
/// Time integration of y' = f(t, y) with CVODE: Adams with fixed-point iteration for smooth vibration, BDF with a dense Newton for stiff systems.
///
///     Integrator run([](double, std::span<const double> y, std::span<double> d) { d[0] = -y[0]; }, 0.0, y0, {.relative_tolerance = 1e-10});
///     run.advance(1.0);   run.state();
///
/// Throws std::invalid_argument for options out of range. An integration that cannot go on returns false from `advance` and `why()` says why.

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/problem.hpp"

namespace whirl {

struct IntegratorOptions {
  double relative_tolerance = 1e-9;
  double absolute_tolerance = 1e-11;  ///< in the unit of the state
  bool stiff = false;                 ///< BDF and Newton in place of Adams and fixed-point iteration
  long max_steps = 200000;            ///< between two output times
  void validate() const;
};

class Integrator {
 public:
  using RightHandSide = std::function<void(double t, std::span<const double> y, std::span<double> dydt)>;

  Integrator(RightHandSide f, double t0, const Vector& y0, const IntegratorOptions& options);
  ~Integrator();
  Integrator(Integrator&&) noexcept;

  /// Integrates to exactly t; false if CVODE gave up (see why()). An exception of f is rethrown here.
  [[nodiscard]] bool advance(double t);
  /// Restarts from (t, y).
  void restart(double t, const Vector& y);

  double time() const;
  Eigen::Map<const Vector> state() const;
  const std::string& why() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> self_;
};

}  // namespace whirl
