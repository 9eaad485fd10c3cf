#pragma once
/// Dynamic stiffness of a mast's level: the guys that hold one point, each turned into the common frame.
///
/// X and Y lie in plan, azimuths counted from X towards Y, from the mast to the anchor; Z upwards. A guy's own x (from the anchor to the mast) points
/// against its azimuth. K = sum R^T K_guy R [N/m]; n >= 3 equal guys, equally spread, give K_XX = K_YY = (n/2)(K_xx + K_zz), K_ZZ = n K_yy.
/// Throws std::invalid_argument without guys.
///
///     const Eigen::Matrix3cd k = level_stiffness({{&guy, 0.0}, {&guy, 2.094}, {&guy, 4.189}}, 3.14, 0.009);

#include <Eigen/Core>
#include <vector>

#include "models/guy/linear_guy.hpp"

namespace whirl::models::guy {

struct LevelMember {
  const LinearGuy* guy = nullptr;
  double azimuth = 0.0;  ///< [rad]
};

[[nodiscard]] Eigen::Matrix3cd level_stiffness(const std::vector<LevelMember>& level, double p, double damping_rate);

}  // namespace whirl::models::guy
