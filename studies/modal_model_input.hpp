#pragma once
/// `[modal_model]` of a study file: a forced modal system of any number of coordinates, in place of a cable.

#include "models/modal_model.hpp"
#include "studies/configuration.hpp"

namespace whirl::studies {

/// The free section [modal_model] with its example. Give `omega` its own key.
FreeSection modal_model_section(bool required = false);

/// The model in the file; `omega` from the key of that name where the schema has one. InputError, one line, for whatever is wrong with it.
models::ModalModel modal_model_of(const Configuration& c);

/// The name is a number of the model; InputError at `key` naming the nearest otherwise.
void check_modal_lens(const Configuration& c, const models::ModalModel& model, const std::string& key, const std::string& lens);

/// The system with the lenses free: what harmonic balance, slow flow and integration work on.
models::ParametricSystem modal_system_of(const Configuration& c, const std::vector<std::string>& lenses);

}  // namespace whirl::studies
