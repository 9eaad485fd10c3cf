#pragma once
/// Points of codimension two on a curve of special points that has been walked: zeros of its test functions (special_curve.hpp), each enclosed by two
/// points of the walk and located on the curve, and extrema of the second parameter.
///
/// A function that is zero at a point of the walk itself, as where the walk starts, is enclosed by that point's neighbours. Two zeros within a step
/// are announced by a parabola through three points that comes near zero. On a Hopf curve the frequency vanishes at a Bogdanov-Takens point and the
/// first Lyapunov coefficient with it is unbounded: what lies beside the point is looked at in steps that shrink with the distance.

#include "continuation/special_curve.hpp"

namespace whirl::continuation {

struct CodimensionTwoOptions {
  double zero = 1e-8;         ///< a value this small next to its neighbour's is a zero at the point itself
  double noise = 1e-11;       ///< values below it are rounding: test functions are of order one
  double pole = 1e-3;         ///< a zero located is this small next to the values that enclose it; a pole is not
  double contact = 1e-4;      ///< part of its largest size on the curve below which w'r_p of a fold is zero
  double same = 1e-4;         ///< of the largest state on the curve: points of one type nearer than that, at the same parameters, are one
  double flat = 1e-11;        ///< of the second parameter's range, and of its value: less is no extremum
  int closest_to_double = 5;  ///< steps towards a Bogdanov-Takens point, each a quarter of the one before
  double touch = 1e-9;        ///< a function that comes so near to zero, next to its size around, touches it
  int vertex_rounds = 8;      ///< parabolas drawn anew where a function comes near zero
};

/// In order of arclength. `walked`: of curve.system() in the second parameter; its borders are moved along.
/// `each` is called with every point of the walk once, borders and signs being right there.
std::vector<CodimensionTwo> codimension_two_points(SpecialCurve& curve, const Branch& walked, const TwoParameterOptions& options,
                                                   const std::function<void(int)>& each, const CodimensionTwoOptions& limits = {});

/// Where a curve of folds touches one of transcritical points or pitchforks near u = (x, p1, p2), located on the latter: "FT" with subtype "TC", or
/// "DP", a pitchfork with vanishing cubic coefficient. False if no branch point persists there.
bool degenerate_branch_point_near(const Problem& problem2, In u, const TwoParameterOptions& options, CodimensionTwo& out);

}  // namespace whirl::continuation
