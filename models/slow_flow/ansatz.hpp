#pragma once
/// Which harmonics a slow flow keeps, per coordinate, and how their amplitudes stand in its state.
///
///     q_i = sum over the list of coordinate i of  Re[ (u + i v) e^{i k omega t} ] = u cos(k omega t) - v sin(k omega t),   a mean B for k = 0
///
/// Harmonics are stored in units of omega/nu, ascending. State: coordinate after coordinate, harmonic after harmonic, B or (u, v), in m.
///
///     Ansatz a = Ansatz::list({{0.5, 1.5}, {0, 1, 2}});        // nu = 2; q1: 1/2, 3/2; q2: 0, 1, 2
///     a.index(1, 2);                                           // where (u, v) of cos(omega t) in q2 begin
///     amplitude(a, x, 1, 2);                                   // u + i v
///
/// Throws std::invalid_argument for lists that are empty altogether, repeat a harmonic, or hold one that is negative or no fraction with a
/// denominator up to 64.

#include "models/harmonic_balance.hpp"

namespace whirl::models {

struct Ansatz {
  int nu = 1;
  std::vector<std::vector<int>> harmonics;  ///< per coordinate, in units of omega/nu
  bool frozen = false;                      ///< forced harmonics outside the list stay in q as the linear response, [NielsenKirkegaard2002, eq. (34)]

  static Ansatz list(const std::vector<std::vector<double>>& multiples_of_omega, bool frozen = false);
  /// Harmonics 0..H of omega/nu in every coordinate.
  static Ansatz complete(int coordinates, int harmonics, int nu = 1);
  /// n omega in every coordinate, the linear response frozen, [NielsenKirkegaard2002, eq. (36)].
  static Ansatz superharmonic(int coordinates, int order);
  static Ansatz combinatorial_coupled();   ///< [NielsenKirkegaard2002, eq. (60)]
  static Ansatz combinatorial_in_plane();  ///< [NielsenKirkegaard2002, eq. (70)]

  int coordinates() const { return static_cast<int>(harmonics.size()); }
  int size() const;               ///< of the state
  int width(int i) const;         ///< numbers of coordinate i in the state
  int offset(int i) const;        ///< where they begin
  int index(int i, int k) const;  ///< of B, or of u with v behind it; -1 if harmonic k (in units of omega/nu) is not kept
  int highest() const;
  void validate() const;
};

/// u + i v, or the mean; 0 for a harmonic that is not kept.
std::complex<double> amplitude(const Ansatz& ansatz, In x, int i, int k);

/// (q, q') of the kept harmonics at time t.
Vector motion_at(const Ansatz& ansatz, In x, double omega, double t);

/// The kept harmonics of the response without terms, and of a settled motion. Throws std::invalid_argument if the motion does not repeat after nu
/// excitation periods.
Vector linear_state(const Ansatz& ansatz, const ModalSystem<double>& system);
Vector state_of(const Ansatz& ansatz, const SteadyMotion& motion);

/// The kept harmonics in the layout of HarmonicBalance and Floquet with harmonics 0..H of omega/nu, H >= highest().
Vector balance_state(const Ansatz& ansatz, In x, int H);

/// Mirror symmetries of any flow of this system on the ansatz: the coordinate reflections given (each checked), and the shift by half a base
/// period, by itself ("PD") or with signs ("SB"). Those that leave every kept harmonic in place, or repeat another, are left out.
std::vector<Reflection> reflections_of(const Ansatz& ansatz, const ModalSystem<double>& system, const std::vector<CoordinateReflection>& given);

}  // namespace whirl::models
