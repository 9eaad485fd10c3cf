#pragma once
/// Curves of folds, branch points, period doublings and torus points of limit cycles in two parameters.
///
///     CycleChart chart(*flow2, follow, curves, second_value, context);
///     chart.on_curve([&](const ChartCurve& curve) { ... });
///     for (const auto& family : cycles.families()) chart.follow(*family);

#include "continuation/chart.hpp"
#include "studies/chart_output.hpp"
#include "studies/cycle_branches.hpp"
#include "studies/cycle_output.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

class CycleChart {
 public:
  struct Options {
    continuation::TwoParameterOptions follow;
    std::vector<continuation::EventType> curves;  ///< which to keep
    double second = 0.0;                          ///< value of the second parameter on the families
    models::LimitCycleOptions cycle;
  };

  /// `flow2` and `context` are kept by reference; `columns`: of each point of a curve.
  CycleChart(const Problem& flow2, Options options, std::vector<PointColumn> columns, RunContext& context);

  void on_curve(std::function<void(const ChartCurve&)> f) { on_curve_ = std::move(f); }
  /// Every special point of a family and of its doubled families, each curve once, also where several families lead to it. Curves end where the cycle
  /// shrinks to an equilibrium, or its period passes the family's longest.
  void follow(const CycleFamily& family);
  std::vector<ChartCurve> curves() const;

 private:
  bool is_known(const continuation::SpecialPoint& point, int multiple) const;
  ChartCurve shown(ChartCurve curve) const;
  void say_ends(const continuation::DefiningCurve& curve, const CycleFamily& family) const;

  const Problem& flow2_;
  Options options_;
  std::vector<PointColumn> columns_;
  RunContext& context_;
  std::function<void(const ChartCurve&)> on_curve_;
  std::vector<std::unique_ptr<models::LimitCycle>> problems_;  // one a family
  std::vector<ChartCurve> curves_;
  std::vector<int> multiple_;  // of each curve: periods of the single cycle that its problem holds
};

}  // namespace whirl::studies
