#include "studies/two_parameter_study.hpp"

#include <fmt/format.h>

#include <cmath>

#include "continuation/chart.hpp"
#include "continuation/held_problem.hpp"
#include "studies/branch_output.hpp"
#include "studies/chart_output.hpp"
#include "studies/common_keys.hpp"
#include "studies/equilibrium_source.hpp"
#include "studies/second_parameter.hpp"

namespace whirl::studies {
namespace {

using namespace continuation;

struct Setup {
  std::unique_ptr<EquilibriumSource> source;
  std::string first, chart_first;  // of the branches and of the chart: most often the same
  NetworkOptions network;
  SecondParameter second;
  bool leaves_first() const { return chart_first != first; }
};

Schema schema() {
  Schema s("two-parameter",
           "curves of folds, branch points, Hopf points and peaks in two parameters, with their codimension-2 points and thresholds");
  add_equilibrium_source_keys(s);
  add_continuation_keys(s, "omega");
  s.add({.name = "continuation.peaks",
         .description = "variables or amplitudes whose extrema along the branches are special points (RP)",
         .default_value = std::vector<std::string>{}});
  s.add({.name = "first.parameter",
         .description = "first parameter of the chart; \"\": that of the branches, which else is held at the value it has at each special point",
         .default_value = std::string("")});
  s.add({.name = "first.range",
         .description = "its lower and upper end, if it is not that of the branches",
         .default_value = std::vector<double>{},
         .optional = true,
         .max_items = 2});
  add_second_keys(s, {.what = "the other parameter of the chart; its value in this file is where the special points are looked for first",
                      .parameter = "support_motion.amplitude",
                      .curves = {"LP", "BP", "HB", "RP"},
                      .required = true});
  return s;
}

// A first parameter of the chart's own.
void read_first(const Configuration& c, Setup& s) {
  s.chart_first = c.text("first.parameter").empty() ? s.first : c.text("first.parameter");
  const auto range = c.has("first.range") ? c.numbers("first.range") : std::vector<double>{};
  if (!s.leaves_first()) {
    if (!range.empty())
      throw c.error("first.range", "goes with a first.parameter other than continuation.parameter, whose range is continuation.range");
    return;
  }
  if (range.size() != 2 || !(range[0] < range[1])) throw c.error("first.range", "must hold two increasing values, the ends of first.parameter");
  if (s.chart_first == s.second.name) throw c.error("first.parameter", "must differ from second.parameter");
  s.source->check_lens("first.parameter", s.chart_first, "first.range", range[0], range[1]);
  const double value = s.source->value(s.chart_first);
  if (value < range[0] || value > range[1])
    throw c.error("first.range", fmt::format("must contain the value {:g} that {} has in this file", value, s.chart_first));
  s.second.follow.range1[0] = range[0];
  s.second.follow.range1[1] = range[1];
}

Setup setup(const Configuration& c) {
  Setup s;
  s.source = equilibrium_source(c);
  s.first = c.text("continuation.parameter");
  check_parameter_given(c, "continuation.parameter");
  check_parameter_given(c, "second.parameter");
  s.network = network_of(c);
  s.source->check_lens("continuation.parameter", s.first, "continuation.range", s.network.walk.lower, s.network.walk.upper);
  s.network.walk.peaks = peaks_of(c, *s.source);
  s.second = read_second(c, s.first, s.network.walk, lens_of(*s.source));
  read_first(c, s);
  return s;
}

std::vector<std::string> check(const Configuration& c) { return setup(c).source->warnings(); }

// The special points of the branches, each followed in the chart's two parameters.
class Charts {
 public:
  Charts(const Setup& s, ResultFile& file, RunContext& context);
  void follow(const std::vector<Branch>& branches, const Observer& observer);
  const ChartOutput& output() const { return output_; }
  const std::vector<ChartCurve>& curves() const { return curves_; }

 private:
  // The chart's two parameters; the branches' own, where it is none of them, held.
  struct HeldChart {
    double held;
    std::unique_ptr<HeldProblem> problem;
    std::unique_ptr<Chart> chart;
  };
  Chart& chart_at(double held, const Observer& observer);

