#pragma once
/// Sweeps: the settled motion while a parameter goes from value to value, each motion starting where the one before ended, and the transitions on the
/// way: jumps to another motion, and changes of kind (period doubling, a second frequency, a coordinate that starts to move or comes to rest).
/// Each transition is bisected, always starting from the motion before it, down to `tolerance` in the parameter, or until a motion between is too
/// slow to settle: the bracket says how far.
///
///     Sweep s = sweep(at, values, start, {});       // at: p -> ModalSystem<double>
///     for (const auto& t : s.transitions) t.before, t.after, t.what;
///
/// Throws std::invalid_argument for options out of range.

#include <functional>

#include "models/attractors.hpp"

namespace whirl::models {

struct SweepOptions {
  double tolerance = 1e-5;         ///< width of a transition's bracket, in the parameter's unit
  double jump = 0.05;              ///< change of the root mean square that counts as a jump, over the largest of all coordinates
  double perturbation = 1e-4;      ///< added to coordinates at rest before each value: an invariant subspace is left where it repels
  int samples = 64, periods = 32;  ///< recorded motion, per period; periods where it has none
  AttractorOptions settle;
  std::vector<std::string> names = {};          ///< of the coordinates in `SweepTransition::what`; q1, q2, ... without
  std::function<bool(double p)> observer = {};  ///< before each value; false ends the sweep
  void validate() const;
};

struct SweepPoint {
  double p = 0.0;
  Settled settled;
  SteadyMotion motion;
  Vector rms;  ///< of each coordinate about its mean
};

struct SweepTransition {
  double before = 0.0, after = 0.0;  ///< bracket: the last value of the motion before and the first of the one after
  bool jump = false;                 ///< the amplitude jumps
  std::string what;                  ///< "jump, periodic 1T -> periodic 2T"
  Vector rms_before, rms_after;
};

struct Sweep {
  std::vector<SweepPoint> points;
  std::vector<SweepTransition> transitions;
  std::string why;  ///< if it ended early
};

Sweep sweep(const std::function<ModalSystem<double>(double)>& at, const std::vector<double>& values, const Vector& start,
            const SweepOptions& options);

/// "periodic", "periodic 2T", "quasi-periodic", ...
std::string name_of(MotionKind kind, int multiple);

}  // namespace whirl::models
