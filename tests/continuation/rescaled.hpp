#pragma once
/// A problem in other units: x -> a x coordinate by coordinate, p -> b p, t -> c t. Whatever is found must be the same but for these factors.
///
///     R(X, P) = (a / c) r(X / a, P / b),   X = a x, P = b p

#include "core/problem.hpp"

namespace whirl::continuation::text_model {

class Rescaled : public Problem {
 public:
  Rescaled(const Problem& f, const Vector& a, double b, double c) : Rescaled(f, a, Vector::Constant(f.parameters(), b), c) {}
  /// A factor for each parameter.
  Rescaled(const Problem& f, const Vector& a, const Vector& b, double c)
      : Problem(f.size(), f.parameters(), f.is_flow()), f_(f), into_(f.size() + b.size()), out_(a / c), h_(f.size(), f.size() + b.size()) {
    into_ << a.cwiseInverse(), b.cwiseInverse();
    offer_derivatives(f.derivatives());
    for (const auto& r : f.reflections()) add_reflection(r);
  }

 private:
  Vector in(In u) const { return u.cwiseProduct(into_); }
  void do_residual(In u, Out r) const override {
    f_.residual(in(u), r);
    r.array() *= out_.array();
  }
  void do_jacobian(In u, MatrixOut j) const override {
    f_.jacobian(in(u), j);
    j = (out_.asDiagonal() * j * into_.asDiagonal()).eval();
  }
  void do_second(In u, In v, MatrixOut h) const override {
    f_.second(in(u), in(v), h_);
    h = out_.asDiagonal() * h_ * into_.asDiagonal();
  }
  void do_third(In u, In a, In b, In c, Out t) const override {
    f_.third(in(u), in(a), in(b), in(c), t);
    t.array() *= out_.array();
  }

  const Problem& f_;
  Vector into_, out_;
  mutable Matrix h_;
};

}  // namespace whirl::continuation::text_model
