#include "studies/cycle_motions.hpp"

#include <fmt/format.h>

namespace whirl::studies {

using models::LyapunovSpectrum;

void MotionTable::write(ResultFile& file, const std::vector<IntegratedMotion>& motions) const {
  if (motions.empty()) return;
  const std::string rate = unit_of_time == "s" ? "1/s" : "-";
  const Eigen::Index n = static_cast<Eigen::Index>(variables.size());
  std::vector<Column> columns;
  TextColumn kind{"motion", "what the exponents say: none counts as positive or negative within three standard errors", {}};
  const auto add = [&](const std::string& name, const std::string& u, const std::string& description, const auto& value) {
    Column c{name, u, description, {}};
    for (const auto& m : motions) c.values.push_back(value(m));
    columns.push_back(std::move(c));
  };
  const auto entry = [](const Vector& v, Eigen::Index i) { return i < v.size() ? v[i] : std::nan(""); };
  add(parameter, unit, "continuation parameter", [](const IntegratedMotion& m) { return m.parameter; });
  for (Eigen::Index i = 0; i < n; ++i)
    add(variables[static_cast<std::size_t>(i)] + "_start", "", "where the integration began", [&](const auto& m) { return m.start[i]; });
  for (Eigen::Index i = 0; i < n; ++i) {
    add(fmt::format("lyapunov{}", i + 1), rate, "Lyapunov exponent", [&](const auto& m) { return entry(m.spectrum.exponent, i); });
    add(fmt::format("lyapunov{}_error", i + 1), rate, "its standard error, from 20 blocks",
        [&](const auto& m) { return entry(m.spectrum.error, i); });
  }
  const auto if_ok = [](const LyapunovSpectrum& s, double value) { return s.ok() ? value : std::nan(""); };
  add("lyapunov_sum", rate, "sum of all exponents", [&](const auto& m) { return if_ok(m.spectrum, m.spectrum.sum()); });
  add("divergence", rate, "mean divergence along the motion: what the sum must be",
      [&](const auto& m) { return if_ok(m.spectrum, m.spectrum.divergence); });
  add("dimension", "-", "Kaplan-Yorke dimension", [&](const auto& m) { return if_ok(m.spectrum, m.spectrum.dimension()); });
  add("time", unit_of_time, "over which the exponents are means", [](const auto& m) { return m.spectrum.time; });
  for (const auto& m : motions) kind.values.emplace_back(to_string(m.spectrum.kind));
  file.table("/motions", columns, {kind});
}

Json MotionTable::json(const std::vector<IntegratedMotion>& motions, const std::string& parameter) {
  const auto list = [](const Vector& v) { return Json::array(std::vector<double>(v.data(), v.data() + v.size())); };
  Json all = Json::array();
  for (const auto& m : motions) {
    Json o = Json::object();
    o.put(parameter, m.parameter).put("start", list(m.start)).put("motion", to_string(m.spectrum.kind));
    o.put("lyapunov", list(m.spectrum.exponent)).put("lyapunov_error", list(m.spectrum.error)).put("divergence", m.spectrum.divergence);
    o.put("dimension", m.spectrum.dimension());
    all.add(std::move(o));
  }
  return all;
}

std::string MotionTable::text(const std::vector<IntegratedMotion>& motions) const {
  if (motions.empty()) return "";
  std::string out =
      fmt::format("{:>14} {:<15} {}\n", parameter, "motion", "Lyapunov exponents +- standard error; sum against mean divergence; dimension");
  for (const auto& m : motions) {
    out += fmt::format("{:>14.10g} {:<15}", m.parameter, to_string(m.spectrum.kind));
    for (Eigen::Index i = 0; i < m.spectrum.exponent.size(); ++i)
      out += fmt::format(" {:.5g} +- {:.1g},", m.spectrum.exponent[i], m.spectrum.error[i]);
    if (m.spectrum.ok()) out += fmt::format(" sum {:.8g} ({:.8g}); {:.4g}", m.spectrum.sum(), m.spectrum.divergence, m.spectrum.dimension());
    out += '\n';
  }
  return out;
}

}  // namespace whirl::studies
