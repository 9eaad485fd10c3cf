#include "studies/cycle_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace whirl::studies {

using namespace continuation;
using models::LimitCycle;

namespace {

constexpr double same_place = 1e-6;  // of the first parameter's range, and in ln T

}  // namespace

CycleChart::CycleChart(const Problem& flow2, Options options, std::vector<PointColumn> columns, RunContext& context)
    : flow2_(flow2), options_(std::move(options)), columns_(std::move(columns)), context_(context) {}

// Phases differ from family to family: a point is on a curve known if one of the type passes the same parameter value at the family's second
// parameter with the same period.
bool CycleChart::is_known(const SpecialPoint& point, int multiple) const {
  const double p = point.u[point.u.size() - 1], period = point.u[LimitCycle::log_period];
  const double range = options_.follow.range1[1] - options_.follow.range1[0];
  for (std::size_t i = 0; i < curves_.size(); ++i) {
    const DefiningCurve& curve = curves_[i].curve;
    if (curve.type != point.type || multiple_[i] != multiple) continue;
    for (const CodimensionTwo& at : curve.special) {
      const auto k = at.u.size() - 2;
      if (at.type == "UZ" && at.u[k + 1] == options_.second && std::abs(at.u[k] - p) < same_place * range &&
          std::abs(at.u[LimitCycle::log_period] - period) < same_place)
        return true;
    }
  }
  return false;
}

void CycleChart::say_ends(const DefiningCurve& curve, const CycleFamily& family) const {
  const auto k = curve.u.rows() - 2;
  for (const Eigen::Index column : {Eigen::Index{0}, curve.u.cols() - 1}) {
    const Vector u = curve.u.col(column);
    const bool shrinks = u[LimitCycle::first_harmonic] <= 1.000001 * family.least_harmonic;
    if (!shrinks && u[LimitCycle::log_period] < std::log(family.longest_period) - 1e-9) continue;
    context_.warn(fmt::format("curve {} ends at {} = {:.8g}, {} = {:.8g} where its cycle {}", curve.name, flow2_.parameter_names()[0], u[k],
                              flow2_.parameter_names()[1], u[k + 1],
                              shrinks ? "shrinks to an equilibrium: a curve of folds does so at a generalised Hopf point"
                                      : fmt::format("passes cycles.longest_period ({:.6g})", family.longest_period)));
  }
}

// Without the points that only `is_known` asked for.
ChartCurve CycleChart::shown(ChartCurve curve) const {
  const auto& asked = options_.follow.walk.user_values;
  if (std::find(asked.begin(), asked.end(), options_.second) == asked.end())
    std::erase_if(curve.curve.special, [&](const CodimensionTwo& at) { return at.type == "UZ" && at.u[at.u.size() - 1] == options_.second; });
  return curve;
}

std::vector<ChartCurve> CycleChart::curves() const {
  std::vector<ChartCurve> all;
  for (const ChartCurve& curve : curves_) all.push_back(shown(curve));
  return all;
}

void CycleChart::follow(const CycleFamily& family) {
  problems_.push_back(std::make_unique<LimitCycle>(flow2_, family.single->phase(), options_.cycle));
  TwoParameterOptions follow = options_.follow;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  follow.bounds.push_back({LimitCycle::first_harmonic, family.least_harmonic, infinity});
  follow.bounds.push_back({LimitCycle::log_period, -infinity, std::log(family.longest_period)});
  const auto& asked = options_.follow.walk.user_values;
  const bool marked = std::find(asked.begin(), asked.end(), options_.second) != asked.end();
  if (!marked) follow.walk.user_values.push_back(options_.second);  // where curves pass the families: see is_known
  const OrbitProblem* problem = problems_.back().get();
  for (int level = 0; level < family.net->levels() && !interrupted; ++level) {
    if (level > 0) problem = &problem->doubled();
    Chart chart(*problem, follow);
    chart.want(options_.curves);
    chart.set_observer([](const Branch&, int) { return !interrupted; });
    chart.on_warning([this](const std::string& text) { context_.warn(text); });
    chart.on_curve([this, level, &family](DefiningCurve& curve) {
      curve.name = curve_name(curve, curves_.size() + 1);
      curves_.push_back({.curve = curve, .columns = columns_});
      multiple_.push_back(1 << level);
      if (on_curve_) on_curve_(shown(curves_.back()));
      say_ends(curve, family);
      context_.progress.show(fmt::format("curve {}", curve.name));
    });
    for (const Branch& b : family.net->network(level).branches())
      for (std::size_t i = 0; i < b.special.size() && !interrupted; ++i) {
        const bool arrival = b.stop_reason == StopReason::symmetric_branch && i + 1 == b.special.size();  // stands on the other branch
        if (!arrival && !is_known(b.special[i], 1 << level))
          chart.follow_from(b.special[i], options_.second, fmt::format("{}:{}", b.name, label(b, i)));
      }
  }
}

}  // namespace whirl::studies
