#pragma once
/// A motion that decays more slowly than a run can show, told from one on a torus.
///
/// Beside a stable periodic motion p of multiple m with weak damping, stroboscopic points turn about its points on ellipses that shrink by |mu| in m
/// periods, mu the largest multiplier of P^m. Over N periods they shrink by the factor |mu|^(N/m): where less than that can be seen of a run, it
/// looks like a quasi-periodic one, with an exponent of zero within its error. A motion on a torus stays where this factor could be seen.
///
///     const auto decay = slow_decay(finder, points, 1, {.periods = 400, .visible = 0.1});     // points: stroboscopic, 2 n x N, the last ones
///     if (decay) decay->rate;                                                               // [1/s]: the motion is not settled
///
/// The periodic motion is sought by Newton's method from the mean of the points and from the last of them. Without damping (|mu| = 1 to rounding)
/// motion stays quasi-periodic.

#include "models/attractors.hpp"

namespace whirl::models {

struct SlowDecayOptions {
  double periods = 400.0;  ///< N over which the run's distances were compared
  double visible = 0.1;    ///< relative change that would have been seen
  double undamped = 1e-8;  ///< 1 - |mu| below which a motion counts as undamped: multipliers are integrated to 1e-9
};

struct SlowDecay {
  Attractor motion;  ///< the periodic motion that the decay leads to
  double rate;       ///< [1/s], > 0
  std::string words(double period) const;
};

std::optional<SlowDecay> slow_decay(AttractorFinder& finder, const Matrix& points, int multiple, const SlowDecayOptions& options = {});

}  // namespace whirl::models
