#pragma once
/// Averaged superharmonic response of order n >= 2, [NielsenKirkegaard2002, eqs (36)-(45)] with cos 2Phi in the last of (41) and P_3 = gamma4 B0^3
/// / 3.
///
///     q1 = Re[ Z1 e^{i n w t} ],   q2 = Re[ Z0 e^{i w t} + Z2 e^{i n w t} ],   Z1 = A e^{i Psi1}, Z2 = B e^{i Psi2}
///     Z0 = B0 e^{i Psi0} = F2 / (w2^2 - w^2 + 2 i z2 w2 w)                                 linear forced response, frozen
///
///     2 n w Z1' = -2 z1 w1 n w Z1 + i [ (D1 + g1 |Z1|^2 + 2 g2 |Z2|^2) Z1 + g2 Z2^2 conj(Z1) ]
///     2 n w Z2' = -2 z2 w2 n w Z2 + i [ (D2 + g4 |Z2|^2 + 2 g3 |Z1|^2) Z2 + g3 Z1^2 conj(Z2) + E_n ]
///     D1 = w1^2 - n^2 w^2 + 2 g2 |Z0|^2,  D2 = w2^2 - n^2 w^2 + 2 g4 |Z0|^2,  E_2 = beta2 Z0, E_3 = g4 Z0^3 / 3, E_n = 0 above
///
/// State in Cartesian van der Pol coordinates x = (u1, v1, u2, v2), Z = u + i v: regular at A = 0, where whirling is born.
/// The field is symmetric under (u1, v1) -> -(u1, v1); breaking it is whirling, subtype "WH".
///
///     SuperharmonicFlow flow(stay, {.order = 2}, {Lens("omega")});
///     flow.residual(u, r);          // u = (u1, v1, u2, v2, omega), r = x' [m/s]

#include <complex>

#include "core/dual_problem.hpp"
#include "models/nielsen_kirkegaard.hpp"

namespace whirl::models {

struct SuperharmonicOptions {
  int order = 2;
  Coefficients coefficients = Coefficients::exact;
  void validate() const;
};

/// Coefficients of the slow flow at one parameter record. All in s^-2 (detuning, damping), m^-2 s^-2 (gamma), m s^-2 (load).
template <class S>
struct SlowFlowCoefficients {
  S nw2;  ///< 2 n omega
  S detuning1, detuning2;
  S damping1, damping2;  ///< 2 z_a w_a n omega
  S g1, g2, g3, g4;
  S load_re, load_im;  ///< E_n
  S Z0_re, Z0_im;      ///< frozen linear response [m]
};

template <class S>
SlowFlowCoefficients<S> slow_flow_coefficients(const StayParameters<S>& p, const StayModel<S>& model, int order);

/// What of them only the cable decides. Load F2 = U (load_w2 w^2 + load), parametric part beta2 = U beta.
template <class S>
struct CableNumbers {
  S w1, w2, g1, g2, g3, g4, load_w2, load, beta;
};

/// The field with x and the coefficients in scalars whose product is R.
template <class R, class S>
void slow_flow(const SlowFlowCoefficients<S>& c, const R& u1, const R& v1, const R& u2, const R& v2, std::span<R> r) {
  const R a = u1 * u1 + v1 * v1, b = u2 * u2 + v2 * v2;
  const R s1 = u1 * u1 - v1 * v1, t1 = u1 * v1 * 2.0, s2 = u2 * u2 - v2 * v2, t2 = u2 * v2 * 2.0;  // Z^2 = s + i t
  const R m1 = a * c.g1 + b * (c.g2 * 2.0) + c.detuning1, m2 = b * c.g4 + a * (c.g3 * 2.0) + c.detuning2;
  const S scale = 1.0 / c.nw2;
  r[0] = (-(u1 * c.damping1) - m1 * v1 - (t2 * u1 - s2 * v1) * c.g2) * scale;
  r[1] = (-(v1 * c.damping1) + m1 * u1 + (s2 * u1 + t2 * v1) * c.g2) * scale;
  r[2] = (-(u2 * c.damping2) - m2 * v2 - (t1 * u2 - s1 * v2) * c.g3 - c.load_im) * scale;
  r[3] = (-(v2 * c.damping2) + m2 * u2 + (s1 * u2 + t1 * v2) * c.g3 + c.load_re) * scale;
}

/// What the lenses turn: parameters to coefficients to field, in any scalar.
class SuperharmonicModel {
 public:
  SuperharmonicModel(const StayParameters<double>& stay, const SuperharmonicOptions& options, std::vector<Lens> lenses);

  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    slow_flow<S, S>(coefficients<S>(u.subspan(4)), u[0], u[1], u[2], u[3], r);
  }

  /// Slow-flow coefficients with the lenses' parameters at p.
  template <class S>
  SlowFlowCoefficients<S> coefficients(std::span<const S> p) const;

  const StayParameters<double>& stay() const { return stay_; }
  const std::vector<Lens>& lenses() const { return lenses_; }
  bool cable_moves() const { return cable_moves_; }  ///< a lens turns a number of the cable, and with it the cubic terms
  int order() const { return options_.order; }

 private:
  StayParameters<double> stay_;
  SuperharmonicOptions options_;
  std::vector<Lens> lenses_;
  StayModel<double> model_;
  CableNumbers<double> cable_;
  bool cable_moves_ = false;
  struct Moves {
    bool z1, z2, U, w;
  };
  std::vector<Moves> moves_;  // what each lens turns, where none moves the cable
};

/// Amplitudes and phases of a state: what a person reads.
struct Superharmonic {
  double A, B;        ///< amplitude of cos(n w t + Psi) in q1, q2 [m]
  double Psi1, Psi2;  ///< [rad]
  double B0, Psi0;    ///< linear part of q2, cos(w t + Psi0) [m, rad]
};

