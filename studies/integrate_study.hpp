#pragma once
/// The kind `integrate`: motions in time from given starts, what they settle on, and sweeps with their jumps.

#include "studies/registry.hpp"

namespace whirl::studies {
StudyKind integrate_study();
}
