#include "models/lyapunov.hpp"

#include <fmt/format.h>

#include <cmath>

namespace whirl::models {

void LyapunovOptions::validate() const {
  if (periods < 16 || skip < 0)
    throw std::invalid_argument(fmt::format("a Lyapunov exponent needs periods >= 16, skip >= 0, got {}, {}", periods, skip));
}

LyapunovResult largest_lyapunov(Stroboscope& strobe, Vector& y, const LyapunovOptions& o) {
  o.validate();
  LyapunovResult r;
  Vector v = Vector::Ones(strobe.size()).normalized();
  for (int k = 0; k < o.skip; ++k) {
    if (!strobe.map_tangent(y, v)) return r;
    v.normalize();
  }
  r.points.resize(strobe.size(), o.periods);
  Vector growth(o.periods);
  for (int k = 0; k < o.periods; ++k) {
    if (!strobe.map_tangent(y, v)) return r;
    const double length = v.norm();
    growth[k] = std::log(length);
    v /= length;
    r.points.col(k) = y;
  }
  constexpr int stretches = 16;
  const int each = o.periods / stretches;
  Vector means(stretches);
  for (int s = 0; s < stretches; ++s) means[s] = growth.segment(s * each, each).mean() / strobe.period();
  r.exponent = growth.mean() / strobe.period();
  r.error = 2.0 * std::sqrt((means.array() - means.mean()).square().sum() / (stretches - 1) / stretches);
  r.ok = std::isfinite(r.exponent);
  return r;
}

}  // namespace whirl::models
