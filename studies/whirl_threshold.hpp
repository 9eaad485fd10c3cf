#pragma once
/// The least support amplitude at which planar periodic motion of a cable loses stability to whirling: the lowest point of a curve in (omega, U).
///
/// Out-of-plane coordinates vanish on planar motion, so the harmonic-balance Jacobian falls apart,
///
///     [ J_oo  0    ]      J_pp: Newton for the motion,  J_oo: singular where whirling is born (a multiplier 1)
///     [ 0     J_pp ]
///
/// and two small matrices do what a defining system of the whole would: G(omega, U) = g of [J_oo b; c' 0][v; g] = [0; 1] vanishes on the curve,
/// dU/domega = -G_omega/G_U along it, and the threshold is where that is zero.
///
///     const auto t = whirl_threshold(model, {.harmonics = 15, .omega = {1.4, 1.75}});
///
/// The start is found on the planar branch at the model's amplitude, from the lower end of omega up, folds included.

#include <functional>

#include "models/multimode/cable_model.hpp"

namespace whirl::studies {

struct WhirlThresholdOptions {
  int harmonics = 15;
  std::array<double, 2> omega{};      ///< [rad/s]
  std::array<double, 2> amplitude{};  ///< [m], the curve is not followed beyond
  std::function<bool()> interrupted = [] { return false; };
};

struct WhirlThreshold {
  bool ok = false;
  double omega = 0.0, amplitude = 0.0;
  double first_omega = 0.0;  ///< first whirling point at the model's amplitude
  std::string why;           ///< if not ok
};

WhirlThreshold whirl_threshold(const models::CableModel& model, const WhirlThresholdOptions& options);

}  // namespace whirl::studies
