#include "models/guy/closed_stiffness.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/complex_bessel.hpp"
#include "models/guy/legendre_basis.hpp"
#include "models/guy/tangent.hpp"

namespace whirl::models::guy {
namespace {

using C = std::complex<double>;
using std::numbers::pi;

C damped_frequency(double p, double damping_rate) {
  if (!(p > 0.0) || !std::isfinite(p)) throw std::invalid_argument(fmt::format("guy stiffness: frequency must be > 0, got {:g}", p));
  if (!(damping_rate >= 0.0) || !std::isfinite(damping_rate))
    throw std::invalid_argument(fmt::format("guy stiffness: damping rate c/m must be >= 0, got {:g}", damping_rate));
  return std::sqrt(C(p * p, -p * damping_rate));
}

}  // namespace

std::string_view to_string(ClosedForm form) {
  switch (form) {
    case ClosedForm::classical:
      return "classical";
    case ClosedForm::completed_massless:
      return "completed-massless";
    case ClosedForm::completed:
      return "completed";
    case ClosedForm::sarvi:
      return "sarvi";
    case ClosedForm::sarvi_modal:
      return "sarvi-modal";
  }
  return "";
}

// (x cos x - sin x)/(x cos x), x cos x - sin x = -x^3/3 (1 - x^2/10 + x^4/280 - ...).
C one_minus_tanc(C x) {
  if (std::abs(x) > 0.5) return 1.0 - std::tan(x) / x;
  const C q = x * x;
  const C series = 1.0 - q / 10.0 * (1.0 - q / 28.0 * (1.0 - q / 54.0 * (1.0 - q / 88.0 * (1.0 - q / 130.0))));
  return -q / 3.0 * series / std::cos(x);
}

ClosedStiffness::ClosedStiffness(const Statics& state, double alpha)
    : s_(state.form == Form::first_order ? state : at_horizontal_tension(state.guy, state.horizontal_tension, Form::first_order)) {
  if (!(alpha >= 0.0) || !std::isfinite(alpha)) throw std::invalid_argument(fmt::format("guy stiffness: alpha must be >= 0, got {:g}", alpha));
  const Guy& g = s_.guy;
  const double T = s_.mean_tension(), Lc = g.chord(), w = g.weight(), m = g.mass_per_length;
  w1_ = guy::string_frequency(s_, 1);
  k_ = g.taut_modulus();
  G_ = pi * pi * T * T * T / (w * w * Lc * Lc * Lc * k_);
  e_ = 0.5 * w * Lc * g.chord_sine() / T;
  alpha_ = alpha > 0.0 ? alpha : horizontal_modulus(s_) / k_;
  a_ = std::sqrt(alpha_ * g.axial_stiffness / m);
  b_ = std::sqrt(T / m);
  const GaussRule rule = gauss_legendre(nodes);
  for (int j = 0; j < nodes; ++j) {
    place_[j] = 0.5 * s_.length * (1.0 + rule.nodes[j]);
    weight_[j] = 0.5 * rule.weights[j];
  }
  const TransverseModes transverse(s_);
  for (int i = 1; i <= 8; ++i) {
    const TransverseMode mode = transverse.mode(i);
    modes_.push_back({mode.frequency(), mode.slope(1.0) / s_.length, {}});
    for (int j = 0; j < nodes; ++j) modes_.back().value[j] = mode.value(place_[j] / s_.length);
  }
  for (int j = 0; j < nodes; ++j) {
    const double slope = curve_at(s_, place_[j]).slope;
    curvature_[j] = w / s_.horizontal_tension / (1.0 + slope * slope);
  }
}

C ClosedStiffness::modulus(ClosedForm form, double p, double damping_rate) const {
  const C pe = damped_frequency(p, damping_rate);
  switch (form) {
    case ClosedForm::classical:
    case ClosedForm::completed_massless:
    case ClosedForm::completed:
      return kolousek_davenport(form, pe);
    case ClosedForm::sarvi:
      return sarvi(false, pe);
    case ClosedForm::sarvi_modal:
      return sarvi(true, pe);
  }
  return 0.0;
}

C ClosedStiffness::kolousek_davenport(ClosedForm form, C pe) const {
  const Guy& g = s_.guy;
  const C omega = pe / w1_, x = 0.5 * pi * omega, D = one_minus_tanc(x), softening = D / (G_ * omega * omega), lever = 1.0 - e_ * D;
  if (form == ClosedForm::classical) return k_ * lever / (1.0 - softening);
  const C X = pe * g.chord() * std::sqrt(g.mass_per_length / g.axial_stiffness);
  const C stretch = form == ClosedForm::completed ? std::tan(X) / X : C(1.0);
  const double sine = g.chord_sine();
  return k_ * lever * lever / (stretch - softening) + s_.mean_tension() * sine * sine / g.chord() * 2.0 * x / std::tan(2.0 * x);
}

// tau(L) cos gamma_L + T_e(L) eta'(L) sin gamma_L for a unit horizontal displacement, (5.122) with (4.58).
C ClosedStiffness::sarvi(bool modal, C pe) const {
  const double cosine = s_.horizontal_tension / s_.upper_tension;
  const double slope = curve_at(s_, s_.length).slope, sine = slope * cosine;
  const C tau = alpha_ * s_.guy.axial_stiffness * cosine * pe / a_ / std::tan(pe * s_.length / a_);
  const C eta = modal ? modal_top_slope(pe, cosine, sine) : top_slope(pe, cosine, sine);
  return tau * cosine + s_.upper_tension * eta * sine;
}

C ClosedStiffness::top_slope(C pe, double dt, double dn) const {
  const double T = s_.mean_tension(), R = T * T / (s_.guy.weight() * s_.horizontal_tension), L = s_.length;
  const C ka = pe / a_, kb = pe / b_;
  const C c = alpha_ * s_.guy.axial_stiffness / (s_.guy.mass_per_length * R) * dt / ((a_ * a_ - b_ * b_) * ka * std::sin(ka * L));
  return (dn - c * (std::cos(ka * L) - std::cos(kb * L))) * kb / std::tan(kb * L) - c * (ka * std::sin(ka * L) - kb * std::sin(kb * L));
}

C ClosedStiffness::modal_top_slope(C pe, double dt, double dn) const {
  const double L = s_.length, m = s_.guy.mass_per_length, tension_slope = (s_.upper_tension - s_.lower_tension) / L;
  const C ka = pe / a_, drive = -alpha_ * s_.guy.axial_stiffness * dt * ka / std::sin(ka * L);
  std::array<C, nodes> load;  // f(s), (5.88), with the weights
  for (int j = 0; j < nodes; ++j)
    load[j] = weight_[j] * (drive * curvature_[j] * std::cos(ka * place_[j]) + dn / L * (tension_slope + m * pe * pe * place_[j]));
  C slope = dn / L;
  for (const Mode& mode : modes_) {
    C work = 0.0;
    for (int j = 0; j < nodes; ++j) work += mode.value[j] * load[j];
    slope += mode.end_slope * work / (m * (mode.frequency * mode.frequency - pe * pe));
  }
  return slope;
}

C ClosedStiffness::out_of_plane(double p, double damping_rate) const {
  const C pe = damped_frequency(p, damping_rate);
  const double L = s_.length, T0 = s_.lower_tension, TL = s_.upper_tension, rise = (TL - T0) / L;
  const C travel = 2.0 * pe * L * std::sqrt(s_.guy.mass_per_length) / (std::sqrt(T0) + std::sqrt(TL));  // f_L - f_0
  if (std::abs(std::sqrt(TL / T0) - 1.0) < 1e-9) return s_.mean_tension() / L * travel / std::tan(travel);
  // f = 2 p_e sqrt(m T)/T'; for a far end below the anchor both change sign, and the signs cancel in K_z.
  const double root_m = 2.0 * std::sqrt(s_.guy.mass_per_length) / std::abs(rise);
  const C f0 = pe * root_m * std::sqrt(T0), fL = pe * root_m * std::sqrt(TL);
  // By Hankel functions a = f_0, b = f_L: [H1_1(b) H2_0(a) - H1_0(a) H2_1(b)] / [H1_0(b) H2_0(a) - H1_0(a) H2_0(b)], only e^{+-i(b - a)} left.
  const ScaledHankel a = scaled_hankel(f0), b = scaled_hankel(fL);
  const double sign = rise > 0.0 ? 1.0 : -1.0;
  const C up = std::exp(C(0.0, sign) * travel), down = 1.0 / up;
  const C slope = b.first_1 * a.second_0 * up - a.first_0 * b.second_1 * down;
  return -0.5 * fL * rise * slope / (b.first_0 * a.second_0 * up - a.first_0 * b.second_0 * down);
}

}  // namespace whirl::models::guy