  const Setup& s_;
  ResultFile& file_;
  RunContext& context_;
  std::unique_ptr<Problem> problem_;
  ChartOutput output_;
  std::vector<HeldChart> charts_;  // one for each value held
  std::vector<ChartCurve> curves_;
};

Charts::Charts(const Setup& s, ResultFile& file, RunContext& context)
    : s_(s),
      file_(file),
      context_(context),
      problem_(s.source->problem(s.leaves_first() ? std::vector{s.chart_first, s.second.name, s.first} : std::vector{s.first, s.second.name})),
      output_{s.chart_first, s.source->unit(s.chart_first), s.second.name, s.source->unit(s.second.name)} {
  if (!s.leaves_first()) return;
  output_.held = s.first;
  output_.held_unit = s.source->unit(s.first);
}

Chart& Charts::chart_at(double held, const Observer& observer) {
  for (auto& c : charts_)
    if (!s_.leaves_first() || c.held == held) return *c.chart;
  HeldChart c{held, s_.leaves_first() ? std::make_unique<HeldProblem>(*problem_, held) : nullptr, nullptr};
  c.chart = std::make_unique<Chart>(c.problem ? *c.problem : *problem_, s_.second.follow);
  c.chart->want(s_.second.curves);
  c.chart->set_observer(observer);
  c.chart->on_warning([this](const std::string& text) { context_.warn(text); });
  c.chart->on_curve([this, held](DefiningCurve& curve) {
    curve.name = curve_name(curve, curves_.size() + 1);
    curves_.push_back({curve, held, s_.source->columns(*problem_)});
    output_.write_curve(file_, curves_.back());
    file_.flush();
    context_.progress.show(fmt::format("curve {}", curve.name));
  });
  charts_.push_back(std::move(c));
  return *charts_.back().chart;
}

void Charts::follow(const std::vector<Branch>& branches, const Observer& observer) {
  for (const auto& b : branches)
    for (std::size_t i = 0; i < b.special.size() && !interrupted; ++i) {
      SpecialPoint point = b.special[i];
      // The same point stands on the branch whose symmetry breaks there.
      const bool arrival =
          point.type == EventType::branch_point && point.block == 0 && i + 1 == b.special.size() && b.stop_reason == StopReason::symmetric_branch;
      if (arrival) continue;
      double& first = point.u[point.u.size() - 1];
      const double held = s_.leaves_first() ? first : std::nan("");
      if (s_.leaves_first()) first = s_.source->value(s_.chart_first);
      chart_at(held, observer).follow_from(point, s_.second.value, fmt::format("{}:{}", b.name, label(b, i)));
    }
  for (auto& c : charts_)
    if (!interrupted) c.chart->follow_meetings();  // curves met on the way lead to further ones
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : s.source->warnings()) context.warn(w);
  const auto f = s.source->problem({s.first});
  ResultFile file(context.output);
  write_study(file, c);
  s.source->write(file, context);
  const Observer observer = [](const Branch&, int) { return !interrupted; };
  Network net(*f, s.network);
  net.set_namer(s.source->namer());
  net.set_observer(observer);
  for (const Start& start : s.source->starts(*f, s.first, s.network.walk.lower, s.network.walk.upper)) {
    if (net.stopped()) break;
    try_seed(net, start.u, start.origin, context);
    net.switch_branches();
  }
  Charts charts(s, file, context);
  charts.follow(net.branches(), observer);
  context.progress.clear();
  const auto& curves = charts.curves();
  charts.output().write_points(file, "/special_points", curves);
  context.report.put("special_points", charts.output().points_json(curves)).put("curves", ChartOutput::curves_json(curves));
  context.print(charts.output().text(curves));
  if (curves.empty()) {
    const auto& walk = s.network.walk;
    context.warn(fmt::format("no {} with {} in [{:g}, {:g}]: no chart",
                             net.branches().empty() ? "equilibrium was found" : "special point lies on a branch", s.first, walk.lower, walk.upper));
  }
  return finish(file, context, net.branches());
}

}  // namespace

StudyKind two_parameter_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
