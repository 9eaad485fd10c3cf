#include "continuation/exchanged_problem.hpp"

#include <utility>

namespace whirl::continuation {

ExchangedProblem::ExchangedProblem(const Problem& base) : Problem(base.size(), base.parameters(), base.is_flow()), base_(base) {
  if (base.parameters() != 2) throw std::invalid_argument("only the order of two parameters can be exchanged");
  offer_derivatives(base.derivatives());
  name_parameters({base.parameter_names()[1], base.parameter_names()[0]});
  for (const auto& r : base.reflections()) add_reflection(r);
}

Vector ExchangedProblem::exchanged(Vector u) {
  std::swap(u[u.size() - 1], u[u.size() - 2]);
  return u;
}

void ExchangedProblem::do_residual(In u, Out r) const { base_.residual(exchanged(u), r); }

void ExchangedProblem::do_jacobian(In u, MatrixOut j) const {
  base_.jacobian(exchanged(u), j);
  j.col(size()).swap(j.col(size() + 1));
}

void ExchangedProblem::do_second(In u, In v, MatrixOut h) const {
  base_.second(exchanged(u), exchanged(v), h);
  h.col(size()).swap(h.col(size() + 1));
}

void ExchangedProblem::do_third(In u, In a, In b, In c, Out t) const { base_.third(exchanged(u), exchanged(a), exchanged(b), exchanged(c), t); }

}  // namespace whirl::continuation
