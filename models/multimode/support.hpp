#pragma once
/// What the cable's equations and its tension share: the direction of the moving end, and the stiffness against stretching.

#include "models/multimode/cable_model.hpp"

namespace whirl::models {

/// The moving end's displacement of unit amplitude: along the chord, across it (downwards), out of plane.
template <class S>
std::array<S, 3> direction_of(Direction direction, const S& inclination_deg) {
  using std::cos;
  using std::sin;
  const S theta = inclination_deg * (pi / 180.0), zero(0.0);
  switch (direction) {
    case Direction::horizontal:
      return {cos(theta), sin(theta), zero};
    case Direction::vertical:
      return {sin(theta), -cos(theta), zero};
    case Direction::chord:
      return {S(1.0), zero, zero};
    case Direction::normal:
      return {zero, S(1.0), zero};
    case Direction::out_of_plane:
      return {zero, zero, S(1.0)};
  }
  return {};
}

/// K = AE/(mu L^2), with AE/(1 + 8 r^2/3) where the tension is uniform: the stiffness in lambda2.
template <class S>
S stretching_rate(const CableModel& model, const Cable<S>& c, const Parabola<S>& shape) {
  const S K = stiffness_rate(c);
  return model.longitudinal == Longitudinal::galerkin ? K : K / (shape.sag_ratio * shape.sag_ratio * (8.0 / 3.0) + 1.0);
}

}  // namespace whirl::models
