#pragma once
/// Guys that hold one point of a mast: horizontal reaction to a displacement of that point.
///
/// Guy j leaves the mast towards its anchor at azimuth a_j. The point moves by d in direction t. Two named terms:
///
///     axial:           span l_j - d cos(t - a_j), tension kept in the guy's old vertical plane            (as [Sarvi1968, ch. II] does)
///     full_geometry:   span |l_j a_j - d t|, tension along the new direction: adds the transverse part H/l
///
/// Tangent at rest of n >= 3 equal guys, equally spread: (n/2) dH/dl, and (n/2)(dH/dl + H/l) with the transverse part.
/// Azimuths and directions in rad. Throws std::invalid_argument for an empty group and displacements no guy can follow.
///
///     const Group level = equal_group(rest, 3);
///     const Reaction r = reaction(level, 0.5, 0.0, GroupTerms::full_geometry);    // r.along, r.across [N], against the displacement

#include <vector>

#include "models/guy/statics.hpp"

namespace whirl::models::guy {

enum class GroupTerms { axial, full_geometry };

struct Member {
  Statics rest;
  double azimuth = 0.0;  ///< from the mast towards the anchor [rad]
};
using Group = std::vector<Member>;

struct Reaction {
  double along, across;                      ///< [N]; along is positive where the group holds the point back, across is 90 degrees counter-clockwise
  double largest_tension, smallest_tension;  ///< upper ends [N]
};

/// n equal guys at azimuths first + 2 pi j/n.
[[nodiscard]] Group equal_group(const Statics& rest, int n, double first_azimuth = 0.0);

[[nodiscard]] Reaction reaction(const Group& group, double displacement, double direction, GroupTerms terms);

/// d(along)/d(displacement) at rest [N/m].
[[nodiscard]] double group_modulus(const Group& group, double direction, GroupTerms terms);

}  // namespace whirl::models::guy
