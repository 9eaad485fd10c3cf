#pragma once
/// Study kind "modes": statics, linear modes, cross-overs and resonance conditions of a shallow cable, [IrvineCaughey1974].

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind modes_study();

/// The table `whirl modes FILE` prints: for a study of this kind, and for any other whose [cable] gives a chord tension.
std::string modes_table(const Configuration& c);

}  // namespace whirl::studies
