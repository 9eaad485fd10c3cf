#pragma once
/// Longitudinal steady states of a guy treated as a bar, softened by its sag, [Sarvi1968, ch. IV]: m xi_tt + c xi_t = alpha AE xi_ss, held at s = 0,
/// a = sqrt(alpha AE/m), p_e^2 = p^2 - i p c/m, X = p_e L/a:
///
///     driven by a force F at s = L          xi = (F/(alpha AE)) sin(p_e s/a) / ((p_e/a) cos X)                 (4.34)
///     moved by Delta at s = L               xi = Delta sin(p_e s/a) / sin X                                    (4.56)
///     magnification                         tan X / X of the displacement (4.61),  X / tan X of the force (4.62)
///
/// and the same as series of modes, (4.29) and (4.53); the print has 2 p^2/pi^2 in (4.53) where 2 p^2/pi is right. Complex amplitudes of e^{ipt}.
/// It stands for comparison with the source: a guy's longitudinal motion bends it too, see LinearGuy. Throws std::invalid_argument for values that
/// are not positive and damping below zero.
///
///     const LongitudinalGuy bar(503.3, 2.5835e8, 13.393, 0.398);
///     std::complex<double> k = bar.magnification_of_force(p, 0.0);     // zero at bar.free_frequency(i), infinite at bar.held_frequency(i)

#include <complex>

namespace whirl::models::guy {

class LongitudinalGuy {
 public:
  using C = std::complex<double>;
  LongitudinalGuy(double length, double axial_stiffness, double mass_per_length, double alpha = 1.0);

  C force_driven(double force, double s, double p, double damping_rate) const;          ///< xi(s) [m]
  C displacement_driven(double motion, double s, double p, double damping_rate) const;  ///< xi(s) [m]
  C force_driven_series(double force, double s, double p, double damping_rate, int terms) const;
  C displacement_driven_series(double motion, double s, double p, double damping_rate, int terms) const;

  C magnification_of_displacement(double p, double damping_rate) const;  ///< tan X / X
  C magnification_of_force(double p, double damping_rate) const;         ///< X / tan X
  C stiffness(double p, double damping_rate) const;                      ///< (alpha AE/L) X / tan X [N/m]

  double wave_speed() const { return a_; }  ///< [m/s]
  double free_frequency(int i) const;       ///< (2i - 1) pi a / 2L: upper end free, (4.63) [rad/s]
  double held_frequency(int i) const;       ///< i pi a / L: upper end held, (4.64) [rad/s]

 private:
  C wave_number(double p, double damping_rate) const;
  double length_, stiffness_, mass_, a_;
};

}  // namespace whirl::models::guy
