#pragma once
/// Study kind "cycles": the limit cycles born at the Hopf points of an [equilibrium_model], or of a cable's averaged slow flow, as one parameter
/// varies.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind cycles_study();

}  // namespace whirl::studies
