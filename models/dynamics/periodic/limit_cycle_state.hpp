#pragma once
/// What a LimitCycle keeps between evaluations; for its own sources only.

#include <Eigen/Core>
#include <array>
#include <vector>

#include "models/dynamics/periodic/limit_cycle.hpp"

namespace whirl::models {

/// int_0^theta L_j, the polynomial that the slopes of a step define: x(theta) = x + h sum_j weight_j K_j.
std::array<double, GaussStep::stages> inner_weights(double theta);

struct LimitCycle::Mesh {
  std::vector<double> s;          // ends of the intervals, 0 .. 1; all i/m among them
  std::vector<int> first;         // interval at which segment i begins, one more for the end
  std::vector<GaussMemory> step;  // of each interval
  std::vector<Vector> from;       // x at the beginning of each interval
  Vector reference;               // u it was laid for
  Vector size;                    // of the cycle, per coordinate
  int intervals() const { return static_cast<int>(step.size()); }
};

/// Everything one evaluation fills, of all segments: end points, slopes over (X_i, ln T, p), phase.
struct LimitCycle::Sweep {
  Sweep(const Problem& flow, int segments)
      : columns(flow.size() + 1 + flow.parameters()),
        step(flow, columns),
        end(flow.size(), segments),
        x(flow.size(), segments),
        gap(flow.size(), segments),
        phi(static_cast<std::size_t>(segments), Matrix(flow.size(), columns)),
        ddphi(phi),
        harmonic_slope(columns, 2 * segments),
        harmonic_second(harmonic_slope),
        x_v(x),
        point(flow.size()),
        point_v(flow.size()),
        dh(columns),
        ddh(columns) {}
  int columns;
  GaussStep step;
  Matrix end, x, gap;
  std::vector<Matrix> phi, ddphi;
  Eigen::Vector2d harmonic;
  Matrix harmonic_slope, harmonic_second;  // two columns a segment
  Matrix x_v;                              // points along v
  Vector point, point_v, dh, ddh;
  Vector at;  // u it holds first derivatives of
  bool ok = false;
};

}  // namespace whirl::models
