#pragma once
/// Floquet multipliers in pairs, followed from point to point along a branch of periodic motions.
///
/// A complex pair e^{g +- i theta} and a real one e^{g +- h} (at theta = 0, or at pi if negative) are one thing: with damping the pair moves along
/// |mu| = e^g < 1 and its angle theta goes through 0 or pi, where the two meet, as smoothly as through any other angle. Only its image in [0, pi]
/// turns round there. So each pair is followed by its angle: the angles of the point before, moved on as they moved in the step before, are
/// matched with those of the point in order of size. Where two come together it does not matter which one goes on as which, their next places are
/// the same.
///
/// Pairs far inside the unit circle (g < `least_growth`) are left out: no narrow window of instability can come of them.

#include <Eigen/Core>
#include <numbers>
#include <span>
#include <vector>

namespace whirl::continuation {

struct MultiplierPair {
  int group = 0;           ///< of directions, orbit_problem.hpp
  double growth = 0.0;     ///< g, mean of ln |mu| of the two
  double angle = 0.0;      ///< theta in [0, pi]
  double split = 0.0;      ///< h of a real pair; 0 of a complex one
  int from = -1;           ///< its place among the pairs of the point before; -1: not known there
  double reached = 0.0;    ///< the angle gone on from the point before, beyond 0 or pi if it passed
  double last_turn = 0.0;  ///< by how much it moved in this step, in the direction in which `angle` goes on
  bool real() const { return angle <= 0.0 || angle >= std::numbers::pi; }
};

class MultiplierPairs {
 public:
  static constexpr double least_growth = -3.0;

  /// The pairs of one point, by group and angle. `group` of each multiplier.
  void list(const Eigen::VectorXcd& multipliers, const Eigen::VectorXi& group, std::vector<MultiplierPair>& pairs);

  /// Continues those of one point in the next; `stretch`: the length of this step over that of the step before.
  void follow(const std::vector<MultiplierPair>& from, double stretch, std::vector<MultiplierPair>& to);

  /// Where in `pairs` the pair is that is expected at `expected[which]`; all pairs of the group are expected where `expected` says. -1: none.
  int find(std::span<const double> expected, std::size_t which, int group, const std::vector<MultiplierPair>& pairs);

 private:
  struct Place {
    double angle;
    int index;
  };
  void match(const std::vector<MultiplierPair>& pairs, int first, int last);

  struct Real {
    int group;
    bool negative;
    double log;
  };
  std::vector<Real> real_;
  std::vector<Place> expected_;  // folded, by size
  std::vector<int> matched_;     // for each of expected_ the pair; -1: none
  std::vector<bool> taken_;
};

/// The image of an angle in [0, pi].
double folded(double angle);
/// The angle with this image that is nearest to another one; `turned`: it runs against its image there.
double unfolded(double image, double near, bool& turned);

}  // namespace whirl::continuation
