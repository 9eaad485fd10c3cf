#pragma once
/// One step of the Gauss-Legendre method with four stages (order 8, A-stable, symmetric) on x' = f(x, p), with first and second derivatives of the
/// discrete map itself. It is orthogonal collocation with four points an interval, the inner points eliminated.
///
///     K_i = f(Y_i, p),   Y_i = x + h sum_j a_ij K_j,   x+ = x + h sum_i b_i K_i
///
///     [ I - h a_11 J_1   - h a_12 J_1  ... ] [dK_1]   [ J_1 (dx + dh sum_j a_1j K_j) + f_p dp ]
///     [  - h a_21 J_2   I - h a_22 J_2 ... ] [dK_2] = [ J_2 (dx + dh sum_j a_2j K_j) + f_p dp ]     J_i = f_x(Y_i, p)
///     [       ...                          ] [... ]   [ ...                                   ]
///
/// Slopes run over `columns` independent variables: dx is n x columns, dh a row, the last k columns are the parameters.

#include <Eigen/LU>
#include <vector>

#include "core/problem.hpp"

namespace whirl::models {

/// What one step keeps from one evaluation to the next.
struct GaussMemory {
  Matrix k;                           ///< slopes of the stages, n x 4: a guess, and then the solution
  Eigen::PartialPivLU<Matrix> lu;     ///< of the matrix above, at the solution or near it; size 0: not yet
  std::vector<Matrix> jacobian = {};  ///< [f_x f_p] at the stages of the step `at`
  Vector at = {};                     ///< (x, p, h) that `jacobian` and `lu` are exact for, or of size 0
};

class GaussStep {
 public:
  static constexpr int stages = 4;
  static const double a[stages][stages], b[stages], c[stages];

  /// `flow` is kept by reference. `columns` includes its parameters, which come last.
  GaussStep(const Problem& flow, int columns);

  /// Solves the stages from x over h, by chords with the factors kept as long as these converge fast, by Newton where they do not, and from the slope
  /// at x where the guess in `memory` leads nowhere; false if nothing does. `derivatives`: the Jacobians are renewed at the solution, and `first` and
  /// `second` may follow. `memory` must live until then.
  [[nodiscard]] bool solve(In x, In p, double h, GaussMemory& memory, bool derivatives);
  /// After `solve` with derivatives: dx -> dx+. `dh`: slope of h along each column.
  void first(Matrix& dx, In dh);
  /// After `first`, along v: dx_v, dh_v, dp_v are the slopes along v before this step, `ddx` (n x columns) the second derivative D2x[v, .] and
  /// becomes that behind the step, dx_v the slope behind it. `ddh`: D2h[v, .].
  void second(Vector& dx_v, double dh_v, In dp_v, Matrix& ddx, In ddh);

  const Vector& end() const { return end_; }                                                      ///< x+
  const Matrix& slopes() const { return memory_->k; }                                             ///< K
  const Matrix& jacobian(int i) const { return memory_->jacobian[static_cast<std::size_t>(i)]; }  ///< [f_x f_p] at Y_i
  const Eigen::PartialPivLU<Matrix>& factors() const { return memory_->lu; }                      ///< of the matrix above
  const Vector& stage(int i) const { return y_[static_cast<std::size_t>(i)]; }                    ///< Y_i
  const Matrix& stage_slope(int i) const { return dy_[static_cast<std::size_t>(i)]; }             ///< after `first`
  const Matrix& stage_second(int i) const { return ddy_[static_cast<std::size_t>(i)]; }           ///< after `second`
  const Vector& stage_along(int i) const { return dy_v_[static_cast<std::size_t>(i)]; }           ///< after `second`

 private:
  bool iterate(In x, In p, GaussMemory& memory);
  bool from_slope(In x, In p, GaussMemory& memory);
  bool linearise(In p, GaussMemory& memory);
  void stage_points(In x, const Matrix& k);

  const Problem& flow_;
  int n_, parameters_, columns_;
  double h_ = 0.0;
  Vector u_, key_, end_, rhs_, delta_, f_, along_;
  GaussMemory* memory_ = nullptr;
  Matrix block_, dk_v_, second_;
  std::vector<Vector> y_, dy_v_;
  std::vector<Matrix> dk_, dy_, ddy_, ddk_;  // a stage each
  Matrix right_;                             // stages * n x columns
  Vector dh_;
};

}  // namespace whirl::models
