#pragma once
/// Study kind `compare`: averaged, exact and integrated motions of one system side by side, every special point matched, and how far the averaged
/// curve can be trusted.

#include "studies/registry.hpp"

namespace whirl::studies {
StudyKind compare_study();
}  // namespace whirl::studies
