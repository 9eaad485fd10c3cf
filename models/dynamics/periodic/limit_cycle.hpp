#pragma once
/// Limit cycles of an autonomous flow x' = f(x, p), period T unknown, as a Problem. Orthogonal collocation (gauss_step.hpp: four points an
/// interval, order 8 at the ends) on an adaptive mesh; what lies inside m equal parts of the period is eliminated, so the unknowns are few:
///
///     u = (A, ln(T/d), X_0 .. X_{m-1} | p)     X_i = x(i T/m) [units of x], T in units of the flow's time
///     r = (2 int cos(2 pi d s) <c, x> ds - A,  2 int sin(2 pi d s) <c, x> ds,  phi(X_i) - X_{i+1})      phi: the discrete flow over T/m, X_m = X_0
///
/// A is the first harmonic of <c, x> (d = 1; d = 2^level for a doubled cycle), and its peak at s = 0 fixes the phase. That depends on the cycle
/// alone, not on one met before, so that a cycle has one u with A > 0; A passes zero where the cycle shrinks to an equilibrium.
///
/// Multipliers are the n - 1 beside the trivial one: the products of phi_x between the planes normal to f. Where these spread over more than
/// eight decades they are taken as powers of the eigenvalues of the cyclic matrix, whose range is that of their m-th roots.
///
/// `doubled()` holds the same cycles over 2 T in sums and differences of points half a period apart, where the shift by T is a reflection ("PD").
///
/// The mesh follows the solution: it is laid anew where an evaluation is far from the last one it was made for. Its error is below
/// `options.tolerance` of the size of the cycle; a change of mesh moves the residual by no more.
///
///     LimitCycle cycle(flow, Vector::Unit(3, 0), {.tolerance = 1e-10});
///     NewtonResult at = newton(cycle, cycle.guess(orbit, 6.3, p));      // orbit: s in [0, 1) -> x
///     cycle.period(at.x);  cycle.trivial_error(at.x);
///
/// Throws std::invalid_argument for options out of range. One object per thread.

#include <cmath>
#include <functional>
#include <memory>

#include "core/orbit_problem.hpp"
#include "models/dynamics/periodic/gauss_step.hpp"

namespace whirl::models {

struct LimitCycleOptions {
  int segments = 8;          ///< m, parts of the period between unknown points
  double tolerance = 1e-10;  ///< of the points X_i, relative to the size of the cycle
  int most_steps = 4000;     ///< intervals of the mesh
  void validate() const;
};

class LimitCycle : public OrbitProblem {
 public:
  static constexpr int first_harmonic = 0, log_period = 1, scalars = 2;  ///< places in u of A, of ln T, and of X_0

  /// `flow` and its parameters (one or two) are kept by reference. `phase`: c, size n.
  LimitCycle(const Problem& flow, Vector phase, const LimitCycleOptions& options = {});
  ~LimitCycle() override;

  using Orbit = std::function<Vector(double s)>;  ///< x at s = t/T in [0, 1)
  /// The unknowns of a known orbit, shifted so that the phase condition holds.
  Vector guess(const Orbit& orbit, double period, In p) const;
  double period(In u) const { return std::exp(u[log_period]) * (1 << level_); }  ///< T
  /// x at `count` equal instants of the period, n x count.
  Matrix samples(In u, int count) const;
  /// |M f - f| / |f| at s = 0: how far the multiplier of the flow's own direction is from 1.
  double trivial_error(In u) const;
  /// int_0^T div f dt = ln |det M|.
  double divergence(In u) const;
  /// Fastest and slowest point: the least |f| along the cycle over the largest, and where it is.
  double slowest(In u, Vector& x) const;
  int steps() const;  ///< intervals of the mesh in use
  int level() const { return level_; }
  int dimension() const { return flow_.size(); }
  const Vector& phase() const { return phase_; }

 private:
  LimitCycle(const LimitCycle& single);
  struct Mesh;
  struct Sweep;
  void do_residual(In u, Out r) const override;
  void do_jacobian(In u, MatrixOut j) const override;
  void do_linearise(In u, Out r, MatrixOut j) const override;
  void do_second(In u, In v, MatrixOut h) const override;
  void do_third(In u, In a, In b, In c, Out t) const override;
  bool do_multipliers(In u, Eigen::VectorXcd& mu, Eigen::VectorXi& group) const override;
  int do_group_of_unknown(In, int i) const override { return i < scalars ? -1 : 0; }
  void do_velocity(In u, int slope, MatrixOut c) const override;
  void do_characteristic(In u, double kappa, Eigen::MatrixXcd& shift, Eigen::MatrixXcd& by_kappa) const override;
  bool do_characteristic_slope(In u, double kappa, int i, Eigen::MatrixXcd& slope) const override;
  void shift_to_next(MatrixOut s) const;  // S: row of a segment, column of the point at its end
  double do_base_frequency(In u) const override;
  const OrbitProblem& do_doubled() const override;
  Vector do_in_doubled(In u) const override;
  Vector do_from_doubled(In u) const override;

  int points() const { return segments_; }
  void to_points(In u, Matrix& x) const;           // unknowns -> X, n x m
  void from_points(const Matrix& x, Out u) const;  // and back
  void rows_and_columns(MatrixOut j) const;        // of the points -> of the unknowns, in place
  bool evaluate(In u, int order, In v, Out* r, MatrixOut* j) const;
  bool sweep_segments(In u, int order, In v) const;
  void assemble(int order, MatrixOut j) const;
  bool follow(In u) const;  // the mesh suits u
  void lay_mesh(In u, const Matrix& x) const;

  const Problem& flow_;
  Vector phase_;
  LimitCycleOptions options_;
  int level_ = 0, segments_;
  mutable std::unique_ptr<Mesh> mesh_;
  mutable std::unique_ptr<Sweep> sweep_;
  mutable std::unique_ptr<LimitCycle> doubled_;
};

}  // namespace whirl::models
