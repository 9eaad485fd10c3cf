#pragma once
/// Study kind "catenary-modes": natural frequencies and modes of a hanging cable of any sag, and their dependence on the sag.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind catenary_modes_study();

}  // namespace whirl::studies
