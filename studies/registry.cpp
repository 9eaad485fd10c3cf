#include "studies/registry.hpp"

#include <fmt/format.h>

#include "studies/basins_study.hpp"
#include "studies/catenary_forced_study.hpp"
#include "studies/catenary_modes_study.hpp"
#include "studies/compare_study.hpp"
#include "studies/continuation_study.hpp"
#include "studies/cycles_study.hpp"
#include "studies/guy_modes_study.hpp"
#include "studies/guy_statics_study.hpp"
#include "studies/guy_stiffness_study.hpp"
#include "studies/integrate_study.hpp"
#include "studies/mode_convergence_study.hpp"
#include "studies/modes_study.hpp"
#include "studies/periodic_study.hpp"
#include "studies/slow_flow_study.hpp"
#include "studies/superharmonic_study.hpp"
#include "studies/two_parameter_study.hpp"
#include "studies/veering_study.hpp"

namespace whirl::studies {

const std::vector<StudyKind>& study_kinds() {
  static const std::vector<StudyKind> kinds = {
      superharmonic_study(),   continuation_study(), cycles_study(),      two_parameter_study(), periodic_study(),         slow_flow_study(),
      compare_study(),         integrate_study(),    basins_study(),      modes_study(),         mode_convergence_study(), catenary_modes_study(),
      catenary_forced_study(), veering_study(),      guy_statics_study(), guy_modes_study(),     guy_stiffness_study(),
  };
  return kinds;
}

std::vector<Schema> schemas() {
  std::vector<Schema> all;
  for (const auto& k : study_kinds()) all.push_back(k.schema);
  return all;
}

const StudyKind& study_kind(std::string_view name) {
  std::vector<std::string> names;
  for (const auto& k : study_kinds()) {
    if (k.schema.kind() == name) return k;
    names.push_back(k.schema.kind());
  }
  const std::string guess = nearest(name, names);
  throw InputError(
      fmt::format("unknown study kind '{}'{}", name, guess.empty() ? "; `whirl list` names them" : fmt::format(", did you mean '{}'?", guess)));
}

}  // namespace whirl::studies
