#pragma once
/// Study kind `periodic`: exact periodic responses by harmonic balance, their stability by Floquet multipliers, every special point, branches of
/// doubled period, curves in two parameters, and the motions at chosen frequencies checked by integration.

#include "studies/registry.hpp"

namespace whirl::studies {
StudyKind periodic_study();
}  // namespace whirl::studies
