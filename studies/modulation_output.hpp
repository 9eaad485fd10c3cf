#pragma once
/// Averaged equations in time beside the demodulated motion, from starts at rest: tables, JSON and text.
///
///     for (const auto& start : starts) runs.push_back({start, models::modulation(system, averaged, p, start.state, options)});
///     write_modulations(file, labels, runs);          // /verification/modulation/run<n>
///     context.print(modulations_text(labels, runs));

#include "models/dynamics/averaging/modulation.hpp"
#include "studies/json.hpp"
#include "studies/result_file.hpp"

namespace whirl::studies {

class Schema;

struct ModulationRun {
  double omega;
  std::string start;  ///< its name
  models::Modulation modulation;
};

struct ModulationLabels {
  std::vector<std::string> coordinates;
  std::string length_unit;
  int nu = 1;
};

void add_modulation_keys(Schema& schema);
void write_modulations(ResultFile& file, const ModulationLabels& labels, const std::vector<ModulationRun>& runs);
Json modulations_json(const ModulationLabels& labels, const std::vector<ModulationRun>& runs);
std::string modulations_text(const ModulationLabels& labels, const std::vector<ModulationRun>& runs);

}  // namespace whirl::studies
