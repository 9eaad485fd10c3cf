#pragma once
/// A chart in two parameters: every curve of special points once, and the curves that codimension-2 points met on the way lead to.
///
///     Chart chart(problem2, options);
///     for (const auto& point : branch.special) chart.follow_from(point, p2, "B1:LP1");
///     chart.follow_meetings();
///     for (const DefiningCurve& curve : chart.curves()) ...

#include "continuation/two_parameter.hpp"

namespace whirl::continuation {

/// Does u = (x, p1, p2), or a mirror image of it under the problem's reflections, lie on the curve? Up to what the cubic through neighbouring points
/// is off. `frequency`: of a Hopf point, else 0. `along`: if not empty the curve must pass in this direction too (two curves of a kind may cross).
bool lies_on(const Problem& problem2, const DefiningCurve& curve, const Vector& u, double frequency, const Vector& along,
             const TwoParameterOptions& options);

class Chart {
 public:
  /// The problem must outlive the chart.
  Chart(const Problem& problem2, TwoParameterOptions options) : f_(problem2), options_(std::move(options)) {}

  void set_observer(Observer observer) { observer_ = std::move(observer); }
  /// Types of curves to keep; all by default.
  void want(std::vector<EventType> types) { wanted_ = std::move(types); }
  /// Called with each new curve, to be named, before it is kept.
  void on_curve(std::function<void(DefiningCurve&)> f) { on_curve_ = std::move(f); }
  void on_warning(std::function<void(const std::string&)> f) { on_warning_ = std::move(f); }

  /// Follows the curve through a point unless it is known. What has no curve is told to on_warning.
  void follow_from(const SpecialPoint& point, double p2, const std::string& origin);
  /// The other curves through the codimension-2 points found so far, and theirs.
  void follow_meetings();
  const std::vector<DefiningCurve>& curves() const { return curves_; }

 private:
  bool wants(EventType type) const;
  const Problem& problem_of(EventType type) const;
  bool is_known(const SpecialPoint& point, double p2, const Vector& along) const;
  bool repeats(const DefiningCurve& curve) const;
  void adopt(const SpecialPoint& point, double p2, const std::string& origin, bool warn);

  const Problem& f_;
  TwoParameterOptions options_;
  Observer observer_;
  std::vector<EventType> wanted_;
  std::function<void(DefiningCurve&)> on_curve_;
  std::function<void(const std::string&)> on_warning_;
  std::vector<DefiningCurve> curves_;
};

}  // namespace whirl::continuation
