#pragma once
/// Curves of special points in two parameters, with the codimension-2 points on them.
///
///     const DefiningCurve curve = follow(problem2, point, {.range1 = {1.2, 2.4}, .range2 = {0.05, 0.8}});
///
/// `problem2` is the problem of the walk with a second free parameter (same residual, k = 2). The defining system of the point (augmented.hpp) is
/// walked in the second parameter, both ways. On the way are located, each by its own test function along the curve:
///
///     on a fold curve     CP  cusp (the quadratic coefficient vanishes), BT  Bogdanov-Takens (w'v = 0), ZH  zero-Hopf (a pair crosses)
///     on a Hopf curve     GH  generalised Hopf (l1 = 0), BT (frequency -> 0), ZH (a real eigenvalue crosses)
///     on a branch-point curve   DP  degenerate pitchfork (the cubic coefficient vanishes: super- to subcritical), FT  contact with a fold curve (the
///                               quadratic coefficient of a transcritical point vanishes)
///     where symmetry parts r_x   FP  folds and pitchforks cross, PP  pitchforks that break different symmetries cross
///     of periodic motions   R1 a second multiplier at 1 (on LP and BP curves), R2 at -1 (on PD curves), R3, R4 multipliers at the third and fourth
///     roots
///                         of 1 (on TR curves)
///     the least value of a parameter on any curve is its threshold, type "MIN"/"MAX" in the second parameter; UZ  values asked for.
///
/// A pitchfork or transcritical point that the second parameter dissolves lies on a curve of folds, which is followed in its place.

#include "continuation/walker.hpp"

namespace whirl::continuation {

struct CodimensionTwo {
  std::string type;     ///< CP, BT, ZH, GH, DP, FT, FP, PP, UZ, or MIN / MAX: extremum of the second parameter along the curve
  std::string subtype;  ///< FT: of the curve met there, "LP" or "TC"
  Vector u;             ///< (x, p1, p2)
  double residual = 0.0;
  double arclength = 0.0;
};

struct TwoParameterOptions {
  double range1[2] = {0.0, 1.0};             ///< of the first parameter
  double range2[2] = {0.0, 1.0};             ///< of the second
  WalkOptions walk;                          ///< lower, upper and bounds are set here; user_values are of the second parameter
  std::vector<CoordinateBound> bounds = {};  ///< of unknowns of the problem, at which curves end
  double tolerance = 1e-10;                  ///< of codimension-2 points, relative
};

struct DefiningCurve {
  EventType type = EventType::fold;
  std::string subtype;
  int block = 0;       ///< symmetry block in which r_x is singular or has its pair
  Matrix u;            ///< (x, p1, p2) in columns; of a period doubling x is the motion over twice its period
  Vector coefficient;  ///< normal-form coefficient at each column, NaN where undefined
  Vector frequency;    ///< Hopf curves, rad per time unit; else 0
  Vector residual;
  std::vector<CodimensionTwo> special;
  StopReason start_reason = StopReason::none, stop_reason = StopReason::none;
  std::string name, born_at;
};

/// Follows the curve through `point` (of problem2 with p2 held at the value in `p2`). Throws std::invalid_argument if the point's type has no curve
/// or none can be followed from it. The observer sees the defining system's walk, of a flow in units of its own (chart_units.hpp).
DefiningCurve follow(const Problem& problem2, const SpecialPoint& point, double p2, const TwoParameterOptions& options,
                     const Observer& observer = {});

/// A special point to follow a curve from, p2 held.
struct CurveStart {
  SpecialPoint point;
  double p2 = 0.0;
};

/// Starts of the other curves that meet at a codimension-2 point of `curve`, next to it: there a curve may cross another of its kind, as of Hopf
/// points on a branch and on one that leaves it. Of Hopf points through BT, ZH and HH; of folds, or of branch points where those persist, through BT,
/// ZH, FT and DP. Flows only; empty if there is none.
std::vector<CurveStart> curves_through(const Problem& problem2, const DefiningCurve& curve, const CodimensionTwo& point,
                                       const TwoParameterOptions& options);

}  // namespace whirl::continuation
