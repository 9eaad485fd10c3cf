#pragma once
/// The study kinds: what each accepts and what runs it.

#include <functional>
#include <span>

#include "studies/configuration.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

struct StudyKind {
  Schema schema;
  std::function<ExitStatus(const Configuration&, RunContext&)> run;
  std::function<std::vector<std::string>(const Configuration&)> check;  ///< warnings; throws InputError. What `whirl check` does beyond the schema.
};

const std::vector<StudyKind>& study_kinds();
std::vector<Schema> schemas();
const StudyKind& study_kind(std::string_view name);  ///< throws InputError with the nearest name

}  // namespace whirl::studies
