#pragma once
/// Study kind "catenary-forced": a hanging cable whose end moves periodically: displacements, slope and tension along it, resonance diagram.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind catenary_forced_study();

}  // namespace whirl::studies
