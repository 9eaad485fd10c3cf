#include "studies/modulation_output.hpp"

#include <fmt/format.h>

#include "studies/branch_output.hpp"
#include "studies/configuration.hpp"

namespace whirl::studies {
namespace {

std::string name_of(const ModulationLabels& labels, std::pair<int, int> row) {
  return harmonic_name(labels.coordinates[static_cast<std::size_t>(row.first)], static_cast<double>(row.second) / labels.nu);
}

std::vector<double> values(const Eigen::VectorXd& v) { return {v.data(), v.data() + v.size()}; }

void write_modulations(ResultFile& file, const ModulationLabels& labels, const std::vector<ModulationRun>& runs) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const models::Modulation& m = runs[i].modulation;
    std::vector<Column> table{{"t", "s", "time from the start", values(m.t)}};
    for (std::size_t r = 0; r < m.rows.size(); ++r) {
      const auto row = static_cast<Eigen::Index>(r);
      const std::string name = name_of(labels, m.rows[r]);
      const bool mean = m.rows[r].second == 0;
      for (const bool integrated : {true, false}) {
        const Eigen::RowVectorXcd z = integrated ? m.integrated.row(row) : m.averaged.row(row);
        const std::string prefix = integrated ? "" : "averaged_", how = integrated ? ", integrated and demodulated" : ", averaged equations";
        table.push_back(
            {prefix + name + "_u", labels.length_unit, (mean ? "mean" : "real part of the amplitude") + how, values(z.real().transpose())});
        if (!mean) table.push_back({prefix + name + "_v", labels.length_unit, "imaginary part of the amplitude" + how, values(z.imag().transpose())});
      }
    }
    const std::string group = fmt::format("/verification/modulation/run{}", i + 1);
    file.table(group, table);
    file.attribute(group, "omega", runs[i].omega);
    file.attribute(group, "start", runs[i].start);
    file.attribute(group, "difference", m.difference());
    if (!m.why.empty()) file.attribute(group, "ended_early", m.why);
  }
}

Json modulations_json(const ModulationLabels& labels, const std::vector<ModulationRun>& runs) {
  Json all = Json::array();
  for (const auto& run : runs) {
    const models::Modulation& m = run.modulation;
    Json o = Json::object();
    o.put("omega", run.omega).put("start", run.start).put("difference", m.difference()).put("why", m.why);
    for (std::size_t r = 0; r < m.rows.size(); ++r) {
      if (m.t.size() == 0) break;
      const std::string name = name_of(labels, m.rows[r]);
      o.put(name + "_peak", m.integrated.row(static_cast<Eigen::Index>(r)).cwiseAbs().maxCoeff());
      o.put("averaged_" + name + "_peak", m.averaged.row(static_cast<Eigen::Index>(r)).cwiseAbs().maxCoeff());
    }
    all.add(std::move(o));
  }
  return all;
}

std::string modulations_text(const ModulationLabels& labels, const std::vector<ModulationRun>& runs) {
  std::string out =
      "averaged equations in time against the demodulated motion: peaks integrated / averaged, largest difference over the largest averaged "
      "amplitude\n";
  for (const auto& run : runs) {
    const models::Modulation& m = run.modulation;
    out += fmt::format("{:>8.4f} {:<24}", run.omega, run.start);
    if (m.t.size() == 0) {
      out += fmt::format(" {}\n", m.why);
      continue;
    }
    const double top = m.integrated.cwiseAbs().maxCoeff();
    for (std::size_t r = 0; r < m.rows.size(); ++r) {
      const auto row = static_cast<Eigen::Index>(r);
      const double integrated = m.integrated.row(row).cwiseAbs().maxCoeff(), averaged = m.averaged.row(row).cwiseAbs().maxCoeff();
      if (std::max(integrated, averaged) > 0.05 * top) out += fmt::format(" {} {:.4f} / {:.4f}", name_of(labels, m.rows[r]), integrated, averaged);
    }
    out += fmt::format("  difference {:.3f}{}\n", m.difference(), m.why.empty() ? "" : "; ends early: " + m.why);
  }
  return out;
}

}  // namespace

void add_modulation_keys(Schema& s) {
  s.add_count("verification.modulation_periods",
              "excitation periods over which the averaged equations run beside the demodulated motion, from each start at rest; 0: none", 60, 0,
              100000);
}

void tell_modulations(ResultFile& file, RunContext& context, const ModulationLabels& labels, const std::vector<ModulationRun>& runs) {
  if (runs.empty()) return;
  write_modulations(file, labels, runs);
  file.flush();
  context.report.put("modulation", modulations_json(labels, runs));
  context.print(fmt::format("\n{}", modulations_text(labels, runs)));
}

}  // namespace whirl::studies
