#pragma once
/// Which resonance conditions a cable is near: of the support's motion with its modes, and of its modes among each other.
///
///     primary        omega = omega_a                      the motion's inertia or its pull at the sag drives mode a
///     superharmonic  omega = omega_a/n, n = 2, 3           quadratic, cubic and parametric terms
///     parametric     omega = 2 omega_a                     stretching of the chord modulates the stiffness of every mode
///     combination    omega = omega_a + omega_b             the same, for two modes whose slopes are not orthogonal
///     internal 1:1   omega_a = omega_b                     cubic coupling, between any two modes
///     internal 1:2   2 omega_a = omega_b                   the sag's quadratic coupling p_a^2 p_b: b symmetric in plane
///
///     for (const Resonance& r : resonances(lowest_modes(cable, 4), {.omega = 3.2})) r.detuning;
///
/// Frequencies in rad/s. Throws std::invalid_argument for a tolerance that is not positive.

#include "models/shallow/modes.hpp"

namespace whirl::models::shallow {

enum class ResonanceKind { primary, superharmonic, parametric, combination, internal };
const char* to_string(ResonanceKind kind);

struct Resonance {
  ResonanceKind kind;
  std::string condition;      ///< "omega = 2 w(y1)"
  std::string first, second;  ///< names of the modes; `second` empty where one mode is meant
  double at;                  ///< excitation frequency that meets it [rad/s]; internal: omega_a of the first mode
  double detuning;            ///< omega/at - 1; internal: 2 omega_a/omega_b - 1, or omega_a/omega_b - 1. NaN where no omega is given
  bool driven;                ///< the terms that drive it are there: for motion of the support in the plane of the chord
};

struct ResonanceOptions {
  double omega = 0.0;      ///< excitation frequency; 0: internal resonances alone are judged, all conditions are listed
  double tolerance = 0.1;  ///< largest |detuning| that counts as near
  int superharmonics = 3;
  void validate() const;
};

/// With omega: the conditions within the tolerance, the nearest first. Without: external conditions by rising `at`, then internal ones near.
std::vector<Resonance> resonances(const std::vector<ModeShape>& modes, const ResonanceOptions& options);

}  // namespace whirl::models::shallow
