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

#include "core/dense_lu.hpp"
#include "core/problem.hpp"

namespace whirl::models {

class GaussStep {
 public:
  static constexpr int stages = 4;
  static const double a[stages][stages], b[stages], c[stages];

  /// `flow` is kept by reference. `columns` includes its parameters, which come last.
  GaussStep(const Problem& flow, int columns);

  /// Solves the stages from x over h; `k` (n x stages) holds a guess and then the slopes K. Where Newton does not converge from the guess it starts
  /// from the slope at x; false, and `k` that, if it does not converge from there either.
  [[nodiscard]] bool solve(In x, In p, double h, Matrix& k);
  /// After `solve`: dx -> dx+. `dh`: slope of h along each column.
  void first(Matrix& dx, In dh);
  /// After `first`, along v: dx_v, dh_v, dp_v are the slopes along v before this step, `ddx` (n x columns) the second derivative D2x[v, .] and
  /// becomes that behind the step, dx_v the slope behind it. `ddh`: D2h[v, .].
  void second(Vector& dx_v, double dh_v, In dp_v, Matrix& ddx, In ddh);

  const Vector& end() const { return end_; }                                             ///< x+
  const Vector& stage(int i) const { return y_[static_cast<std::size_t>(i)]; }           ///< Y_i
  const Matrix& stage_slope(int i) const { return dy_[static_cast<std::size_t>(i)]; }    ///< after `first`
  const Matrix& stage_second(int i) const { return ddy_[static_cast<std::size_t>(i)]; }  ///< after `second`
  const Vector& stage_along(int i) const { return dy_v_[static_cast<std::size_t>(i)]; }  ///< after `second`

 private:
  bool iterate(In x, In p);
  void factorise();
  void stage_points(In x);

  const Problem& flow_;
  int n_, parameters_, columns_;
  double h_ = 0.0;
  Vector u_, end_, rhs_, delta_, f_;
  Matrix k_, block_, second_;
  std::vector<Vector> y_, dy_v_;
  std::vector<Matrix> jacobian_, dk_, dy_, ddy_, ddk_;  // a stage each
  Matrix right_;                                        // stages * n x columns
  Eigen::PartialPivLU<Matrix> lu_;
  Vector dh_;
};

}  // namespace whirl::models
