#pragma once
/// The cable with any chosen modes, moved at one end in any direction, as a ModalSystem with sparse terms.
///
///     u = e x + sum_a phi_a(xi) q_a   out of plane and in plane, q [m];   e = (U_upper - U_lower)/L = E cos(omega t)
///     strain    eps = e1 + r s e2 + |e|^2/2 + sum_in (r s + e2) phi' p + sum_out e3 phi' p + (1/2) u'.u',   p = q/L, s = 4 (1 - 2 xi), r = f/L
///
/// Two treatments of the motion along the chord, by name:
///
///   galerkin       no longitudinal modes: eps uneven along the chord, V = (1/2) int eps^2 dxi, to first order in r,
///                  [NielsenKirkegaard2002, eqs (20)-(24)] for any number of modes; two modes: their eqs (33), (35) and (23)
///   quasi_static   the cable evens its tension out at once (longitudinal waves are far above the modes): V = (1/2) epsbar^2,
///                  epsbar = e1 + (e2^2 + e3^2)/2 + sum r t_a p_a + (1/2) sum S_ab p_a p_b,  stiffness AE/(1 + 8 r^2/3) as in lambda2
///
/// The cubic coefficient of one sine is 3 pi^4/8 in the first and pi^4/4 in the second, half as stiff again: see docs/kinds/mode-convergence.md.
/// Linear stiffness is that of the linear theory in both (omega_a^2, diagonal) or, for plain sines, the string's with the sag's coupling.
///
///     q_a'' + 2 zeta omega_a q_a' + omega_a^2 q_a + (K L/m_a) dV/dp_a = load_a cos(omega t),  K = AE/(mu L^2)
///     load_a = omega^2 U_i int phi_a (xi or 1 - xi)/m_a,  m_a = int phi_a^2                                                (20)
///
/// Coordinates: out of plane first, then in plane, each in the order given; q1, q2 of the two-mode stay are y1, z1.
///
///     CableModel m{.stay = stay, .out_of_plane = {1, 2}, .in_plane = {1, 2, 3}, .end = End::lower, .direction = Direction::vertical};
///     ParametricSystem system = cable_system(m, {Lens("omega")});
///     HarmonicBalance hb(system, {.harmonics = 10, .reflections = cable_reflections(m)});
///
/// Throws std::invalid_argument, one line, for modes given twice or out of range.

#include "models/harmonic_balance.hpp"

namespace whirl::models {

enum class Longitudinal { galerkin, quasi_static };
enum class Shapes { linear_modes, sines };
enum class End { lower, upper };
/// In the vertical plane of the chord, except `out_of_plane`. `chord`: lower to upper; `normal`: across, downwards.
enum class Direction { horizontal, vertical, chord, normal, out_of_plane };

struct CableModel {
  StayParameters<double> stay;
  std::vector<int> out_of_plane = {1};  ///< half waves k of the taut string's sin(k pi xi) that each mode comes from
  std::vector<int> in_plane = {1};      ///< odd: symmetric modes, even: antisymmetric
  Longitudinal longitudinal = Longitudinal::galerkin;
  Shapes shapes = Shapes::linear_modes;
  Terms terms = Terms::full;
  End end = End::upper;
  Direction direction = Direction::horizontal;

  int size() const { return static_cast<int>(out_of_plane.size() + in_plane.size()); }
  std::vector<std::string> coordinates() const;  ///< "y1", ..., "z1", ...
  void validate() const;
};

/// The lowest `count` half-wave numbers, 1, 2, ...
std::vector<int> lowest_half_waves(int count);

ParametricSystem cable_system(const CableModel& model, const std::vector<Lens>& lenses);
ModalSystem<double> cable_equations(const CableModel& model);

/// "WH": all out-of-plane coordinates change sign, where the support moves in plane; none otherwise.
std::vector<CoordinateReflection> cable_reflections(const CableModel& model);

/// Displacements (v down across the chord, w out of plane) of the modes at xi, without the support's motion.
struct Displacement {
  double in_plane, out_of_plane;
};
Displacement displacement(const CableModel& model, In q, double xi);
/// phi_a(xi) of every coordinate.
Vector shapes_at(const CableModel& model, double xi);
/// Tension averaged along the chord [N]; `phase` = omega t. What does not move is computed once: for many instants of one cable.
class CableTension {
 public:
  explicit CableTension(const CableModel& model);
  double operator()(In q, double phase) const;

 private:
  double at_rest_, stiffness_;  // N
  double along_, across_;       // strain of the support's displacement, and half its square
  Vector pull_;                 // strain of each mode at the sag [1/m]
  Matrix stretch_;              // strain of pairs of modes [1/m^2]
};
double mean_tension(const CableModel& model, In q, double phase);

}  // namespace whirl::models
