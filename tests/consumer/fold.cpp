// Follows x' = mu + x - x^3 through its two folds, at mu = -+2 / (3 sqrt 3); and asks a stay cable for its Irvine parameter.
#include <cstdio>

#include "continuation/walker.hpp"
#include "core/dual_problem.hpp"
#include "models/statics.hpp"

struct Cusp {
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    r[0] = u[1] + u[0] - u[0] * u[0] * u[0];
  }
};

int main() {
  const whirl::DualProblem<Cusp> cusp({}, 1, 1, true);
  whirl::continuation::Walker walker(cusp, {.lower = -1.0, .upper = 1.0});
  for (const auto& point : walker.walk(Eigen::Vector2d(0.0, 0.0)).special)
    if (point.type == whirl::continuation::EventType::fold) std::printf("fold at mu = %.9f\n", point.u[1]);
  const whirl::models::Cable<double> stay{260.0, 2.17e9, 5.5e6, 81.05, 30.4, 9.81};
  std::printf("lambda2 = %.6f, %zu warnings\n", whirl::models::parabola(stay).irvine_lambda2, whirl::models::check(stay).size());
}
