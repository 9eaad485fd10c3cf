#include "studies/continuation_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "continuation/deflation.hpp"
#include "studies/common_keys.hpp"
#include "studies/equilibrium_source.hpp"
#include "studies/shown_columns.hpp"

namespace whirl::studies {
namespace {

using namespace continuation;

struct Setup {
  std::unique_ptr<EquilibriumSource> source;
  std::string parameter;
  NetworkOptions network;
  std::vector<std::vector<double>> seeds;
};

Schema schema() {
  Schema s("continuation", "rest points of any system given as expressions, or of a cable's averaged slow flow, as one parameter varies");
  add_equilibrium_source_keys(s);
  add_continuation_keys(s, "omega");
  s.add({.name = "continuation.peaks",
         .description = "variables or amplitudes whose extrema along the branches are reported as RP",
         .default_value = std::vector<std::string>{}});
  s.add({.name = "continuation.seeds",
         .description = "starts of further branches: the variables and then the parameter, one start after the other",
         .default_value = std::vector<double>{}});
  s.add({.name = "continuation.deflate_at",
         .description = "parameter values at which further solutions are looked for by deflation when all branches are known",
         .default_value = std::vector<double>{}});
  return s;
}

Setup setup(const Configuration& c) {
  Setup s;
  s.source = equilibrium_source(c);
  check_parameter_given(c, "continuation.parameter");
  s.parameter = c.text("continuation.parameter");
  s.network = network_of(c);
  s.source->check_lens("continuation.parameter", s.parameter, "continuation.range", s.network.walk.lower, s.network.walk.upper);
  s.network.walk.peaks = peaks_of(c, *s.source);
  const auto& seeds = c.numbers("continuation.seeds");
  const auto width = static_cast<std::size_t>(s.source->problem({s.parameter})->size()) + 1;
  if (seeds.size() % width != 0)
    throw c.error("continuation.seeds", fmt::format("must hold groups of {} numbers: the variables, then {}", width, s.parameter));
  for (std::size_t i = 0; i < seeds.size(); i += width)
    s.seeds.emplace_back(seeds.begin() + static_cast<std::ptrdiff_t>(i), seeds.begin() + static_cast<std::ptrdiff_t>(i + width));
  for (const auto& seed : s.seeds)
    if (!(seed.back() >= s.network.walk.lower && seed.back() <= s.network.walk.upper))
      throw c.error("continuation.seeds", fmt::format("the {} of each must lie in continuation.range", s.parameter));
  for (const double p : c.numbers("continuation.deflate_at"))
    if (p < s.network.walk.lower || p > s.network.walk.upper) throw c.error("continuation.deflate_at", "each value must lie in continuation.range");
  return s;
}

std::vector<std::string> check(const Configuration& c) { return setup(c).source->warnings(); }

// False if no start is isolated.
bool explore(const Problem& f, const Setup& s, Network& net, const std::vector<double>& deflate_at, RunContext& context) {
  const auto windows = s.source->angles();
  std::string not_isolated;
  const auto seed = [&](const Vector& at, const std::string& origin) {
    const Vector u = within_windows(at, windows);
    const std::string why = s.source->not_isolated(f, u);
    if (not_isolated.empty() && !why.empty()) context.warn(not_isolated = fmt::format("{}: {}", origin, why));
    if (!why.empty()) return;
    try_seed(net, u, origin, context);
    net.switch_branches();
  };
  for (const Start& start : s.source->starts(f, s.parameter, s.network.walk.lower, s.network.walk.upper)) seed(start.u, start.origin);
  for (std::size_t i = 0; i < s.seeds.size(); ++i) seed(Eigen::Map<const Vector>(s.seeds[i].data(), f.size() + 1), fmt::format("seed {}", i + 1));
  for (const double p : deflate_at) {
    std::vector<Vector> known;
    for (const auto& [branch, u] : net.solutions_at(p)) known.push_back(u);
    std::vector<Vector> starts;
    for (const auto& u : known)
      for (const double part : {0.3, -0.3, 1.0, -1.0, 3.0, -3.0})
        for (int i = 0; i < f.size(); ++i) {
          starts.push_back(u);
          starts.back()[i] += part * std::max(1.0, std::abs(u[i]));
        }
    for (const auto& b : net.branches())  // whatever the branches pass through, seen at p
      for (int i = 0; i < b.points(); i += std::max(1, b.points() / 5)) {
        starts.push_back(b.u(i));
        starts.back()[f.size()] = p;
      }
    const auto all = deflated_solutions(f, known, starts);
    for (std::size_t i = known.size(); i < all.size(); ++i) seed(all[i], fmt::format("deflation at {} = {:.6g}", s.parameter, p));
  }
  follow_angles(net, *s.source, context);
  if (net.branches().empty() && not_isolated.empty()) context.warn("no rest point was found in the range");
  return not_isolated.empty() || !net.branches().empty();
}

// The observer has ended a branch of solutions that are not isolated: what changed along it was rounding.
void end_not_isolated(std::vector<Branch>& branches, const std::string& first) {
  std::erase_if(branches, [&](const Branch& b) { return b.stop_reason == StopReason::observer && b.name != first; });
  for (Branch& b : branches)
    for (StopReason* reason : {&b.start_reason, &b.stop_reason})
      if (*reason == StopReason::observer) {
        *reason = StopReason::min_step;
        b.special.clear();
      }
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : s.source->warnings()) context.warn(w);
  const auto f = s.source->problem({s.parameter});
  BranchOutput output;
  output.parameter = s.parameter;
  output.parameter_unit = s.source->unit(s.parameter);
  output.columns = s.source->columns(*f);
  append_unshown(output.columns, s.source->extremes(*f));
  ResultFile file(context.output);
  write_study(file, c);
  s.source->write(file, context);
  NetworkOptions options = s.network;
  for (const auto& window : s.source->angles()) options.walk.bounds.push_back(window.bound);
  Network net(*f, options);
  net.set_namer(s.source->namer());
  std::string left_isolation;
  net.set_observer([&](const Branch& b, int i) {
    constexpr int between_looks = 20;
    if (s.source->may_leave_isolation() && i % between_looks == 2) left_isolation = s.source->not_isolated(*f, b.u(i));
    if (!left_isolation.empty()) return false;
    if (i % 50 == 0) context.progress.show(fmt::format("branch at {} = {:.6g}, {} points", s.parameter, b.parameter(i), i));
    return !interrupted;
  });
  std::string first_loose;  // of the branches that are not isolated one stands for all
  net.on_branch([&](const Branch& b) {
    if (!left_isolation.empty() && !std::exchange(first_loose, first_loose.empty() ? b.name : first_loose).empty()) return;
    output.write_branch(file, b);
    file.flush();
  });
  const bool isolated = explore(*f, s, net, c.numbers("continuation.deflate_at"), context);
  auto branches = s.source->marked(net.branches(), context);
  if (!left_isolation.empty()) {
    context.warn(left_isolation);
    end_not_isolated(branches, first_loose);
  }
  output.write_special_points(file, branches);
  file.flush();
  if (const auto left = net.not_followed(); !left.empty() && !net.stopped() && s.network.depth > 0)
    context.warn(fmt::format("branches at {} are not followed: continuation.depth is {}", fmt::join(left, ", "), s.network.depth));
  for (const auto& note : net.notes())
    if (std::find(context.warnings.begin(), context.warnings.end(), note) == context.warnings.end()) context.warn(note);
  context.progress.clear();
  output.report(context.report, branches);
  context.print(output.text(branches));
  if (!isolated) return finish(file, context, ExitStatus::numerical_failure, {context.warnings.back()});
  return finish(file, context, branches);
}

}  // namespace

StudyKind continuation_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
