#pragma once
/// Where a function that is known at three points turns, and how near to zero it comes.

#include <algorithm>
#include <cmath>
#include <utility>

namespace whirl::continuation {

/// Through three points.
class Parabola {
 public:
  Parabola(double s0, double f0, double s1, double f1, double s2, double f2) : s_(s1), f_(f1) {
    const double before = (f1 - f0) / (s1 - s0), behind = (f2 - f1) / (s2 - s1);
    curvature_ = (behind - before) / (s2 - s0);
    slope_ = before + curvature_ * (s1 - s0);
    none_ = std::isinf(f0) && std::isinf(f1) && std::isinf(f2);
  }
  double curvature() const { return curvature_; }  ///< half the second derivative
  double turn() const { return s_ - 0.5 * slope_ / curvature_; }
  double at(double s) const { return f_ + (s - s_) * (slope_ + curvature_ * (s - s_)); }
  /// Nearer to zero on the way than it moves, or to zero.
  bool comes_near_zero(double from, double to) const {
    if (none_) return false;  // there is no such function
    const auto [low, high] = range(from, to);
    return !(low > high - low || -high > high - low);
  }
  /// That, where it turns on the way.
  bool turns_near_zero(double from, double to) const {
    return turn() > from && turn() < to && comes_near_zero(from, to) && std::abs(at(turn())) < std::min(std::abs(at(from)), std::abs(at(to)));
  }
  /// Of one sign, and nowhere three times what it is at zero or less than a third.
  bool keeps_size(double from, double to) const {
    const auto [low, high] = range(from, to);
    const double here = at(0.0);
    return std::min(low / here, high / here) > 0.3 && std::max(low / here, high / here) < 3.0;
  }

 private:
  std::pair<double, double> range(double from, double to) const {
    const double a = at(from), b = at(to), c = turn() > from && turn() < to ? at(turn()) : a;
    return {std::min({a, b, c}), std::max({a, b, c})};
  }
  double s_, f_, slope_, curvature_;  // at s_
  bool none_;
};

}  // namespace whirl::continuation
