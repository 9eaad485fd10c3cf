#pragma once
/// Study kind "guy-statics": static state of a guy, its force-displacement curve in both forms, groups of guys on a level, chains of lumped masses.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind guy_statics_study();

}  // namespace whirl::studies
