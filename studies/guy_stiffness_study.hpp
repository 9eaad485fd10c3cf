#pragma once
/// Study kind "guy-stiffness": dynamic stiffness of a guy at the mast against frequency, the full linear problem beside the closed forms.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind guy_stiffness_study();

}  // namespace whirl::studies
