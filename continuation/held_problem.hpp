#pragma once
/// A problem whose last free parameter is held: r(x, p1 .. pk) as a problem in (x, p1 .. pk-1). Normal forms and spectra of one point of a chart, and
/// charts of a pair of parameters out of three.
///
///     HeldProblem at_p2(problem2, p2);      // one free parameter left
///     at_p2.hold(p2_elsewhere);
///
/// The base must outlive it. Of periodic motions it is a plain problem: what needs multipliers asks the base.

#include "core/problem.hpp"

namespace whirl::continuation {

class HeldProblem : public Problem {
 public:
  HeldProblem(const Problem& base, double value);
  void hold(double value) { value_ = value; }

 private:
  Vector widen(In u, double last) const;
  void do_residual(In u, Out r) const override;
  void do_jacobian(In u, MatrixOut j) const override;
  void do_linearise(In u, Out r, MatrixOut j) const override;
  void do_second(In u, In v, MatrixOut h) const override;
  void do_third(In u, In a, In b, In c, Out t) const override;

  const Problem& base_;
  double value_;
  mutable Matrix wide_;
};

}  // namespace whirl::continuation
