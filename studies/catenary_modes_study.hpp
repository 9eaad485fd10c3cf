#pragma once
/// Study kind "catenary-modes": natural frequencies and modes of a hanging cable of any sag, and their dependence on the sag.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind catenary_modes_study();
/// What `whirl modes` prints of a study with a hanging cable: its eight lowest frequencies a plane.
std::string hanging_modes_table(const Configuration& c);

}  // namespace whirl::studies
