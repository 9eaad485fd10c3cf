#pragma once
/// A Problem whose solutions are periodic motions of a system forced at a period T, each motion lasting nu T. Stability is in its Floquet
/// multipliers.
///
///     mu_i, group(i)       multipliers over nu T, and the group of directions each belongs to: groups that the motion leaves uncoupled
///                          (in plane and out of plane on planar motion) are counted apart, so that two events within a step are told apart
///     L(lambda) = r_x + lambda C + lambda^2 I         what e^{lambda t} times a disturbance in the shape of x leaves of r: singular at a
///                          Floquet exponent lambda, mu = e^{lambda nu T}; `velocity` gives C, `velocity_slope` its slope by a parameter.
///                          A problem whose L is another function of lambda, with slope C at 0, says so in `characteristic`
///     doubled()            the same motions as motions over 2 nu T: a period doubling is a symmetry-breaking branch point there (the shift by
///                          nu T is a reflection with subtype "PD")
///
/// Calls check shapes with `assert`. One object per thread.

#include <memory>

#include "core/problem.hpp"

namespace whirl {

class OrbitProblem : public Problem {
 public:
  static constexpr int max_groups = 8;

  int multiplier_count() const { return multipliers_; }
  /// False if they could not be computed. `group` gets a number below max_groups for each multiplier.
  [[nodiscard]] bool multipliers(In u, Eigen::VectorXcd& mu, Eigen::VectorXi& group) const {
    assert(u.size() == size() + parameters() && mu.size() == multipliers_ && group.size() == multipliers_);
    return do_multipliers(u, mu, group);
  }
  /// The group that unknown i of x belongs to at the motion u.
  int group_of_unknown(In u, int i) const {
    assert(i >= 0 && i < size());
    return do_group_of_unknown(u, i);
  }
  void velocity(In u, MatrixOut c) const {
    assert(c.rows() == size() && c.cols() == size());
    do_velocity(u, -1, c);
  }
  void velocity_slope(In u, int parameter, MatrixOut c) const {
    assert(parameter >= 0 && parameter < parameters() && c.rows() == size() && c.cols() == size());
    do_velocity(u, parameter, c);
  }
  /// L(i kappa) - r_x and its slope by kappa; `characteristic_slope`: by entry i of u, false if it does not depend on it. Complex, size() x size().
  void characteristic(In u, double kappa, Eigen::MatrixXcd& shift, Eigen::MatrixXcd& by_kappa) const { do_characteristic(u, kappa, shift, by_kappa); }
  [[nodiscard]] bool characteristic_slope(In u, double kappa, int i, Eigen::MatrixXcd& slope) const {
    assert(i >= 0 && i < size() + parameters());
    return do_characteristic_slope(u, kappa, i, slope);
  }
  double base_frequency(In u) const { return do_base_frequency(u); }  ///< 2 pi / (nu T) [rad/s]

  const OrbitProblem& doubled() const { return do_doubled(); }    ///< made at the first call; lives as long as this
  Vector in_doubled(In u) const { return do_in_doubled(u); }      ///< u as an unknown of `doubled()`
  Vector from_doubled(In u) const { return do_from_doubled(u); }  ///< the part of an unknown of `doubled()` that repeats after nu T

 protected:
  OrbitProblem(int n, int k, int multiplier_count) : Problem(n, k, false), multipliers_(multiplier_count) {}

 private:
  virtual bool do_multipliers(In u, Eigen::VectorXcd& mu, Eigen::VectorXi& group) const = 0;
  virtual int do_group_of_unknown(In u, int i) const = 0;
  virtual void do_velocity(In u, int slope, MatrixOut c) const = 0;  // slope < 0: C itself
  virtual void do_characteristic(In u, double kappa, Eigen::MatrixXcd& shift, Eigen::MatrixXcd& by_kappa) const;
  virtual bool do_characteristic_slope(In u, double kappa, int i, Eigen::MatrixXcd& slope) const;
  virtual double do_base_frequency(In u) const = 0;
  virtual const OrbitProblem& do_doubled() const = 0;
  virtual Vector do_in_doubled(In u) const = 0;
  virtual Vector do_from_doubled(In u) const = 0;

  int multipliers_;
};

}  // namespace whirl
