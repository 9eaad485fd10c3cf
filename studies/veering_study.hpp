#pragma once
/// Study kind "veering": frequencies of a hanging cable against its flexibility, where they cross (level cable) or veer (inclined), hybrid modes.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind veering_study();

}  // namespace whirl::studies
