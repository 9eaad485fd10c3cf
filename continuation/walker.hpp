#pragma once
/// Pseudo-arclength walk along a solution curve of r(x, p) = 0, with stability, special points and a stop reason.
///
///     Walker walker(problem, {.lower = 1.2, .upper = 2.4});
///     Branch branch = walker.walk(u0);                      // both directions from a solution u0 = (x0, p0)
///     Branch half = walker.walk_from(u_bp, direction);      // one direction, e.g. off a branch point
///
/// The predictor is the cubic through the last two points and their tangents. Step control needs no tuning: lengths are measured in units of the
/// parameter range and of the largest |x| met; the step follows the turning angle of the tangent, the first correction and the contraction of Newton.
/// Throws std::invalid_argument for options out of range. A walk that cannot go on ends with a stop reason and all points so far.

#include <functional>
#include <optional>

#include "continuation/augmented.hpp"
#include "continuation/branch.hpp"
#include "continuation/events.hpp"

namespace whirl::continuation {

/// A named quantity of a point whose extrema along the branch are special points. With a `form` (which needs second derivatives of the problem)
/// they are located on their own system and can be followed in two parameters; else by bracketing on differences of `value`.
struct Observable {
  std::string name;
  std::function<double(In u)> value = {};
  std::optional<QuadraticForm> form = std::nullopt;
};

/// A further coordinate of u with a range of its own; the walk ends on its end exactly.
struct CoordinateBound {
  int index;
  double lower, upper;
};

struct WalkOptions {
  double lower = 0.0, upper = 1.0;  ///< range of the parameter
  double initial_step = 2e-3;       ///< in the metric: 1 is the whole range, or the largest |x|
  double min_step = 1e-10;
  double max_step = 0.04;
  double max_angle_deg = 12.0;  ///< between successive tangents
  int max_points = 4000;        ///< in one direction
  CurveOptions corrector;
  EventOptions events;
  bool locate_events = true;
  bool explain_changes = true;  ///< shorten a step whose change no event explains; off on curves of special points: new borders are such a change
  double least_step_on_suspicion = 1e-4;     ///< over max_step: a step this short is not refused for what lies between its ends
  std::vector<double> user_values;           ///< parameter values to hit exactly, reported as UZ
  std::vector<Observable> peaks;             ///< their extrema along the branch are reported as RP
  std::vector<CoordinateBound> bounds = {};  ///< beside the parameter's range
  void validate() const;
};

/// Called after each accepted point (branch so far, its last index); false stops the walk.
using Observer = std::function<bool(const Branch&, int)>;

class Walker {
 public:
  Walker(const Problem& problem, WalkOptions options);
  ~Walker();

  /// Both directions from a solution; points run with the parameter increasing at u0. Throws if u0 is no solution (Newton cannot polish it).
  Branch walk(const Vector& u0, const Observer& observer = {});
  /// One direction from a point on the curve, along `direction` (size n + 1). `from_branch_point`: u0 is kept as the first point unchanged and
  /// the first step leaves along `direction`, which need not be a unique tangent there.
  Branch walk_from(const Vector& u0, const Vector& direction, bool from_branch_point, const Observer& observer = {});

 private:
  struct State;
  bool begin(const Vector& u0, const Vector& direction, bool from_branch_point);
  bool can_continue() const;
  bool creeps_to_bound() const;
  void predict();
  bool correct();
  void shorten_step();
  void accept();
  bool locate_events();
  bool asks_for_shorter_step(const SpecialPoint& e);
  bool leaves_range(In u, In direction) const;
  bool reach_bound(int index, double bound);
  bool within_bounds(int& index, double& bound) const;
  void keep_scale();
  bool close_loop();
  bool is_known(const SpecialPoint& e) const;
  void find_peaks_and_values();
  void find_user_values();
  void find_peak(const Observable& peak);
  void lengthen_step();

  const Problem& problem_;
  WalkOptions options_;
  std::unique_ptr<State> s_;
};

}  // namespace whirl::continuation
