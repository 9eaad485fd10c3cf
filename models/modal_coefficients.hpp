#pragma once
/// Coupling coefficients of the two-mode cable, by quadrature of their definitions [NielsenKirkegaard2002, eq. (24)], all
/// divided by twice the modal integral m_a = int phi_a^2 and made dimensionless (derivatives with respect to xi, s = 4 (1 - 2 xi)):
///
///     c_a = int phi_a'^2 / m_a                                    C1..C4, G1..G4, d1..d3, a1, a2: beside their fields
///
/// `as_printed` gives the closed forms (A7) as the paper evaluates them, on the misprinted modal mass 2W + W cos W - 2 sin W.

#include "models/statics.hpp"

namespace whirl::models {

enum class Coefficients { exact, as_printed };

template <class S>
struct ModalCoefficients {
  S m1, m2;          ///< int phi_a^2; modal mass M_a = mu L m_a
  S a1, a2;          ///< int phi_a' s / (16 m_a); a2 is also the load factor a of (33)
  S c1, c2;          ///< parametric stretching
  S d1, d2, d3;      ///< quadratic: q1 q2 | q1^2, q2^2
  S C1, C2, C3, C4;  ///< quadratic parametric
  S G1, G2, G3, G4;  ///< cubic: q1^3, q1 q2^2 | q1^2 q2, q2^3
};

template <class S>
ModalCoefficients<S> quadrature_coefficients(const Modes<S>& modes) {
  const auto mean = [&](auto f) { return integrate<S>([&](double xi) { return f(xi, modes.phi1_slope(xi), modes.phi2_slope(xi)); }); };
  const auto s = [](double xi) { return 4.0 * (1.0 - 2.0 * xi); };
  ModalCoefficients<S> k;
  k.m1 = S(0.5);
  k.m2 = integrate<S>([&](double xi) { return modes.phi2(xi) * modes.phi2(xi); });
  const S s11 = mean([](double, S f, S) { return f * f; }), s22 = mean([](double, S, S g) { return g * g; });
  const S s12 = mean([](double, S f, S g) { return f * g; });
  const S t1 = mean([&](double xi, S f, S) { return f * s(xi); }), t2 = mean([&](double xi, S, S g) { return g * s(xi); });
  const S u12 = mean([&](double xi, S f, S g) { return f * f * g * s(xi); }), u222 = mean([&](double xi, S, S g) { return g * g * g * s(xi); });
  const S q1111 = mean([](double, S f, S) { return f * f * f * f; }), q1122 = mean([](double, S f, S g) { return f * f * g * g; });
  const S q2222 = mean([](double, S, S g) { return g * g * g * g; });
  k.a1 = t1 / (k.m1 * 16.0);
  k.a2 = t2 / (k.m2 * 16.0);
  k.c1 = s11 / k.m1;
  k.c2 = s22 / k.m2;
  k.d1 = u12 / k.m1;
  k.d2 = u12 / (k.m2 * 2.0);
  k.d3 = u222 * 3.0 / (k.m2 * 2.0);
  k.C1 = s11 / (k.m1 * 2.0);
  k.C2 = s12 / (k.m1 * 2.0);
  k.C3 = s12 / (k.m2 * 2.0);
  k.C4 = s22 / (k.m2 * 2.0);
  k.G1 = q1111 / (k.m1 * 2.0);
  k.G2 = q1122 / (k.m1 * 2.0);
  k.G3 = q1122 / (k.m2 * 2.0);
  k.G4 = q2222 / (k.m2 * 2.0);
  return k;
}

/// The paper's closed forms: the modal mass N of (30) and (A7) with `mass_factor` sin W, 2 as printed, 3 as derived. With 3, and
/// `printed_exchange` false, these equal the quadrature to rounding, which is how they are tested. Singular at W = pi (taut string).
template <class S>
ModalCoefficients<S> closed_form_coefficients(const S& W, double mass_factor, bool printed_exchange) {
  using std::cos;
  using std::sin;
  const S s = sin(W * 0.5), c = cos(W * 0.5), sW = sin(W), W2 = W * W, W3 = W2 * W, q = S(1.0) - c;
  const S N = W * 2.0 + W * cos(W) - sW * mass_factor;
  const double pi2 = pi * pi;
  const S D = S(4.0 * pi2) - W2;
  const S J = s * 2.0 * (S(1.0) / W2 + (W2 + 4.0 * pi2) / (D * D)) - c * (S(1.0) / W - W / D);
  const S P = W2 - pi2;
  const S E = S(1.0) - (W2 * 2.0 - pi2) * sW / (P * W);
  ModalCoefficients<S> k;
  k.m1 = S(0.5);
  k.m2 = N / (W * q * q) * 0.5;
  k.a1 = S(2.0 / pi);
  k.a2 = (s * 2.0 - W * c) * q / N;
  k.c1 = S(pi2);
  k.c2 = W2 * (W - sW) / N;
  k.d1 = W / q * J * (8.0 * pi2);
  k.d2 = W2 * q / N * J * (4.0 * pi2);
  k.d3 = W2 * 8.0 / (q * N) * (s * 2.0 * (s * s / 3.0 + 2.0) - W * c * (S(3.0) - c * c));
  k.C1 = S(0.5 * pi2);
  k.C2 = (printed_exchange ? W * pi2 : W2 * pi) * -2.0 * c / (q * P);
  k.C3 = (printed_exchange ? W2 * pi2 : W3 * pi) * -2.0 * q * c / (N * P);
  k.C4 = k.c2 * 0.5;
  k.G1 = S(0.375 * pi2 * pi2);
  k.G2 = W2 / (q * q) * E * (0.25 * pi2);
  k.G3 = W3 / N * E * (0.25 * pi2);
  k.G4 = W2 * W2 / (q * q) * (W * 6.0 - sW * 8.0 + sin(W * 2.0)) / N / 16.0;
  return k;
}

template <class S>
ModalCoefficients<S> modal_coefficients(const Modes<S>& modes, Coefficients choice) {
  switch (choice) {
    case Coefficients::exact:
      return quadrature_coefficients(modes);
    case Coefficients::as_printed:
      return closed_form_coefficients(modes.frequency_number, 2.0, true);
  }
  return {};
}

}  // namespace whirl::models
