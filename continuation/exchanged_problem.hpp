#pragma once
/// A problem of two free parameters with their order exchanged: r(x, p1, p2) as a problem in (x, p2, p1). The defining system of branch points asks
/// that the critical eigenvalue moves with the first parameter; where it moves with the second alone the curve is followed in this one.
///
///     const ExchangedProblem other(problem2);
///     Vector v = ExchangedProblem::exchanged(u);      // (x, p1, p2) -> (x, p2, p1), and back
///
/// The base must outlive it. Of flows: what needs multipliers asks the base.

#include "core/problem.hpp"

namespace whirl::continuation {

class ExchangedProblem : public Problem {
 public:
  explicit ExchangedProblem(const Problem& base);
  static Vector exchanged(Vector u);

 private:
  void do_residual(In u, Out r) const override;
  void do_jacobian(In u, MatrixOut j) const override;
  void do_second(In u, In v, MatrixOut h) const override;
  void do_third(In u, In a, In b, In c, Out t) const override;

  const Problem& base_;
};

}  // namespace whirl::continuation
