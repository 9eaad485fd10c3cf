#pragma once
/// The combinatorial response (3,2) by the truncated averaged equations of the paper, [NielsenKirkegaard2002, eqs (61)-(65)] coupled and (71)-(73) in
/// plane: of the exact projection only the terms kept there, with 2 gamma4 B1 B2^2 in (64) for the misprinted 4 gamma4 B1 B2^2.
///
///     q1 = Re[ Z1 e^{i w t/2} + Z3 e^{3 i w t/2} ],  q2 = B0 + Re[ Y1 e^{i w t} + Y2 e^{2 i w t} ]                                    (60)
///       b(Z1) = [g1 (|Z1|^2 + 2 |Z3|^2) + g2 (4 B0^2 + 2 |Y1|^2 + 2 |Y2|^2)] Z1 + beta1 (conj Z1 + Z3)
///       b(Z3) = [g1 (|Z3|^2 + 2 |Z1|^2) + g2 (4 B0^2 + 2 |Y1|^2 + 2 |Y2|^2)] Z3 + beta1 Z1
///       b(B0) = beta2 Re Y1 + g4 B0 (4/3 B0^2 + 2 |Y1|^2 + 2 |Y2|^2) + 2 g3 B0 (|Z1|^2 + |Z3|^2)
///       b(Y1) = [g4 (|Y1|^2 + 4 B0^2 + 2 |Y2|^2) + 2 g3 (|Z1|^2 + |Z3|^2)] Y1 + beta2 (2 B0 + Y2)
///       b(Y2) = [g4 (|Y2|^2 + 4 B0^2 + 2 |Y1|^2) + 2 g3 (|Z1|^2 + |Z3|^2)] Y2 + beta2 Y1
///     q2 = Re[ X1 e^{i w t/2} + X2 e^{i w t} + X3 e^{3 i w t/2} ]                                                                    (70)
///       b(X1) = g4 (|X1|^2 + 2 |X2|^2 + 2 |X3|^2) X1 + beta2 (conj X1 + X3)
///       b(X2) = g4 (|X2|^2 + 2 |X1|^2 + 2 |X3|^2) X2 + 2 g4 X1 X3 conj X2
///       b(X3) = g4 (|X3|^2 + 2 |X1|^2 + 2 |X2|^2) X3 + beta2 X1
///
/// b stands for 2 <b e^{-i k w t}> of SlowFlow, its means for <b>; flow and state are those of SlowFlow on the same ansatz.
///
///     PrintedCombinatorialFlow flow(stay_system(stay, {Lens("omega")}, Terms::reduced, Coefficients::exact), CombinatorialMotion::coupled);
///
/// Throws std::invalid_argument for a system other than the reduced coupling (35).

#include "models/slow_flow/slow_flow.hpp"

namespace whirl::models {

enum class CombinatorialMotion { coupled, in_plane };

/// beta and gamma of [NielsenKirkegaard2002, eqs (43), (44)], read off the terms of a modal system.
template <class S>
struct ReducedCoupling {
  S beta1, beta2, g1, g2, g3, g4, load;
};

class PrintedCombinatorialModel {
 public:
  PrintedCombinatorialModel(const ParametricSystem& system, CombinatorialMotion motion);
  const ParametricSystem& system() const { return system_; }
  CombinatorialMotion motion() const { return motion_; }
  const Ansatz& ansatz() const { return ansatz_; }

  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const;

 private:
  template <class S>
  static ReducedCoupling<S> coupling_of(const ModalSystem<S>& system);

