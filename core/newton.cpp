#include "core/newton.hpp"

#include <fmt/format.h>

#include "core/dense_lu.hpp"

namespace whirl {

const char* to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::converged:
      return "converged";
    case Outcome::stalled:
      return "stalled";
    case Outcome::diverged:
      return "diverged";
    case Outcome::singular:
      return "singular";
    case Outcome::non_finite:
      return "non-finite";
  }
  return "?";
}

void NewtonOptions::validate() const {
  if (!(tolerance > 0.0)) throw std::invalid_argument(fmt::format("Newton tolerance must be > 0, got {}", tolerance));
  if (max_iterations < 1) throw std::invalid_argument(fmt::format("Newton max_iterations must be >= 1, got {}", max_iterations));
}

NewtonResult newton(const Problem& f, Vector start, const NewtonOptions& options) {
  options.validate();
  const int n = f.size();
  NewtonResult result{std::move(start), 0.0, 0, Outcome::stalled};
  Vector r(n), dx(n);
  Matrix j(n, n + f.parameters());
  DenseLu lu(n);
  double previous = std::numeric_limits<double>::infinity();
  int growing = 0;
  for (int i = 0; i <= options.max_iterations; ++i) {
    f.linearise(result.x, r, j);
    if (!r.allFinite() || !j.allFinite()) {
      result.outcome = Outcome::non_finite;
      return result;
    }
    result.residual = r.lpNorm<Eigen::Infinity>();
    if (i == options.max_iterations) break;
    lu.compute(j.leftCols(n));
    lu.solve(r, dx);
    if (!dx.allFinite()) {
      result.outcome = Outcome::singular;
      return result;
    }
    result.x.head(n) -= dx;
    result.iterations = i + 1;
    // Done when this step, or at the rate of the last two the one to come, is below the tolerance.
    const double step = dx.lpNorm<Eigen::Infinity>(), rate = i > 0 ? std::min(step / previous, 1.0) : 1.0;
    result.last_step = step / (1.0 + result.x.head(n).lpNorm<Eigen::Infinity>());
    if (result.last_step * rate <= options.tolerance) {
      f.residual(result.x, r);
      result.residual = r.lpNorm<Eigen::Infinity>();
      result.outcome = r.allFinite() ? Outcome::converged : Outcome::non_finite;
      return result;
    }
    growing = step > 2.0 * previous ? growing + 1 : 0;
    if (growing >= 3) {
      result.outcome = Outcome::diverged;
      return result;
    }
    previous = step;
  }
  return result;
}

}  // namespace whirl
