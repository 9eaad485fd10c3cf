#include "models/slow_decay.hpp"

#include <fmt/format.h>

#include <cmath>

namespace whirl::models {
namespace {

// Mean of every m-th point, the last one among them.
Vector mean_of_every(const Matrix& points, int m) {
  Vector sum = Vector::Zero(points.rows());
  int count = 0;
  for (Eigen::Index j = points.cols() - 1; j >= 0; j -= m, ++count) sum += points.col(j);
  return sum / count;
}

}  // namespace

std::string SlowDecay::words(double period) const {
  return fmt::format("decays too slowly to be seen: towards a periodic motion, by its multipliers at {:.3g} 1/s, halved in some {:.3g} periods", rate,
                     std::log(2.0) / (rate * period));
}

std::optional<SlowDecay> slow_decay(AttractorFinder& finder, const Matrix& points, int multiple, const SlowDecayOptions& o) {
  if (points.cols() == 0) return std::nullopt;
  for (const int m : multiple > 1 ? std::vector<int>{1, multiple} : std::vector<int>{1})
    for (const Vector& guess : {mean_of_every(points, m), Vector(points.col(points.cols() - 1))}) {
      auto motion = finder.refine(guess, m);
      if (!motion) continue;
      const double mu = std::abs(motion->multipliers[0]);
      if (mu >= 1.0 - o.undamped) continue;
      if (1.0 - std::pow(mu, o.periods / motion->multiple) > o.visible) continue;
      const double rate = -motion->lyapunov;
      return SlowDecay{std::move(*motion), rate};
    }
  return std::nullopt;
}

}  // namespace whirl::models
