#pragma once
/// How far multipliers may turn in one step of a walk along periodic motions, and how they go on from one step to the next.
///
/// By linear theory a pair stands at e^{g +- i w T}, T the period: its angle changes by w (T2 - T1) and passes 0, pi or another pair's at every line
/// of the resonance table, 2 w_a, w_a +- w_b, w_a, w_a/n, of motions of period one and two. Steps over which it turns by less than half a radian pass
/// no two lines of one pair, and the step before foretells the next turn by the change of the period, whatever the range: nothing else need be known
/// of the lines.

#include <algorithm>
#include <cmath>

#include "continuation/curve.hpp"

namespace whirl::continuation {

struct TurningLimits {
  double most = 0.5;             ///< turn of a pair in one step [rad]
  double of_first_step = 2e-3;   ///< change of the frequency in the first step, relative: nothing foretells the turn yet
  double along_parameter = 0.7;  ///< part of a step that the parameter makes up, from which on the period foretells the turn
};

/// The largest turn of a pair that stays complex, in the step to this point.
inline double largest_turn(const Sample& s) {
  double most = 0.0;
  for (const MultiplierPair& p : s.pairs)
    if (p.from >= 0 && !p.real()) most = std::max(most, std::abs(p.last_turn));
  return most;
}

/// How much farther multipliers turn from a to b than from `before` to a: by the periods, or by the lengths where the motion changes more than the
/// parameter, or the parameter turns.
inline double stretch_of_turn(const Curve& curve, const Sample& before, const Sample& a, const Sample& b, const TurningLimits& limits = {}) {
  const auto n = a.u.size() - 1;
  const double behind = curve.length(a.u - before.u), ahead = curve.length(b.u - a.u);
  if (!(behind > 0.0)) return 0.0;
  const double p_behind = (a.u[n] - before.u[n]) / curve.p_scale(), p_ahead = (b.u[n] - a.u[n]) / curve.p_scale();
  const double least = limits.along_parameter;
  if (!curve.orbit() || std::abs(p_behind) < least * behind || std::abs(p_ahead) < least * ahead || p_behind * p_ahead < 0.0) return ahead / behind;
  const double t0 = 1.0 / curve.orbit()->base_frequency(before.u), t1 = 1.0 / curve.orbit()->base_frequency(a.u),
               t2 = 1.0 / curve.orbit()->base_frequency(b.u);
  constexpr double steady = 1e-9;  // relative change of a period that another parameter leaves as it is
  return std::abs(t1 - t0) > steady * t1 ? (t2 - t1) / (t1 - t0) : ahead / behind;
}

/// A first step in the metric, no longer than `step`, over which the frequency changes little.
inline double first_step_of_orbit(const Curve& curve, In u, In tangent, double step, const TurningLimits& limits = {}) {
  if (!curve.orbit()) return step;
  const double w = curve.orbit()->base_frequency(u), change = std::abs(curve.orbit()->base_frequency(u + step * tangent) - w);
  return change > limits.of_first_step * w ? step * limits.of_first_step * w / change : step;
}

}  // namespace whirl::continuation
