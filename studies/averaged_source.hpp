#pragma once
/// Averaged equations of any ansatz as an equilibrium problem: of a [modal_model], or of a [cable] with an [ansatz].

#include "studies/equilibrium_source.hpp"

namespace whirl::studies {

std::unique_ptr<EquilibriumSource> averaged_source(const Configuration& c);

}  // namespace whirl::studies
