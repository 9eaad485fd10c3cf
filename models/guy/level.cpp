#include "models/guy/level.hpp"

#include <cmath>
#include <stdexcept>

namespace whirl::models::guy {

Eigen::Matrix3cd level_stiffness(const std::vector<LevelMember>& level, double p, double damping_rate) {
  if (level.empty()) throw std::invalid_argument("level stiffness: needs a guy");
  Eigen::Matrix3cd sum = Eigen::Matrix3cd::Zero(), k = Eigen::Matrix3cd::Zero();
  for (const auto& [guy, azimuth] : level) {
    const StiffnessMatrix own = guy->stiffness(p, damping_rate);
    k << own.xx, own.xy, 0.0, own.xy, own.yy, 0.0, 0.0, 0.0, own.zz;
    const double c = std::cos(azimuth), s = std::sin(azimuth);
    Eigen::Matrix3d turn;  // own (x, y, z) from common (X, Y, Z): x against the azimuth, y upwards, z = x cross y
    turn << -c, -s, 0.0, 0.0, 0.0, 1.0, -s, c, 0.0;
    sum += turn.transpose() * k * turn;
  }
  return sum;
}

}  // namespace whirl::models::guy
