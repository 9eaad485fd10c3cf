#pragma once
/// Steady motion of a hanging cable whose ends move harmonically, any sag, elasticity and drag; any periodic motion by superposition.
///
///     (K + L1 MU + L2 MV) q = -(K_lift + L1 MU_lift + L2 MV_lift) e,     L_i = -w^2 + i eta_i w,  e = (U1, V1, U2, V2)
///
/// with the matrices of galerkin.hpp: one LU factorisation a frequency. Motion is Re[field exp(i w t)]. [Gale1976, sec. II.4.3] has tangential motion
/// of one end of an undamped inextensible cable; his program forgets the sign of odd derivatives beyond xi = -0.7, which spoils most of his Table
/// C-2.
///
///     ForcedSolver solver(core, 6.0);                                   // frequencies up to 6 sqrt(g/a)
///     ForcedMotion motion = solver.at(2.0, {.U2 = 0.01});
///     Peak T = PeakFinder(solver.mesh()).largest(motion.in_plane, Quantity::T);      // T.value at T.x
///
/// At a natural frequency of an undamped cable the motion is unbounded: the values are then huge, or not finite.
/// Throws std::invalid_argument for a negative or too high frequency.

#include "models/catenary/modes.hpp"

namespace whirl::models::catenary {

/// Amplitudes of the ends in units of a: tangential, normal, out of plane; 1 lower, 2 upper end.
struct EndMotion {
  std::complex<double> U1 = 0.0, V1 = 0.0, W1 = 0.0, U2 = 0.0, V2 = 0.0, W2 = 0.0;
};
/// Tangential and normal parts of a horizontal and a vertical displacement at x: tangent (1, sinh x)/cosh x, normal (-sinh x, 1)/cosh x.
struct TangentNormal {
  std::complex<double> tangential, normal;
};
TangentNormal turned(double x, std::complex<double> horizontal, std::complex<double> vertical);

struct ForcedMotion {
  double omega;
  Field<std::complex<double>> in_plane, lateral;  ///< U, V, N, T and W, W_x
};

class ForcedSolver {
 public:
  /// Resolves motion up to `largest_omega`.
  ForcedSolver(const CoreCable& cable, double largest_omega);
  ForcedMotion at(double omega, const EndMotion& ends) const;
  int functions() const { return g_.functions(); }
  const Mesh& mesh() const { return g_.mesh(); }

 private:
  CoreCable cable_;
  double largest_omega_;
  InPlaneGalerkin g_;
  LateralGalerkin lateral_;
  Matrix K_, MU_, MV_, K_lift_, MU_lift_, MV_lift_;
};

/// A largest value and where.
struct Peak {
  double value = 0.0, x = 0.0;
};
/// The largest of cosh x + |T|, static and dynamic tension together, and the smallest of cosh x - |T|: below 0 the cable goes slack.
struct TotalTension {
  Peak largest, smallest;
};

/// Finds largest values along the cable, between points too: sampled, then refined to 1e-10. One object serves all fields of a solver.
class PeakFinder {
 public:
  explicit PeakFinder(const Mesh& mesh);
  /// Of the modulus of one quantity.
  Peak largest(const Field<std::complex<double>>& field, Quantity quantity) const;
  TotalTension total_tension(const Field<std::complex<double>>& field) const;

 private:
  template <class F>
  Peak maximum(const Vector& values, F&& f) const;
  Vector x_, c_;
  Matrix legendre_;
};

/// Sum over harmonics of Re[value exp(i w_k t)] at given x (rows) and times (columns).
Matrix history(const std::vector<ForcedMotion>& motions, Quantity quantity, In x, In times, bool lateral = false);

}  // namespace whirl::models::catenary