class SuperharmonicFlow : public DualProblem<SuperharmonicModel> {
 public:
  SuperharmonicFlow(const StayParameters<double>& stay, const SuperharmonicOptions& options, std::vector<Lens> lenses);

  Superharmonic observe(In u) const;
  /// q1, q2 and their rates of the ansatz at time t: size 4.
  Vector motion(In u, double t) const;

 private:
  // Hand-written: the dual sweep costs five times as much. Tested against it.
  void do_residual(In u, Out r) const override;
  void do_jacobian(In u, MatrixOut j) const override;
  void do_linearise(In u, Out r, MatrixOut j) const override;
  void do_second(In u, In v, MatrixOut h) const override;
  /// Field and Jacobian (4 x (4 + K), by columns) in R = double, or along a vector.
  template <int K, class R>
  void evaluate(const R* u, R* r, R* j) const;
  template <int K>
  void field_and_jacobian(In u, double* r, MatrixOut j) const;
  template <int K>
  void second_along(In u, In v, MatrixOut h) const;
};

// ---------------------------------------------------------------------------------------------------------------------------

template <class S>
CableNumbers<S> cable_numbers(const Cable<S>& cable, const StayModel<S>& model) {
  using std::cos;
  using std::sin;
  const auto& k = model.coefficients;
  const S K = stiffness_rate(cable), KL2 = K / (cable.chord_length * cable.chord_length), theta = cable.inclination_deg * (pi / 180.0);
  return {model.modes.omega1,
          model.modes.omega2,
          KL2 * k.G1 * 0.75,
          KL2 * k.G2 * 0.25,
          KL2 * k.G3 * 0.25,
          KL2 * k.G4 * 0.75,
          k.a2 * sin(theta),
          -(k.a2 * model.shape.sag_ratio * 16.0 * K * cos(theta)),
          K * 0.5 / cable.chord_length * cos(theta) * k.c2};
}

/// z1, z2: damping ratios, U: support amplitude, w: frequency. Each S where a lens moves it, double where none does: that is half the work.
template <class S, class T, class Z, class A, class W>
SlowFlowCoefficients<S> slow_flow_coefficients(const CableNumbers<T>& k, const Z& z1, const Z& z2, const A& U, const W& w, int order) {
  const double n = order;
  SlowFlowCoefficients<S> c;
  c.nw2 = S(w * (2.0 * n));
  c.damping1 = z1 * k.w1 * c.nw2;
  c.damping2 = z2 * k.w2 * c.nw2;
  c.g1 = S(k.g1);
  c.g2 = S(k.g2);
  c.g3 = S(k.g3);
  c.g4 = S(k.g4);
  // Z0 = F2 (x - i y) / (x^2 + y^2)
  const auto w_squared = w * w, nw_squared = w_squared * (n * n);
  const auto x = k.w2 * k.w2 - w_squared;
  const auto y = z2 * k.w2 * w * 2.0;
  const S scale(U * (w_squared * k.load_w2 + k.load) / (x * x + y * y));
  c.Z0_re = scale * x;
  c.Z0_im = -(scale * y);
  const S Z0Z0 = c.Z0_re * c.Z0_re + c.Z0_im * c.Z0_im;
  c.detuning1 = k.w1 * k.w1 - nw_squared + Z0Z0 * k.g2 * 2.0;
  c.detuning2 = k.w2 * k.w2 - nw_squared + Z0Z0 * k.g4 * 2.0;
  c.load_re = c.load_im = S(0.0);
  if (order == 2) {
    const S beta2(U * k.beta);
    c.load_re = beta2 * c.Z0_re;
    c.load_im = beta2 * c.Z0_im;
  } else if (order == 3) {
    const S g = c.g4 / 3.0;
    c.load_re = g * (c.Z0_re * c.Z0_re - c.Z0_im * c.Z0_im * 3.0) * c.Z0_re;
    c.load_im = g * (c.Z0_re * c.Z0_re * 3.0 - c.Z0_im * c.Z0_im) * c.Z0_im;
  }
  return c;
}

template <class S>
SlowFlowCoefficients<S> slow_flow_coefficients(const StayParameters<S>& p, const StayModel<S>& model, int order) {
  return slow_flow_coefficients<S>(cable_numbers(p.cable, model), p.damping_out_of_plane, p.damping_in_plane, p.support_amplitude, p.omega, order);
}

template <class S>
SlowFlowCoefficients<S> SuperharmonicModel::coefficients(std::span<const S> p) const {
  if (cable_moves_) {
    StayParameters<S> record = promote<S>(stay_);
    for (std::size_t i = 0; i < lenses_.size(); ++i) lenses_[i].set(record, p[i]);
    return slow_flow_coefficients(record, stay_model(record.cable, options_.coefficients), options_.order);
  }
  // Only numbers that leave statics and modes alone: what the constructor computed holds.
  if (moves_.size() == 1 && moves_[0].w)
    return slow_flow_coefficients<S>(cable_, stay_.damping_out_of_plane, stay_.damping_in_plane, stay_.support_amplitude, p[0], options_.order);
  S z1(stay_.damping_out_of_plane), z2(stay_.damping_in_plane), U(stay_.support_amplitude), w(stay_.omega);
  for (std::size_t i = 0; i < lenses_.size(); ++i) {
    if (moves_[i].z1) z1 = p[i];
    if (moves_[i].z2) z2 = p[i];
    if (moves_[i].U) U = p[i];
    if (moves_[i].w) w = p[i];
  }
  return slow_flow_coefficients<S>(cable_, z1, z2, U, w, options_.order);
}

}  // namespace whirl::models
