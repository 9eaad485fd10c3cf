#pragma once
/// `[equilibrium_model]` of a study file: x' = f(x, p) given as expressions, in place of a cable.

#include "models/equilibrium_model.hpp"
#include "studies/configuration.hpp"

namespace whirl::studies {

FreeSection equilibrium_model_section(bool required = false);

/// The model in the file, read and tried out: expressions parse, mirrors hold. InputError, one line, otherwise.
models::EquilibriumModel equilibrium_model_of(const Configuration& c);

/// The model as it is continued in the parameters `lenses`: coordinates that a symmetry leaves free are pinned (key `phase`), sums that the
/// equations conserve are held beside those of `conserved`; `notes` gets a line for each sum found.
models::EquilibriumModel isolated_model_of(const Configuration& c, const std::vector<std::string>& lenses, std::vector<std::string>& notes);

/// The name is a parameter of the model; InputError at `key` naming the nearest otherwise.
void check_equilibrium_lens(const Configuration& c, const models::EquilibriumModel& model, const std::string& key, const std::string& lens);

}  // namespace whirl::studies
