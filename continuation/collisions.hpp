#pragma once
/// Windows of instability narrower than a step of a walk along periodic motions: two multipliers meet, leave the unit circle and return.
///
/// With damping |mu| < 1 until two multipliers meet: a pair e^{g +- i theta} at theta = 0 or pi (through 1 or -1 then), or two pairs at one angle
/// (through the unit circle as complex ones). From outside the moduli tell nothing. But
///
///     F = g^2 + (theta - theta_c)^2,    F = g^2 - h^2 once they are real, e^{g +- h}                       a pair at theta_c = 0, pi
///     F = 4 g1 g2 (1 + (theta1 - theta2)^2 / (g1 + g2)^2)                                                  two pairs
///
/// pass through the collision smoothly, vanish exactly where one of the two crosses the unit circle, and are all but parabolas along the branch: by
/// the parameter the angle moves as 2 pi w/omega does, before a resonance as behind it. A pair whose angle passes 0, pi or another one's within a
/// step, or turns round next to it, is a suspicion; the least value of F is then sought on parabolas, three to five points, until it is negative,
/// which parts the step between the two events, or agrees with what its parabola foretold, which proves that there are none.
///
/// A step whose points in between lie off the curve it seemed to follow has passed over a sharp resonance: `passed_over` asks for a shorter one.

#include "continuation/curve.hpp"

namespace whirl::continuation {

struct CollisionOptions {
  int most_samples = 24;      ///< for one collision
  double agreement = 0.1;     ///< of the least F with what its parabola foretold, relative
  double nothing_new = 0.05;  ///< a place nearer than this to the best one, in units of sqrt(F) over the speed of the angle, is the same
  double off_curve = 0.2;     ///< in parts of the step: farther from the cubic through its ends no step may pass unseen
  double neutral = 1e-10;     ///< |g| below it is rounding: without damping nothing is proved
};

class CollisionSearch {
 public:
  CollisionSearch(Curve& curve, const CollisionOptions& options) : curve_(curve), options_(options) {}

  /// Continues the pairs of a in b.
  void follow(const Sample& before, const Sample& a, Sample& b);
  /// Does something meet between before and b? `last`: no further point will show a turn at b.
  bool suspects(const Sample& before, const Sample& a, const Sample& b, bool last);
  /// Points between before and a, and between a and b, in order, that stand on either side of events. Marks in b what has been searched.
  void search(const Sample& before, const Sample& a, Sample& b, bool last);
  const std::vector<Sample>& behind() const { return behind_; }
  const std::vector<Sample>& ahead() const { return ahead_; }
  bool passed_over() const { return passed_over_; }
  int samples() const { return samples_; }      ///< since the walk began
  int undecided() const { return undecided_; }  ///< searches that found neither

 private:
  struct Track {  // a pair at the three points; -1: not known there
    int before, a, b;
  };
  struct Suspect {
    Collision::Kind kind;
    Track first, second;
    double guess;  // where they meet: length from a, negative between before and a; NaN: F tells
  };
  struct Knot {
    double s, value, gap;
    Sample sample;
  };
  struct Place {
    double s, value, gap;  // of one to look at: F as foretold
  };
  struct Steps {
    const Sample *before, *a, *b;
    double behind, ahead;  // lengths
  };
  void list_suspects(bool last);
  void suspect_pair(const Track& t, Collision::Kind kind, bool last);
  void suspect_two(const Track& t, const Track& u, bool last);
  bool turns(const Suspect& c, double moved_before, double moved_behind) const;
  double value(const Suspect& c, const MultiplierPair& p, const MultiplierPair& q) const;
  double value_at(const Suspect& c, const Sample& s, int Track::*point) const;
  double gap_squared(const Suspect& c, const MultiplierPair& p, const MultiplierPair& q) const;
  double speed(const Suspect& c) const;
  int find(const Track& track, const Sample& from, const Sample& to, bool ahead, double sigma, const Sample& at);
  bool evaluate(const Suspect& c, double s, Knot& out);
  enum class Verdict { events, none, elsewhere, undecided };
  Verdict minimise(const Suspect& c, double speed);
  Place next_place(double speed) const;
  void insert(Knot&& knot);
  void keep_sides(const Suspect& c, double speed);
  void keep(const Knot& knot);
  void settle(const Suspect& c, Sample& b) const;

  Curve& curve_;
  CollisionOptions options_;
  MultiplierPairs pairing_;
  Steps steps_{};
  std::vector<Suspect> suspects_;
  std::vector<Knot> knots_;    // of the search at hand, in order of s
  std::vector<Place> places_;  // the samples among them, by F times its sign at a: the best first
  double sign_ = 1.0;          // of F at a
  std::vector<double> expected_;
  std::vector<std::pair<double, Sample>> kept_;
  std::vector<Sample> behind_, ahead_;
  Sample guess_;
  bool passed_over_ = false;
  int samples_ = 0, undecided_ = 0;
};

}  // namespace whirl::continuation
