#pragma once
/// Newton's method for square problems (parameters() == 0) and for a problem with its parameters held.
///
///     J dx = -r,   x <- x + dx,   until |dx|, or at the rate of the last two steps the next one, is below tolerance
///
/// Throws std::invalid_argument for options out of range; numerical failure is an Outcome.

#include "core/problem.hpp"

namespace whirl {

enum class Outcome { converged, stalled, diverged, singular, non_finite };
const char* to_string(Outcome outcome);

struct NewtonOptions {
  double tolerance = 1e-12;  ///< on the step to come, relative to 1 + |x|
  int max_iterations = 20;
  void validate() const;
};

struct NewtonResult {
  Vector x;         ///< unknowns and parameters, size n + k
  double residual;  ///< largest |r_i|
  int iterations;
  Outcome outcome;
  double last_step = 1.0;  ///< relative to 1 + |x|
  bool ok() const { return outcome == Outcome::converged; }
  /// Converged, or wandering at the level of rounding: steps and residual are tiny, yet not below the tolerance.
  bool settled(double largest_residual = 1e-12) const {
    return ok() || (outcome == Outcome::stalled && residual < largest_residual && last_step < 1e-10);
  }
};

/// Solves r(x, p) = 0 for x, the last k entries of `start` held.
[[nodiscard]] NewtonResult newton(const Problem& f, Vector start, const NewtonOptions& options = {});

}  // namespace whirl
