#pragma once
/// A problem on the coordinates S that its active symmetries leave, all others zero: r_S(x_S, p) = 0. What happens to the motion itself, apart from
/// where its symmetries break.
///
///     StateProblem own(f, blocks.indices[0]);
///     BranchPointSystem system(own, own.restricted(u));
///     Vector u = own.lifted(system.base_point(y));
///
/// The base must outlive it.

#include "continuation/blocks.hpp"

namespace whirl::continuation {

class StateProblem : public Problem {
 public:
  StateProblem(const Problem& base, Indices state)
      : Problem(static_cast<int>(state.size()), base.parameters(), false), base_(base), columns_(std::move(state)) {
    for (int k = 0; k < base.parameters(); ++k) columns_.push_back(base.size() + k);
    offer_derivatives(std::min(base.derivatives(), 2));
  }
  Vector restricted(In u) const { return u(columns_); }
  Vector lifted(In v) const {
    Vector u = Vector::Zero(base_.size() + base_.parameters());
    u(columns_) = v;
    return u;
  }

 private:
  void do_residual(In v, Out r) const override {
    Vector all(base_.size());
    base_.residual(lifted(v), all);
    for (int i = 0; i < size(); ++i) r[i] = all[columns_[static_cast<std::size_t>(i)]];
  }
  void do_jacobian(In v, MatrixOut j) const override {
    Matrix all(base_.size(), base_.size() + base_.parameters());
    base_.jacobian(lifted(v), all);
    restrict(all, j);
  }
  void do_second(In v, In a, MatrixOut h) const override {
    Matrix all(base_.size(), base_.size() + base_.parameters());
    base_.second(lifted(v), lifted(a), all);
    restrict(all, h);
  }
  void restrict(const Matrix& all, MatrixOut part) const {
    for (Eigen::Index c = 0; c < part.cols(); ++c)
      for (Eigen::Index r = 0; r < part.rows(); ++r) part(r, c) = all(columns_[static_cast<std::size_t>(r)], columns_[static_cast<std::size_t>(c)]);
  }

  const Problem& base_;
  Indices columns_;  // of the base: S, then the parameters
};

}  // namespace whirl::continuation
