#pragma once
/// Null vectors of a square matrix that is singular or nearly so: its singular vectors of the least singular value.
///
///     [ A   b ] [v]   [0]      [ A'  c ] [w]   [0]
///     [ c'  0 ] [g] = [1]      [ b'  0 ] [g] = [1]       then b <- w/|w|, c <- v/|v| and again
///
/// Small matrices by their SVD, large ones by three such rounds: an LU each in place of an SVD, which costs tens of times as much. Where A is far
/// from singular the rounds are inverse iteration and give vectors near enough for borders.

#include "core/problem.hpp"

namespace whirl::continuation {

/// Unit vectors: A v ~ 0, w' A ~ 0.
void null_vectors(const Matrix& a, Vector& v, Vector& w);

}  // namespace whirl::continuation
