#pragma once
/// Study kind "guy-modes": transverse modes of a guy with linear tension, of the string, and of the full linear problem, with their shapes.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind guy_modes_study();

}  // namespace whirl::studies
