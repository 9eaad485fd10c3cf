#pragma once
/// One special point, solved on its own system (augmented.hpp, period_doubling.hpp, torus.hpp) from a point of the curve beside it. Where between
/// two points one must lie is the matter of events.hpp.

#include "continuation/branch.hpp"
#include "continuation/curve.hpp"

namespace whirl::continuation {

struct EventKind {
  EventType type;
  int block;  ///< symmetry block; of a period doubling or torus point: the group of multipliers
};

/// False if Newton finds none, or the problem has no second derivatives. `frequency`: of the Hopf pair meant, rad per unit of time; 0: the one whose
/// growth rate is nearest to zero. Brackets and counts of unstable directions are left to the caller.
bool special_point_near(const Curve& curve, const EventKind& kind, const Sample& near, SpecialPoint& out, double frequency = 0.0);

/// A branch point next to `near`, where a walk can go no further because its range ends on it.
bool branch_point_at(const Curve& curve, const Sample& near, SpecialPoint& out);

/// The branch point on the symmetric branch that lies between a and b if reflection `r` of the problem changes the sign of a state's odd part.
bool mirror_crossing(const Curve& curve, const Sample& a, const Sample& b, int r, SpecialPoint& out);

/// Is r_p in the range of r_x at a branch point? Then the parameter has an extremum along a branch through it that is no fold.
bool turns_upright(const Curve& curve, const SpecialPoint& point);

}  // namespace whirl::continuation
