#pragma once
/// The two-mode cable under horizontal motion U cos(omega t) of its upper support, [NielsenKirkegaard2002, eqs (19), (23), (33), (35)].
///
///     q1 (out of plane), q2 (in plane), midspan displacements [m];  K = AE/(mu L^2),  e1 = (U/L) cos(theta) cos(omega t)
///     reduced:  b1 = K [ e1 c1 q1 + (G1 q1^2 + G2 q2^2) q1 / L^2 ]
///               b2 = K [ e1 c2 q2 + (G3 q1^2 + G4 q2^2) q2 / L^2 ]
///     full:     b1 += K [ (f/L) d1 q1 q2 / L + e.e C1 q1 ]
///               b2 += K [ (f/L) (d2 q1^2 + d3 q2^2) / L + (e.e + 2 e2^2) C4 q2 + 8 f a2 (e.e + 2 e2^2) ]
///     load:     F2 = U a (omega^2 sin(theta) - 16 (f/L) K cos(theta))
///
/// Both derive from a potential when damping, parametric and forcing terms are dropped (exact coefficients only).

#include "models/modal_coefficients.hpp"
#include "models/modal_system.hpp"

namespace whirl::models {

enum class Terms { reduced, full };

/// Everything the equations need of a stay, with its slopes if S is a dual.
template <class S>
struct StayModel {
  Parabola<S> shape;
  Modes<S> modes;
  ModalCoefficients<S> coefficients;
};

template <class S>
StayModel<S> stay_model(const Cable<S>& cable, Coefficients choice) {
  const Modes<S> m = modes(cable);
  return {parabola(cable), m, modal_coefficients(m, choice)};
}

template <class S>
S stiffness_rate(const Cable<S>& c) {  // K = AE/(mu L^2) [1/s^2]
  return c.axial_stiffness / (c.mass_per_length * c.chord_length * c.chord_length);
}

/// Modal load F2 of (33) [m/s^2].
template <class S>
S in_plane_load(const StayParameters<S>& p, const StayModel<S>& model) {
  using std::cos;
  using std::sin;
  const S theta = p.cable.inclination_deg * (pi / 180.0);
  return p.support_amplitude * model.coefficients.a2 *
         (p.omega * p.omega * sin(theta) - model.shape.sag_ratio * 16.0 * stiffness_rate(p.cable) * cos(theta));
}

/// Into `s`, whose memory is used again.
template <class S>
void nielsen_kirkegaard(const StayParameters<S>& p, const StayModel<S>& model, Terms terms, ModalSystem<S>& s) {
  using std::cos;
  using std::sin;
  const auto& k = model.coefficients;
  const S L = p.cable.chord_length, K = stiffness_rate(p.cable), KL2 = K / (L * L);
  const S theta = p.cable.inclination_deg * (pi / 180.0), E = p.support_amplitude / L, E1 = E * cos(theta), E2 = E * sin(theta);
  const S w1 = model.modes.omega1, w2 = model.modes.omega2;
  s.omega = p.omega;
  s.damping.assign({p.damping_out_of_plane * w1 * 2.0, p.damping_in_plane * w2 * 2.0});
  s.stiffness.assign({w1 * w1, w2 * w2});
  s.terms.clear();
  s.forces.clear();
  s.max_harmonic = 0;
  s.add_force(1, in_plane_load(p, model), 1);
  s.add_term(0, K * E1 * k.c1, {0}, 1);
  s.add_term(1, K * E1 * k.c2, {1}, 1);
  s.add_term(0, KL2 * k.G1, {0, 0, 0});
  s.add_term(0, KL2 * k.G2, {0, 1, 1});
  s.add_term(1, KL2 * k.G3, {0, 0, 1});
  s.add_term(1, KL2 * k.G4, {1, 1, 1});
  if (terms == Terms::full) {
    const S quadratic = K * model.shape.sag_ratio / L, ee = E * E * 0.5, ee2 = (E * E + E2 * E2 * 2.0) * 0.5;  // cos^2 = (1 + cos 2)/2
    s.add_term(0, quadratic * k.d1, {0, 1});
    s.add_term(1, quadratic * k.d2, {0, 0});
    s.add_term(1, quadratic * k.d3, {1, 1});
    for (int harmonic : {0, 2}) {
      s.add_term(0, K * ee * k.C1, {0}, harmonic);
      s.add_term(1, K * ee2 * k.C4, {1}, harmonic);
      s.add_force(1, -(K * model.shape.sag * k.a2 * ee2 * 8.0), harmonic);
    }
  }
}

template <class S>
ModalSystem<S> nielsen_kirkegaard(const StayParameters<S>& p, const StayModel<S>& model, Terms terms) {
  ModalSystem<S> s;
  nielsen_kirkegaard(p, model, terms, s);
  return s;
}

}  // namespace whirl::models
