#pragma once
/// The kind `basins`: which attractor each start of a plane goes to.

#include "studies/registry.hpp"

namespace whirl::studies {
StudyKind basins_study();
}
