#pragma once
/// Finding every special point between two accepted points of a walk, and proving it.
///
/// A change of signature between two points names what must lie between: a fold (the parameter turns), a branch point in a block
/// (its determinant changes sign and no fold explains it), Hopf points (two unstable directions more or fewer). Each is located by Newton on
/// its own system (augmented.hpp) from a bracket; the signature just before and just behind it is computed, and what remains
/// on either side is explained in turn. What cannot be located is returned as `unresolved` with its bracket.
/// Where nothing changed but an eigenvalue or the turning of the parameter comes closer to zero than it moved, the step is looked at more closely:
/// two events that cancel are found too.

#include <functional>

#include "continuation/branch.hpp"
#include "continuation/curve.hpp"

namespace whirl::continuation {

struct EventOptions {
  double tolerance = 1e-10;  ///< relative, of the located parameter
  int max_depth = 24;        ///< halvings of a step before a change counts as unresolved
  int suspicion_depth = 6;   ///< halvings while nothing changes but something comes near; then the vertex of a parabola
};

class EventFinder {
 public:
  EventFinder(Curve& curve, const EventOptions& options) : curve_(curve), options_(options) {}

  /// Special points strictly between a and b in order; `before` is the accepted point before a (or a itself). Where nothing changed but something
  /// turned round at a near zero, the steps on both sides of a are searched. `last`: no further point will show a turn at b, so look now.
  std::vector<SpecialPoint> find(const Sample& before, const Sample& a, const Sample& b, bool last = false);
  bool turns_at(const Sample& before, const Sample& a, const Sample& b) const;

  /// The branch point on the symmetric branch that lies between a and b if reflection `r` of the problem changes the sign of a state's odd part.
  bool mirror_crossing(const Sample& a, const Sample& b, int r, SpecialPoint& out);

 private:
  struct Kind {
    EventType type;
    int block;
  };
  std::vector<Kind> changes(const Signature& a, const Signature& b) const;
  void explain(const Sample& a, const Sample& b, int depth);
  void look_closer(const Sample& before, const Sample& a, const Sample& b, int depth);
  void look_at_extrema(const Sample& a, const Sample& middle, const Sample& b, int depth);
  bool locate(const Kind& kind, const Sample& a, const Sample& b, SpecialPoint& out);
  bool solve(const Kind& kind, const Sample& near, SpecialPoint& out);
  bool accept(const Kind& kind, const Sample& a, const Sample& b, SpecialPoint& found, int depth);
  void report_unresolved(const Sample& a, const Sample& b);
  int total_unstable(const Signature& s) const;

  Curve& curve_;
  EventOptions options_;
  std::vector<SpecialPoint> found_;
};

}  // namespace whirl::continuation
