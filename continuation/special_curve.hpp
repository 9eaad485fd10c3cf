#pragma once
/// A curve of special points in two parameters, seen from one of its points y: the defining system (augmented.hpp), the special point behind y with
/// its normal form, and the functions that vanish where the curve meets a point of codimension two.
///
///     SpecialCurve curve(problem2, point, p2, options);
///     curve.update_borders(y);                            // at each point of a walk: signs of null vectors, hence of test functions, go on
///     for (const auto& test : curve.tests()) test.value(y);

#include "continuation/augmented.hpp"
#include "continuation/held_problem.hpp"
#include "continuation/two_parameter.hpp"

namespace whirl::continuation {

/// Vanishes at points of its type; a pole of the normal form is no pole of it.
struct CurveTest {
  std::string type;
  std::function<double(In y)> value;
};

class SpecialCurve {
 public:
  /// Throws std::invalid_argument if points of this type have no curve.
  SpecialCurve(const Problem& problem2, const SpecialPoint& point, double p2, const TwoParameterOptions& options);

  const Problem& problem() const { return f_; }
  const SpecialPoint& point() const { return point_; }
  const Blocks& blocks() const { return blocks_; }
  AugmentedSystem& system() { return *system_; }
  Eigen::Index states() const { return static_cast<Eigen::Index>(singular_ ? f_.size() : static_cast<int>(blocks_.indices[0].size())); }
  Vector start() const;  ///< unknowns of the system at the point the curve goes through; of several pairs the one meant
  void update_borders(In y);

  Vector base(In y) const { return system_->base_point(y); }  ///< (x, p1, p2)
  SpecialPoint at(In y) const;                                ///< with its normal form; NaN where that does not exist
  std::vector<CurveTest> tests() const;
  /// At a zero of a test function: is the eigenvalue on the axis indeed? Two real eigenvalues of opposite sign cancel as well.
  bool is_crossing(In y, const std::string& type) const;
  double kappa(In y) const;                     ///< squared frequency of a Hopf point; NaN on other curves
  double apart_from_branch_points(In y) const;  ///< of a fold: |w'r_p|, both parameters in their ranges; zero where branches cross as well
  double branch_point_slope(In y) const;        ///< |D2r[v, p]' w|: how fast that grows, with x in its units, where branches cross
  bool past_strong_resonance(In y) const;       ///< of a curve of torus points, which ends where its multipliers meet at 1 or -1
  bool dissolved(In y) const;                   ///< a branch point of r + beta b0 = 0 only
  /// Branch points that the first parameter does not move: the system's Jacobian has a kernel of two dimensions all along such a curve.
  bool unmoved_by_first(In y) const;

 private:
  struct NullPair {
    Vector v, w;  // right and left, unit length, of signs that go on along the curve
  };
  NullPair null_pair(In y) const;
  double quadratic(In y) const;
  double double_root(In y) const;
  Eigen::VectorXcd others(In y) const;
  double crossing_pair(In y) const;
  double crossing_real(In y) const;
  void add_branch_point_tests(std::vector<CurveTest>& all) const;
  void add_other_blocks(std::vector<CurveTest>& all) const;

  const Problem& f_;
  SpecialPoint point_;
  double range_[2];  // widths of both parameters' ranges
  mutable HeldProblem held_;
  mutable Vector orientation_;  // of the null vector of a fold: it turns along the curve, it does not jump
  Blocks blocks_;
  Vector start_;  // (x, p1, p2)
  std::unique_ptr<AugmentedSystem> system_;
  std::unique_ptr<SingularSystem> singular_;             // null vectors of r_x where the system itself has none
  std::vector<std::unique_ptr<SingularSystem>> others_;  // the same states, singular in another symmetry block
};

}  // namespace whirl::continuation
