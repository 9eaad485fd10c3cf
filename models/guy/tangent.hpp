#pragma once
/// Static stiffness of a guy's upper end at fixed unstressed length.
///
/// Exact form: the compliance of the catenary, u = asinh(V(s)/H), e = (sech u, tanh u),
///
///     C = (L0/AE) I + (1/w) int (I - e e^T) du,     K = C^-1,     out of plane  K_z = H/l
///
/// evaluated along the chord and across it, so that nothing cancels for a taut guy. First-order form: dH/dl by [Sarvi1968, eq. (2.37)], with
/// cosh r - sinh r/r by its series below r = 0.3 (the quotient loses log10(3/r^2) digits).
///
///     const Tangent k = tangent(rest);                   // k.xx, k.xy, k.yy, k.zz [N/m]

#include "models/guy/statics.hpp"

namespace whirl::models::guy {

struct Tangent {
  double xx, xy, yy, zz;  ///< change of the force at the upper end per its displacement [N/m]
};

/// Of an exact state.
[[nodiscard]] Tangent tangent(const Statics& exact);

/// dH/dl of either form [N/m]; first order: (2.37).
[[nodiscard]] double horizontal_modulus(const Statics& state);

/// dH/dL0 at fixed ends, of an exact state [N/m]: how a turnbuckle acts. Negative.
[[nodiscard]] double tension_per_unstressed_length(const Statics& exact);

}  // namespace whirl::models::guy
