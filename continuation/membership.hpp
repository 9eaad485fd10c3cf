#pragma once
/// Does a solution lie on a branch that was walked? Asked by distance on the curve, not at fixed parameter: folds, ends of the range and last digits
/// change nothing.
///
///     |u - c| < same,   c the curve's point in the plane through u normal to the chord between the walked points beside it
///
/// in the metric of the parameter range and of the largest |x| of the branch and of u. A solution known no better than it is far from c is c but for
/// rounding: so is what Newton leaves of a zero.
///
///     BranchShape shape(branch);                       // once a branch
///     if (lies_on(problem, branch, shape, u, {.range = upper - lower, .accuracy = newton_error(problem, u)})) ...

#include "continuation/branch.hpp"

namespace whirl::continuation {

struct MembershipOptions {
  double range = 1.0;       ///< of the parameter
  double least_size = 0.0;  ///< of |x|: what is smaller is measured by it, zero but for rounding
  double accuracy = 0.0;    ///< to which x of u is known, see newton_error
  double same = 1e-6;       ///< two solutions nearer than this in the metric are one
  double reach = 0.3;       ///< an arc stays so near to its chord, in parts of it; steps turn by a fifth of a radian at most
  double cubic = 0.02;      ///< the cubic through two walked points and their tangents errs by less, in parts of the chord
  double beyond = 1e-6;     ///< a branch is continued so far beyond its ends, in the metric
};

/// Signs of all products of the problem's reflections, the identity first. They commute, so each is a subset.
[[nodiscard]] std::vector<Vector> reflection_products(const Problem& f);

/// Extents of a branch, so that most of it is passed over without a look at its points.
struct BranchShape {
  explicit BranchShape(const Branch& branch);
  double size;                  ///< largest |x|
  std::vector<double> chord_x;  ///< |x| part of each chord between successive points
};

/// What Newton's method still takes off the x of the solution u = (x, p), |r_x^-1 r|, where that is no rounding; else 0.
[[nodiscard]] double newton_error(const Problem& f, In u);

/// u: a solution, size n + 1, tested as it stands; mirror images are the caller's business.
[[nodiscard]] bool lies_on(const Problem& f, const Branch& branch, const BranchShape& shape, In u, const MembershipOptions& options);

}  // namespace whirl::continuation
