#pragma once
/// Functions with a corner or a jump as vector fields given as text mean them, in any depth of duals. Beside it derivatives are exact; on it the
/// slopes of one side are taken, of a jump none. What is no number stays none.

#include <cmath>

#include "core/dual.hpp"

namespace whirl::models::detail {

/// -1, 0 or 1.
template <class S>
S sign(const S& a) {
  const double x = value_of(a);
  return S(x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x);
}

/// a or b, whichever is larger; with `sense` = -1 the smaller.
template <class S>
S larger(const S& a, const S& b, double sense = 1.0) {
  const double x = sense * value_of(a), y = sense * value_of(b);
  return x >= y || std::isnan(x) ? a : b;
}

}  // namespace whirl::models::detail