  ParametricSystem system_;
  CombinatorialMotion motion_;
  Ansatz ansatz_;
  mutable std::tuple<SystemRoom<double>, SystemRoom<Dual<double, 8>>, SystemRoom<Dual<ParametricSystem::Along, 8>>,
                     SystemRoom<ParametricSystem::Triple>>
      rooms_;
};

class PrintedCombinatorialFlow : public DualProblem<PrintedCombinatorialModel> {
 public:
  PrintedCombinatorialFlow(const ParametricSystem& system, CombinatorialMotion motion);
  const Ansatz& ansatz() const { return model().ansatz(); }
};

// ---------------------------------------------------------------------------------------------------------------------------

template <class S>
ReducedCoupling<S> PrintedCombinatorialModel::coupling_of(const ModalSystem<S>& system) {
  const auto& t = system.terms;  // the constructor has seen that they stand in this order
  return {t[0].coefficient * 0.5,  t[1].coefficient * 0.5,  t[2].coefficient * 0.75,   t[3].coefficient * 0.25,
          t[4].coefficient * 0.25, t[5].coefficient * 0.75, system.forces[0].amplitude};
}

template <class S>
void PrintedCombinatorialModel::residual(std::span<const S> u, std::span<S> r) const {
  const auto& system = std::get<SystemRoom<S>>(rooms_).fill(system_, u.subspan(static_cast<std::size_t>(ansatz_.size())));
  const ReducedCoupling<S> c = coupling_of(system);
  const auto square = [&](int i) { return u[std::size_t(i)] * u[std::size_t(i)] + u[std::size_t(i + 1)] * u[std::size_t(i + 1)]; };
  // Rows of harmonic k of coordinate a from the projection (re, im) of its terms: i R / (2 k w).
  const auto oscillating = [&](int at, int a, double k, const S& re, const S& im) {
    const S speed = system.omega * k, D = system.stiffness[std::size_t(a)] - speed * speed, E = system.damping[std::size_t(a)] * speed;
    const S &x = u[std::size_t(at)], &y = u[std::size_t(at + 1)];
    r[std::size_t(at)] = -(D * y + E * x + im) / (speed * 2.0);
    r[std::size_t(at + 1)] = (D * x - E * y + re) / (speed * 2.0);
  };
  if (motion_ == CombinatorialMotion::coupled) {
    const S &u1 = u[0], &v1 = u[1], &u3 = u[2], &v3 = u[3], &B = u[4], &x1 = u[5], &y1 = u[6], &x2 = u[7], &y2 = u[8];
    const S Z1 = square(0), Z3 = square(2), Y1 = square(5), Y2 = square(7), B2 = B * B;
    const S in_plane = c.g2 * (B2 * 4.0 + Y1 * 2.0 + Y2 * 2.0), across = c.g3 * (Z1 + Z3) * 2.0;
    const S m1 = c.g1 * (Z1 + Z3 * 2.0) + in_plane, m3 = c.g1 * (Z3 + Z1 * 2.0) + in_plane;
    const S n1 = c.g4 * (Y1 + B2 * 4.0 + Y2 * 2.0) + across, n2 = c.g4 * (Y2 + B2 * 4.0 + Y1 * 2.0) + across;
    oscillating(0, 0, 0.5, m1 * u1 + c.beta1 * (u1 + u3), m1 * v1 + c.beta1 * (v3 - v1));
    oscillating(2, 0, 1.5, m3 * u3 + c.beta1 * u1, m3 * v3 + c.beta1 * v1);
    const S mean = system.stiffness[1] * B + c.beta2 * x1 + c.g4 * B * (B2 * (4.0 / 3.0) + Y1 * 2.0 + Y2 * 2.0) + across * B;
    r[4] = -mean / mean_rate(system.damping[1], system.omega);
    oscillating(5, 1, 1.0, n1 * x1 + c.beta2 * (B * 2.0 + x2) - c.load, n1 * y1 + c.beta2 * y2);
    oscillating(7, 1, 2.0, n2 * x2 + c.beta2 * x1, n2 * y2 + c.beta2 * y1);
  } else {
    const S &x1 = u[0], &y1 = u[1], &x2 = u[2], &y2 = u[3], &x3 = u[4], &y3 = u[5];
    const S X1 = square(0), X2 = square(2), X3 = square(4);
    const S m1 = c.g4 * (X1 + X2 * 2.0 + X3 * 2.0), m2 = c.g4 * (X2 + X1 * 2.0 + X3 * 2.0), m3 = c.g4 * (X3 + X1 * 2.0 + X2 * 2.0);
    const S re = x1 * x3 - y1 * y3, im = x1 * y3 + y1 * x3, g = c.g4 * 2.0;  // X1 X3
    oscillating(0, 1, 0.5, m1 * x1 + c.beta2 * (x1 + x3), m1 * y1 + c.beta2 * (y3 - y1));
    oscillating(2, 1, 1.0, m2 * x2 + g * (re * x2 + im * y2) - c.load, m2 * y2 + g * (im * x2 - re * y2));
    oscillating(4, 1, 1.5, m3 * x3 + c.beta2 * x1, m3 * y3 + c.beta2 * y1);
  }
}

}  // namespace whirl::models
