#pragma once
/// The units in which a curve of special points is followed: x in parts of its own size X, both parameters of their ranges, time in parts T of the
/// motion's own. A defining system puts x, p1 and a squared frequency into one metric, and its tolerances are next to one: so neither depends on the
/// units of x, p or t in which the problem is written.
///
///     y = x / X,  q_i = p_i / w_i,  s = t / T:   dy/ds = (T / X) r(X y, w q)
///
/// All units are powers of two: nothing is rounded on the way in or out.
///
///     const ChartUnits units(problem2, u, frequency, options);         // u = (x, p1, p2) near the curve
///     SpecialCurve curve(units.problem(), units.inwards(point), units.inwards_second(p2), units.options());
///     units.outwards(result);

#include "continuation/two_parameter.hpp"
#include "core/problem_in_units.hpp"

namespace whirl::continuation {

class ChartUnits {
 public:
  /// `problem2`, a flow in two parameters, must outlive it. `frequency`: of a Hopf point, else 0.
  ChartUnits(const Problem& problem2, const Vector& u, double frequency, const TwoParameterOptions& options);

  const Problem& problem() const { return problem_; }
  const TwoParameterOptions& options() const { return options_; }

  SpecialPoint inwards(const SpecialPoint& point) const;
  CodimensionTwo inwards(const CodimensionTwo& point) const;
  double inwards_frequency(double frequency) const { return frequency * time_; }
  double inwards_second(double p2) const { return p2 / w2_; }
  void outwards(CurveStart& start) const;
  /// Residuals stay those of the problem in units.
  void outwards(DefiningCurve& curve) const;

 private:
  double coefficient_outwards(const DefiningCurve& curve, Eigen::Index i) const;

  const Problem& f_;
  double x_, w1_, w2_, time_;
  ProblemInUnits problem_;
  TwoParameterOptions options_;
};

}  // namespace whirl::continuation
