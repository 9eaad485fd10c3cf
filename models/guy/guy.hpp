#pragma once
/// A guy: a heavy elastic cable between an anchor (lower end, the origin) and a point of a mast.
///
/// x runs horizontally from the anchor towards the mast, y upwards, z out of the guy's plane. Lengths, masses and weights are per unit unstressed
/// length. `horizontal_span` l > 0; `rise` h may be zero (level) or negative (the far end lies lower). validate() throws std::invalid_argument.
///
///     Guy guy{.horizontal_span = 289.56, .rise = 411.1752, .axial_stiffness = 2.5835e8, .mass_per_length = 13.393};
///     Guy iced = with_ice(guy, 4.0);                       // 4 kg/m of ice: weight and mass, no stiffness

namespace whirl::models::guy {

struct Guy {
  double horizontal_span = 0.0;  ///< l [m]
  double rise = 0.0;             ///< h [m]
  double axial_stiffness = 0.0;  ///< AE [N]
  double mass_per_length = 0.0;  ///< m [kg/m]
  double gravity = 9.80665;      ///< g [m/s^2]

  double weight() const { return mass_per_length * gravity; }  ///< w [N/m]
  double chord() const;                                        ///< Lc [m]
  double chord_cosine() const { return horizontal_span / chord(); }
  double chord_sine() const { return rise / chord(); }
  double taut_modulus() const;  ///< AE cos^2 gamma / Lc, [Sarvi1968, eq. (2.38)] [N/m]
  void validate() const;
};

/// The guy with ice of this mass per length on it.
[[nodiscard]] Guy with_ice(Guy guy, double ice_mass_per_length);

/// Unstressed length after a change of temperature: L0 (1 + expansion * change).
[[nodiscard]] double heated_length(double unstressed_length, double temperature_change, double expansion);

}  // namespace whirl::models::guy
