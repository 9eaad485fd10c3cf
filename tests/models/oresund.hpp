#pragma once
/// The longest stay of the Oresund bridge, [NielsenKirkegaard2002, eq. (74)].
#include "models/superharmonic.hpp"

namespace whirl::models {
inline StayParameters<double> oresund(double amplitude = 0.5, double omega = 1.8) {
  return {{260.0, 2.17e9, 5.5e6, 81.05, 30.4, 9.81}, 0.01, 0.01, amplitude, omega};
}
inline Vector point(std::initializer_list<double> values) {
  Vector u(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), u.data());
  return u;
}
}  // namespace whirl::models
