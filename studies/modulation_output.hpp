#pragma once
/// Averaged equations in time beside the demodulated motion, from starts at rest: tables, JSON and text.
///
///     for (const auto& start : starts) runs.push_back({start, models::modulation(system, averaged, p, start.state, options)});
///     tell_modulations(file, context, labels, runs);          // /verification/modulation/run<n>, "modulation", a line a run

#include "models/dynamics/averaging/modulation.hpp"
#include "studies/result_file.hpp"
#include "studies/run_context.hpp"

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
/// To the file, the report and the screen; nothing if there are no runs.
void tell_modulations(ResultFile& file, RunContext& context, const ModulationLabels& labels, const std::vector<ModulationRun>& runs);

}  // namespace whirl::studies
