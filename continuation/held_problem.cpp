#include "continuation/held_problem.hpp"

namespace whirl::continuation {

HeldProblem::HeldProblem(const Problem& base, double value)
    : Problem(base.size(), base.parameters() - 1, base.is_flow()), base_(base), value_(value), wide_(base.size(), base.size() + base.parameters()) {
  if (base.parameters() < 2) throw std::invalid_argument("to hold a parameter a problem needs two");
  offer_derivatives(base.derivatives());
  name_parameters({base.parameter_names().begin(), base.parameter_names().end() - 1});
  for (const auto& r : base.reflections()) add_reflection(r);
}

Vector HeldProblem::widen(In u, double last) const {
  Vector wide(u.size() + 1);
  wide << u, last;
  return wide;
}

void HeldProblem::do_residual(In u, Out r) const { base_.residual(widen(u, value_), r); }

void HeldProblem::do_jacobian(In u, MatrixOut j) const {
  base_.jacobian(widen(u, value_), wide_);
  j = wide_.leftCols(j.cols());
}

void HeldProblem::do_linearise(In u, Out r, MatrixOut j) const {
  base_.linearise(widen(u, value_), r, wide_);
  j = wide_.leftCols(j.cols());
}

void HeldProblem::do_second(In u, In v, MatrixOut h) const {
  base_.second(widen(u, value_), widen(v, 0.0), wide_);
  h = wide_.leftCols(h.cols());
}

void HeldProblem::do_third(In u, In a, In b, In c, Out t) const { base_.third(widen(u, value_), widen(a, 0.0), widen(b, 0.0), widen(c, 0.0), t); }

}  // namespace whirl::continuation
