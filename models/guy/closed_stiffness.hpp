#pragma once
/// Closed forms of the dynamic guy modulus K(p), to be measured against LinearGuy. With x = pi Omega/2, Omega = p_e/w_1 of the string with the mean
/// tension Tm along the chord (length Lc, inclination g), D = 1 - tan x/x, k = AE cos^2 g/Lc, G = pi^2 Tm^3/(w^2 Lc^3 k), e = w Lc sin g/(2 Tm),
/// X = p_e Lc sqrt(m/AE):
///
///     classical            K = k (1 - e D)/(1 - D/(G Omega^2))          [Davenport1959], [Sarvi1968, eqs (5.129)-(5.133)] with F, G corrected
///     completed_massless   K = k (1 - e D)^2/(1 - D/(G Omega^2)) + (Tm sin^2 g/Lc) 2x cot 2x                    even modes added
///     completed            the same with tan X/X for the first 1 of the denominator                             longitudinal inertia added
///     sarvi                [Sarvi1968, eqs (5.122), (5.124)]: longitudinal motion drives transverse motion, without feedback; not passive
///     sarvi_modal          the same with the top slope of the first eight transverse modes, [Sarvi1968, eqs (5.125)-(5.128)]
///
/// and out of plane, Bessel functions with f = 2 sqrt(lambda theta):
///
///     K_z = (f_L/2)(w h/L)[N0(f_0)J1(f_L) - J0(f_0)N1(f_L)]/[J0(f_0)N0(f_L) - N0(f_0)J0(f_L)],   static limit (w h/L)/ln(TL/T0)
///
/// Damping enters as p_e^2 = p^2 - i p c/m. The first-order static form at the state's H is used, as in the source. `alpha` is the softening factor
/// of Sarvi's forms; 0 takes his (3.22d), the static tangent over k. Throws std::invalid_argument for p <= 0 and negative damping.
///
///     const ClosedStiffness closed(rest);
///     std::complex<double> k = closed.modulus(ClosedForm::completed, 3.14, 0.009);

#include <array>
#include <complex>
#include <string_view>
#include <vector>

#include "models/guy/transverse_modes.hpp"

namespace whirl::models::guy {

enum class ClosedForm { classical, completed_massless, completed, sarvi, sarvi_modal };
inline constexpr std::array all_closed_forms = {ClosedForm::classical, ClosedForm::completed_massless, ClosedForm::completed, ClosedForm::sarvi,
                                                ClosedForm::sarvi_modal};
std::string_view to_string(ClosedForm form);

class ClosedStiffness {
 public:
  explicit ClosedStiffness(const Statics& state, double alpha = 0.0);
  std::complex<double> modulus(ClosedForm form, double p, double damping_rate) const;
  std::complex<double> out_of_plane(double p, double damping_rate) const;

  double string_frequency() const { return w1_; }  ///< w_1, Omega = p/w_1 [rad/s]
  double alpha() const { return alpha_; }
  double G() const { return G_; }  ///< pi^2/lambda^2 with the taut modulus
  double e() const { return e_; }
  double F() const { return e_ * G_; }
  const Statics& state() const { return s_; }  ///< first-order form

 private:
  using C = std::complex<double>;
  static constexpr int nodes = 48;
  C kolousek_davenport(ClosedForm form, C pe) const;
  C sarvi(bool modal, C pe) const;
  C top_slope(C pe, double dt, double dn) const;        // (5.124)
  C modal_top_slope(C pe, double dt, double dn) const;  // (5.127)

  Statics s_;
  double w1_, k_, G_, e_, alpha_, a_, b_;
  struct Mode {
    double frequency, end_slope;      // w_i, dphi/ds at the top
    std::array<double, nodes> value;  // at Gauss points
  };
  std::vector<Mode> modes_;
  std::array<double, nodes> place_, weight_, curvature_;  // s, over L, 1/R (5.11)
};

/// 1 - tan x/x, by its series near 0.
std::complex<double> one_minus_tanc(std::complex<double> x);

}  // namespace whirl::models::guy
