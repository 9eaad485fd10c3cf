#pragma once
/// [model]: how many modes, and how the cable's stretching is treated. Shared by every kind that takes a forced modal system.

#include "models/multimode/cable_model.hpp"
#include "studies/configuration.hpp"

namespace whirl::studies {

/// model.kind, model.in_plane_modes, model.out_of_plane_modes, model.in_plane, model.out_of_plane, model.longitudinal, model.shapes.
void add_model_keys(Schema& schema);

/// With the keys of add_stay_keys(schema, true) and add_model_keys. Throws InputError.
models::CableModel cable_model_of(const Configuration& c);

/// The paper's own two-mode stay: kind two-mode, upper end, horizontal, galerkin.
bool is_plain_stay(const Configuration& c);
bool is_multi_mode(const Configuration& c);
/// "q1", "q2" of the two-mode kind, else "y1", ..., "z1", ...
std::vector<std::string> coordinate_names(const Configuration& c);

}  // namespace whirl::studies
