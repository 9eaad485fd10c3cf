#pragma once
/// TorusSystem: a periodic motion with a Floquet exponent i kappa, 0 < kappa < Omega (Neimark-Sacker). Its own regular system,
///
///     r_S(x, p) = 0,  Re g = Im g = 0      [ L(i kappa)   b ] [v]   [0]      L on block M; A + i kappa C - kappa^2 I of a system of second order, A
///     = r_x
///                                          [ c*           0 ] [g] = [1]      dg = -w* (D2r[v, .] + d(L - A) v),  dg/dkappa = -w* dL/dkappa v
///
/// S are the unknowns that the motion's symmetries leave, M the unknowns of the group of directions that loses stability. L(lambda) and C as in
/// core/orbit_problem.hpp. Unknowns (x_S, p1, kappa | p2 ...). v is the shape of the disturbance.
///
///     TorusSystem system(orbit, state, block, u, kappa);
///     NewtonResult at = newton(system, system.unknowns(u));

#include <Eigen/LU>

#include "continuation/augmented.hpp"
#include "core/orbit_problem.hpp"

namespace whirl::continuation {

class TorusSystem : public AugmentedSystem {
 public:
  /// u: a motion near the torus point, kappa: its exponent nearest the imaginary axis [rad/s].
  TorusSystem(const OrbitProblem& orbit, Indices state, Indices block, In u, double kappa);
  Vector unknowns(In u) const override;
  void update_borders(In y) override;
  double kappa(In y) const { return y[static_cast<int>(state_.size()) + 1]; }
  Eigen::VectorXcd null_vector(In y) const;  ///< v on all unknowns of the motion, unit length

 private:
  void solve_bordered(In y) const override;
  void fill_residual(In y, Out r) const override;
  void fill_jacobian(In y, MatrixOut j) const override;

  const OrbitProblem& orbit_;
  Indices block_;
  double kappa0_;
  Eigen::VectorXcd b_, c_;
  mutable Matrix h_im_;
  mutable Eigen::MatrixXcd shift_, by_kappa_;  // L - r_x and its slope
  mutable Eigen::MatrixXcd bordered_;
  mutable Eigen::PartialPivLU<Eigen::MatrixXcd> lu_;
  mutable Eigen::VectorXcd v_, w_;
  mutable Vector full_;
};

/// The unknowns of a group of directions at u.
Indices unknowns_of_group(const OrbitProblem& orbit, In u, int group);

/// Exponent i kappa of the pair of complex multipliers nearest the unit circle in `group` at u; 0 if the group has no such pair.
double torus_frequency(const OrbitProblem& orbit, In u, int group);

}  // namespace whirl::continuation
