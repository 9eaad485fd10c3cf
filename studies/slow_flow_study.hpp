#pragma once
/// Study kind "slow-flow": averaged equations for any list of harmonics, their branches and special points, time integration beside them.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind slow_flow_study();

}  // namespace whirl::studies
