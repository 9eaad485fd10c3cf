#pragma once
/// A problem in units of its own: y_j = u_j / units_j, R_i = r_i / rows_i, so that whatever measures against 1 measures against these.
///
///     ProblemInUnits scaled(f, units, rows);          // units of all of u = (x, p), size n + k, rows of r, size n; all > 0
///     NewtonResult at = newton(scaled, u.cwiseQuotient(units));
///
/// `newton_in_units` does this for Newton's method: its tolerance is relative to 1 + |x|, which says nothing of an x of size 1e-9. The rows are those
/// of the Jacobian at the start. Units that are 1 within three decades change nothing: the problem is solved as it stands.

#include "core/newton.hpp"

namespace whirl {

class ProblemInUnits : public Problem {
 public:
  ProblemInUnits(const Problem& f, Vector units, Vector rows);
  const Vector& units() const { return units_; }

 private:
  void do_residual(In y, Out r) const override;
  void do_jacobian(In y, MatrixOut j) const override;
  void do_linearise(In y, Out r, MatrixOut j) const override;
  void do_second(In y, In v, MatrixOut h) const override;
  void do_third(In y, In a, In b, In c, Out t) const override;
  const Problem& f_;
  Vector units_, rows_;
  mutable Vector u_;
};

/// Sizes of the terms of each equation near u: sums of |J_ij| units_j; where all vanish the largest of the others.
Vector row_sizes(const Problem& f, In u, const Vector& units);

/// `units`: of x, size n. The result is in the units of f, its residual in those of the rows.
[[nodiscard]] NewtonResult newton_in_units(const Problem& f, const Vector& start, const Vector& units, const NewtonOptions& options = {});

}  // namespace whirl
