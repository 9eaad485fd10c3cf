#pragma once
/// Study kind "mode-convergence": whirling threshold and peak amplitude of a cable against the number of modes, both treatments of the stretching.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind mode_convergence_study();

}  // namespace whirl::studies
