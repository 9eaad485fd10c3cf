#pragma once
/// How many modes of a guy with both ends held lie below a frequency: a count by inertia that cannot miss one.
///
/// The guy is cut into elements so short that none has a mode of its own below the frequency (first frequency >= (pi/l) sqrt(b_min/m), because
/// D >= b_min). By [WittrickWilliams1971] the number of modes is then the number of negative eigenvalues of the assembled dynamic stiffness of the
/// cuts, read off the pivots of its block elimination. Elements are condensed to their ends by polynomials of degree 12. Independent of LinearGuy's
/// eigenproblem. Throws std::invalid_argument for a state of the first-order form and frequencies that are not positive.
///
///     bool complete = modes_below(rest, Plane::in_plane, 8.0) == std::ssize(guy.poles(Plane::in_plane));

#include "models/guy/linear_guy.hpp"

namespace whirl::models::guy {

[[nodiscard]] int modes_below(const Statics& exact, Plane plane, double frequency);

}  // namespace whirl::models::guy
