#include "studies/attractor_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/parallel.hpp"
#include "models/sweeps.hpp"
#include "studies/integration_output.hpp"

namespace whirl::studies {

using namespace models;

namespace {

constexpr double part_of_softening = 0.1;  // of the displacement at which a term equals the linear force: the least half width of the box

// Displacement at which the first term of the coordinate's own equation is as large as its linear force; 0 without one.
double natural_size(const ModalSystem<double>& s, int i) {
  double least = 0.0;
  for (const auto& t : s.terms) {
    if (t.equation != i || t.degree < 2 || t.coefficient == 0.0) continue;
    const double size = std::pow(std::abs(s.stiffness[static_cast<std::size_t>(i)] / t.coefficient), 1.0 / (t.degree - 1));
    if (size > 0.0 && (least == 0.0 || size < least)) least = size;
  }
  return least;
}

// At the middles of `count` equal parts of the range.
std::vector<double> middles(double lower, double upper, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(lower + (upper - lower) * (i + 0.5) / count);
  return values;
}

// Half widths of (q, q').
Vector box_of(const ModalSystem<double>& s, const Vector& size, double reach) {
  const int n = s.size();
  Vector box(2 * n);
  for (int i = 0; i < n; ++i) box[i] = std::max(reach * size[i], part_of_softening * natural_size(s, i));
  const double largest = box.head(n).maxCoeff();
  for (int i = 0; i < n; ++i) {
    if (!(box[i] > 0.0)) box[i] = largest > 0.0 ? largest : 1.0;
    const double stiffness = s.stiffness[static_cast<std::size_t>(i)];
    box[n + i] = box[i] * (stiffness > 0.0 ? std::sqrt(stiffness) : s.omega);
  }
  return box;
}

}  // namespace

void AttractorCheck::integrate(double lower, double upper, const Vector& size, double budget, RunContext& context) {
  done_ = true;
  const auto system_at = [&](double p) { return source_->at(Vector::Constant(1, p)); };
  if (options_.starts == 0 || !std::isfinite(slowest_decay(system_at(0.5 * (lower + upper))))) return;
  std::vector<double> values = middles(lower, upper, options_.values);
  const auto periods_at = [&](double p) {
    return static_cast<int>(std::clamp(options_.decays * slowest_decay(system_at(p)), static_cast<double>(options_.least_periods),
                                       static_cast<double>(options_.most_periods)));
  };
  double one_each = 0.0;  // excitation periods of one start at each value
  for (const double p : values) one_each += options_.part_needed * periods_at(p);
  int starts = options_.starts;
  if (options_.bounded && starts * one_each > budget) {
    starts = std::max(1, static_cast<int>(budget / one_each));
    const double affordable = std::min(1.0, budget / (starts * one_each));
    values = middles(lower, upper, std::max(1, static_cast<int>(affordable * options_.values)));
  }
  const auto reflections = state_reflections(*source_);
  std::vector<SurveyResult> results(values.size());
  std::atomic<int> finished{0};
  parallel_for(values.size(), [&](std::size_t i) {
    const ModalSystem<double> system = system_at(values[i]);
    SurveyOptions o{.starts = starts, .first = static_cast<int>(i) * starts, .half_width = box_of(system, size, options_.reach), .settle = {}};
    o.settle.max_periods = periods_at(values[i]);
    o.settle.max_multiple = options_.max_multiple;
    o.settle.nonperiodic_after = std::max(1, 2 * o.settle.max_periods / 3);
    o.settle.lyapunov_periods = std::clamp(o.settle.max_periods / 4, 64, 400);
    o.settle.interrupted = &interrupted;
    results[i] = survey_attractors(system, reflections, o);
    context.progress.show(fmt::format("integrating starts, {} of {} values", ++finished, values.size()));
  });
  context.progress.clear();
  for (std::size_t i = 0; i < values.size(); ++i) {
    starts_ += results[i].starts;
    unsettled_ += results[i].unsettled;
    diverged_ += results[i].diverged;
    failed_ += results[i].failed;
    longest_ = std::max(longest_, periods_at(values[i]));
    for (auto& m : results[i].attractors) met_.push_back({values[i], std::move(m), ""});
  }
  values_ = std::move(values);
}

bool AttractorCheck::complete() const {
  return unsettled_ == 0 && failed_ == 0 && std::none_of(met_.begin(), met_.end(), [](const auto& m) { return m.branch.empty(); });
}

// "periodic 3T at 1.9, 2.1; chaotic at 2.2"
std::string AttractorCheck::motions_without_branch() const {
  std::map<std::string, std::vector<std::string>> where;
  for (const auto& m : met_)
    if (m.branch.empty()) where[name_of(m.motion.motion.kind, m.motion.motion.multiple)].push_back(fmt::format("{:.6g}", m.p));
  std::vector<std::string> parts;
  for (auto& [name, values] : where) {
    values.erase(std::unique(values.begin(), values.end()), values.end());
    parts.push_back(fmt::format("{} at {}", name, fmt::join(values, ", ")));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

std::string AttractorCheck::text(const std::string& parameter) const {
  if (starts_ == 0) return "";
  const std::string head = fmt::format("{} starts integrated at {} values of {}: ", starts_, values_.size(), parameter);
  const std::string grown = diverged_ > 0 ? fmt::format(", {} grow without bound", diverged_) : "";
  if (complete()) return head + (diverged_ > 0 ? "all others settle on branches found" : "all settle on branches found") + grown;
  int elsewhere = 0;
  for (const auto& m : met_) elsewhere += m.branch.empty() ? m.motion.starts : 0;
  std::string out = head + fmt::format("{} settle on branches found", starts_ - unsettled_ - diverged_ - failed_ - elsewhere);
  if (elsewhere > 0) out += fmt::format(", {} on motions that no branch holds ({})", elsewhere, motions_without_branch());
  if (unsettled_ > 0) out += fmt::format(", {} have not settled after {} excitation periods", unsettled_, longest_);
  if (failed_ > 0) out += fmt::format(", {} could not be integrated", failed_);
  return out + grown;
}

std::string AttractorCheck::json(const std::string& parameter) const {
  const auto missing = std::count_if(met_.begin(), met_.end(), [](const auto& m) { return m.branch.empty(); });
  return fmt::format(
      R"({{"starts": {}, "values": {}, "attractors": {}, "without_branch": {}, "unsettled": {}, "diverged": {}, "failed": {}, "text": "{}"}})",
      starts_, values_.size(), met_.size(), missing, unsettled_, diverged_, failed_, text(parameter));
}

void AttractorCheck::write(ResultFile& file, const std::string& parameter) const {
  if (starts_ == 0) return;
  const std::string group = "/verification/attractors";
  std::vector<Column> table{{parameter, source_->lens_units.front(), "continuation parameter", {}},
                            {"multiple", "-", "period of the motion in excitation periods, 0 for none", {}},
                            {"starts", "-", "that settle on it or on its mirror image", {}},
                            {"multiplier", "-", "largest modulus of a Floquet multiplier over its period; NaN without period", {}}};
  TextColumn kind{"kind", "periodic, quasi-periodic or chaotic", {}}, branch{"branch", "that holds it; empty: none", {}};
  for (const auto& q : source_->coordinates) table.push_back({q + "_max", source_->length_unit, "largest |" + q + "|", {}});
  for (const auto& m : met_) {
    const auto& a = m.motion.attractor;
    const double head[] = {m.p, static_cast<double>(a.multiple), static_cast<double>(m.motion.starts),
                           a.multipliers.size() > 0 ? std::abs(a.multipliers[0]) : std::nan("")};
    for (std::size_t i = 0; i < 4; ++i) table[i].values.push_back(head[i]);
    for (std::size_t i = 0; i < source_->coordinates.size(); ++i)
      table[4 + i].values.push_back(m.motion.motion.record.row(static_cast<Eigen::Index>(i)).cwiseAbs().maxCoeff());
    kind.values.emplace_back(to_string(a.kind));
    branch.values.push_back(m.branch);
  }
  file.table(group, table, {kind, branch});
  file.attribute(group, "outcome", text(parameter));
  file.attribute(group, "starts", static_cast<double>(starts_));
  file.attribute(group, "values", static_cast<double>(values_.size()));
}

}  // namespace whirl::studies
