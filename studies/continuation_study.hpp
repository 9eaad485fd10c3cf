#pragma once
/// Study kind "continuation": rest points of an [equilibrium_model], or of a cable's averaged slow flow, as one parameter varies.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind continuation_study();

}  // namespace whirl::studies
