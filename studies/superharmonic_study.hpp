#pragma once
/// Study kind "superharmonic": frequency response of a stay by the averaged equations of order n, its special points, and time integration beside it.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind superharmonic_study();

}  // namespace whirl::studies
