#pragma once
/// Transverse modes of a taut string whose tension varies linearly, T = T0 + (TL - T0) s/L, fixed at both ends:
///
///     (T Y')' + m w^2 Y = 0;   J0(z) N0(kz) - N0(z) J0(kz) = 0,   k = sqrt(TL/T0)                    [Sarvi1968, eq. (5.62)]
///
/// solved in X = (k - 1) z, which stays finite as k -> 1 (a level guy): X_i lies in [(i - 1/2) pi, i pi] and tends to i pi,
///
///     w_i = X_i (1 + k)/(2 L) sqrt(T0/m)     (= (h/L)(z_i/2) sqrt(g w/T0) of [Sarvi1968, eq. (5.66)])
///
/// For k - 1 below 2e-3 Bessel functions of large argument would lose the phase; modulus and phase are used there [Sarvi1968, eq. (5.63)'s series].
/// Modes are normalised: int phi_i phi_j ds = L delta_ij, phi_i'(0) > 0. Mode numbers run from 1. Either end may have the larger tension.
/// Throws std::invalid_argument for tensions, lengths, masses that are not positive and for mode numbers below 1.
///
///     const TransverseModes modes(rest);                 // tensions, length, mass of a static state
///     double w1 = modes.frequency(1);                    // rad/s
///     double top_slope = modes.mode(3).slope(1.0);       // d phi/d sigma at the upper end, sigma = s/L

#include "models/guy/statics.hpp"

namespace whirl::models::guy {

class TransverseModes;

/// One normalised mode; value and slope with respect to sigma = s/L in [0, 1].
class TransverseMode {
 public:
  double value(double sigma) const;
  double slope(double sigma) const;
  double frequency() const { return frequency_; }  ///< w_i [rad/s]
  double phase_number() const { return phase_; }   ///< X_i
  double root() const;                             ///< z_i; infinite for k = 1
  double printed_norm() const;                     ///< N_i, root mean square of the unscaled mode, [Sarvi1968, eq. (5.99)]; 0 for k = 1

 private:
  friend class TransverseModes;
  // With the larger tension at sigma = 1 (flip_: mirrored).
  double low_value(double sigma) const;
  double low_slope(double sigma) const;
  double k_ = 1.0, phase_ = 0.0, frequency_ = 0.0, scale_ = 0.0;
  bool flip_ = false, modulus_ = false;
  double sign_ = 1.0;
};

class TransverseModes {
 public:
  TransverseModes(double lower_tension, double upper_tension, double length, double mass_per_length);
  explicit TransverseModes(const Statics& state);  ///< with the stretched length; mass as given

  double phase_number(int i) const;  ///< X_i
  double frequency(int i) const;     ///< w_i [rad/s]
  TransverseMode mode(int i) const;
  double k() const { return k_; }  ///< sqrt of the larger over the smaller end tension

 private:
  double k_, speed_;  ///< w = speed_ X
  bool flip_;
};

/// z_i by McMahon's expansion with 1 to 4 terms, [Sarvi1968, eq. (5.63)]; for comparison only.
double mcmahon_root(int i, double k, int terms);

/// Frequency of the constant-tension string along the chord, i pi/Lc sqrt(Tm/m), [Sarvi1968, eq. (5.107)] [rad/s].
double string_frequency(const Statics& state, int i);

}  // namespace whirl::models::guy
