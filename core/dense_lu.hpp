#pragma once
/// LU with partial pivoting, PA = LU: own kernels with the size known to the compiler up to 8, Eigen's blocked one above. No allocation after
/// the first `compute` of a size.
///
///     DenseLu lu(5);
///     lu.compute(a);
///     lu.solve(b, x);                 // a x = b; b and x may be the same vector
///     lu.solve_transposed(b, x);      // a' x = b

#include <Eigen/LU>

#include "core/problem.hpp"

namespace whirl {

class DenseLu {
 public:
  static constexpr int small = 8;

  explicit DenseLu(Eigen::Index n = 0) : n_(static_cast<int>(n)), large_(n > small ? n : 0) {}

  void compute(MatrixIn a);
  void solve(In b, Out x) const;
  void solve_two(In b, In d, Out x, Out y) const;  ///< a x = b, a y = d, for small a in the time of one
  void solve_transposed(In b, Out x) const;
  /// The same without building references, which are a tenth of the cost of a small system.
  void solve(const Vector& b, Vector& x) const;
  void solve_two(const Vector& b, const Vector& d, Vector& x, Vector& y) const;
  bool negative_determinant() const;

 private:
  void solve_small(const double* b, double* x) const;
  template <class B, class X>
  void solve_pair(const B& b, const B& d, X& x, X& y) const;

  int n_;
  double a_[small * small];  // L below the diagonal, U on and above, by columns; the diagonal holds reciprocals
  int pivot_[small];         // row exchanged with row k at step k
  bool odd_ = false;         // permutation
  Eigen::PartialPivLU<Matrix> large_;
};

}  // namespace whirl
