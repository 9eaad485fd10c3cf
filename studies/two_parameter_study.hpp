#pragma once
/// Study kind "two-parameter": curves of folds, whirling points and Hopf points of the averaged superharmonic response in two parameters.

#include "studies/registry.hpp"

namespace whirl::studies {

StudyKind two_parameter_study();

}  // namespace whirl::studies
