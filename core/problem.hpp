#pragma once
/// The one concept: r(x, p) = 0.
///
/// Unknowns and free parameters stand in one vector u = (x, p), x of size n = size(), p of size k = parameters():
/// k = 0 is a square system for Newton, k = 1 a curve for the walker, k = 2 a surface from which fold, branch-point and Hopf
/// systems cut curves. Which physical numbers the p are is the lens' business (`parameter_names`).
///
///     residual  r(u)                size n
///     jacobian  [ r_x  r_p ]        n x (n + k)
///     second    D2r(u)[v, . ]       n x (n + k), v of size n + k
///     third     D3r(u)[a, b, c]     size n
///
/// A `Flow` problem is the right-hand side of x' = r(x, p): eigenvalues of r_x decide stability. A problem whose solutions are
/// periodic motions has Floquet multipliers instead: orbit_problem.hpp.
/// Calls check shapes with `assert`; the private virtuals do the work. Objects hold scratch memory: one per thread.

#include <Eigen/Core>
#include <cassert>
#include <stdexcept>
#include <string>
#include <vector>

namespace whirl {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using In = const Eigen::Ref<const Vector>&;
using Out = Eigen::Ref<Vector>;
using MatrixIn = const Eigen::Ref<const Matrix>&;
using MatrixOut = Eigen::Ref<Matrix>;

/// A mirror symmetry x -> diag(signs) x of the residual; a branch point that breaks it is reported with `subtype`.
struct Reflection {
  Vector signs;         ///< +1 or -1, size n
  std::string subtype;  ///< e.g. "WH": the branch that breaks this symmetry whirls
};

class Problem {
 public:
  virtual ~Problem() = default;

  int size() const { return n_; }
  int parameters() const { return k_; }
  bool is_flow() const { return flow_; }
  int derivatives() const { return derivatives_; }  ///< highest exact derivative on offer: 1, or 3 where second and third work
  const std::vector<std::string>& parameter_names() const { return names_; }
  const std::vector<Reflection>& reflections() const { return reflections_; }

  void residual(In u, Out r) const {
    assert(u.size() == n_ + k_ && r.size() == n_);
    do_residual(u, r);
  }
  void jacobian(In u, MatrixOut j) const {
    assert(u.size() == n_ + k_ && j.rows() == n_ && j.cols() == n_ + k_);
    do_jacobian(u, j);
  }
  /// Residual and Jacobian at one u: one evaluation where the model can share work.
  void linearise(In u, Out r, MatrixOut j) const {
    assert(u.size() == n_ + k_ && r.size() == n_ && j.rows() == n_ && j.cols() == n_ + k_);
    do_linearise(u, r, j);
  }
  void second(In u, In v, MatrixOut h) const {
    assert(u.size() == n_ + k_ && v.size() == n_ + k_ && h.rows() == n_ && h.cols() == n_ + k_);
    do_second(u, v, h);
  }
  void third(In u, In a, In b, In c, Out t) const {
    assert(u.size() == n_ + k_ && t.size() == n_);
    do_third(u, a, b, c, t);
  }

 protected:
  Problem(int n, int k, bool flow) : n_(n), k_(k), flow_(flow), names_(static_cast<std::size_t>(k), "p") {}
  void name_parameters(std::vector<std::string> names) { names_ = std::move(names); }
  void offer_derivatives(int order) { derivatives_ = order; }
  void add_reflection(Reflection r) { reflections_.push_back(std::move(r)); }

 private:
  virtual void do_residual(In u, Out r) const = 0;
  virtual void do_jacobian(In u, MatrixOut j) const = 0;
  virtual void do_linearise(In u, Out r, MatrixOut j) const {
    do_residual(u, r);
    do_jacobian(u, j);
  }
  virtual void do_second(In, In, MatrixOut) const { throw std::logic_error("this problem has no second derivatives"); }
  virtual void do_third(In, In, In, In, Out) const { throw std::logic_error("this problem has no third derivatives"); }

  int n_, k_;
  bool flow_;
  int derivatives_ = 1;
  std::vector<std::string> names_;
  std::vector<Reflection> reflections_;
};

}  // namespace whirl
