#pragma once
/// The stable limit cycle of a flow that a start settles on, by explicit integration: a transient, then returns to the plane through the last point
/// normal to the motion until one comes back to it.
///
///     auto met = settle_on_cycle(flow, x0, p, {.transient = 500.0});
///     if (met) ... met->period, met->x       // n x samples, equal instants of the period

#include <optional>

#include "core/problem.hpp"

namespace whirl::models {

struct SettleOnCycleOptions {
  double transient = 1000.0;  ///< in the flow's time
  int most_returns = 64;      ///< a cycle that crosses the plane more often in a period is not found
  double same = 1e-5;         ///< of the size of the motion: a return this near is the start again
  int samples = 512;
};

struct FlowCycle {
  double period;
  Matrix x;
};

/// Nothing if the motion diverges, comes to rest, or is not periodic within `same`.
std::optional<FlowCycle> settle_on_cycle(const Problem& flow, const Vector& x0, const Vector& p, const SettleOnCycleOptions& options = {});

}  // namespace whirl::models
