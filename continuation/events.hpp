#pragma once
/// Finding every special point between two accepted points of a walk, and proving it.
///
/// A change of signature between two points names what must lie between: a fold (the parameter turns), a branch point in a block
/// (its determinant changes sign and no fold explains it), Hopf points (two unstable directions more or fewer); of periodic motions period doublings
/// (the parity of the multipliers below -1) and torus points (two unstable multipliers more or fewer), per group of directions. Each is located by
/// Newton on its own system (special_points.hpp) from a bracket; the signature just before and just behind it is computed,
/// and what remains on either side is explained in turn. What cannot be located is returned as `unresolved` with its bracket.
///
/// Two events that cancel change no signature. They are announced by functions that come closer to zero than they move: the slope of the parameter
/// along the curve, and the growth rates in order of size (growth_rates.hpp), three on either side of zero. Such a step is halved, up to
/// `suspicion_depth` times. What an event leaves of its step, and the steps beside it, are looked at once half way, and halved only where something
/// turns near zero or the event's own function does not go on as it left.

#include <algorithm>
#include <functional>

#include "continuation/branch.hpp"
#include "continuation/curve.hpp"
#include "continuation/special_points.hpp"

namespace whirl::continuation {

struct EventOptions {
  double tolerance = 1e-10;  ///< relative, of the located parameter
  int max_depth = 24;        ///< halvings of a step before a change counts as unresolved
  int suspicion_depth = 6;   ///< halvings while nothing changes but something comes near; then the vertex of a parabola
  int most_samples = 2000;   ///< points looked at within one step
};

class EventFinder {
 public:
  EventFinder(Curve& curve, const EventOptions& options) : curve_(curve), options_(options) {}

  /// Special points strictly between a and b in order; `before` is the accepted point before a (or a itself). Where nothing changed but something
  /// turned round at a near zero, the steps on both sides of a are searched. `last`: no further point will show a turn at b, so look now.
  /// Valid until the next call.
  std::vector<SpecialPoint>& find(const Sample& before, const Sample& a, const Sample& b, bool last = false);
  bool turns_at(const Sample& before, const Sample& a, const Sample& b);

  /// Drops the folds that the turn of a branch upright at its branch point looks like, where rounding had both found apart.
  void drop_turns_at_branch_points(std::vector<SpecialPoint>& special) const;

 private:
  std::vector<EventKind> changes(const Signature& a, const Signature& b) const;
  void multiplier_changes(const Signature& a, const Signature& b, std::vector<EventKind>& kinds) const;
  bool changed(const Signature& a, const Signature& b) const { return unstable_changed(a, b) || !changes(a, b).empty(); }
  bool unstable_changed(const Signature& a, const Signature& b) const;
  void explain(const Sample& a, const Sample& b, int depth);
  bool neutral(const Sample& s, int block) const;
  void note_neutral(const Sample& before, const Sample& a, const Sample& b);
  /// What is left of a step beside an event: searched unless everything goes its way quietly.
  void explain_rest(const Sample& a, const Sample& left, const Sample& right, const Sample& b, int depth);
  template <class Slope>
  bool quiet_rest(const Sample& near, const Sample& far, double offset, const Slope& slope);
  bool quiet_beside(const Sample& far, const Sample& near, const Sample& beyond);
  bool look_half_way(const Sample& a, const Sample& b, Sample& middle);
  /// What may pass zero: the slope of the parameter along the curve, or the rank-th largest growth rate of a block or group.
  struct TestFunction {
    int part, rank;  // part -1: the slope
  };
  double value(const Sample& s, const TestFunction& t) const;
  double secant(const Sample& a, const Sample& b, const TestFunction& t) const;
  /// Calls f for the slope and for the growth rates nearest to zero at `here`, three on either side, until it says no. False if it did.
  template <class F>
  bool all_next_to_zero(const Sample& here, const F& f) const {
    if (!f(TestFunction{-1, 0})) return false;
    for (int k = 0; k < curve_.parts(); ++k) {
      if (neutral_[static_cast<std::size_t>(k)]) continue;
      const auto& rates = here.rates[static_cast<std::size_t>(k)];
      const int last = std::min(rates.positive() + 3, rates.count());
      for (int rank = std::max(1, rates.positive() - 2); rank <= last; ++rank) {
        if (!f(TestFunction{k, rank})) return false;
        if (rank < last && rates.ranked(rank + 1) == rates.ranked(rank)) ++rank;  // a pair is looked at once
      }
    }
    return true;
  }
  /// The one that passes zero at an event between a and b.
  TestFunction crossing(const EventKind& kind, const Sample& a, const Sample& b) const;
  /// `anyway`: at least half way, whatever the ends say.
  void look_closer(const Sample& before, const Sample& a, const Sample& b, int depth, bool anyway = false);
  int beside() const { return std::max(0, options_.suspicion_depth - 4); }  // depth at which what lies beside an event is looked at
  void look_at_extrema(const Sample& a, const Sample& middle, const Sample& b, int depth);
  bool locate(const EventKind& kind, const Sample& a, const Sample& b, SpecialPoint& out);
  bool accept(const EventKind& kind, const Sample& a, const Sample& b, SpecialPoint& found, int depth);
  void find_coincident(const EventKind& kind, const SpecialPoint& point, const Sample& left, const Sample& right, double delta, int pairs_left,
                       int pairs_right);
  bool turns_at_branch_point(const std::vector<EventKind>& shown, const SpecialPoint& point) const;
  void find_further_pairs(const EventKind& kind, const SpecialPoint& point, const Sample& left, const Sample& right, double delta);
  bool locate_multiple(const Sample& a, const Sample& b, int depth);
  void report_unresolved(const Sample& a, const Sample& b);

  bool between(const Sample& a, const Sample& b, double sigma, Sample& out);

  Curve& curve_;
  EventOptions options_;
  std::vector<SpecialPoint> found_;
  int samples_ = 0;                                                               // of the step at hand
  std::array<bool, std::tuple_size_v<decltype(Signature::unstable)>> neutral_{};  // blocks whose events in this step would be rounding
};

}  // namespace whirl::continuation
