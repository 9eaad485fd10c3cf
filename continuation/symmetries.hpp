#pragma once
/// Symmetries of a flow that exchange coordinates and change their signs: matrices G with one entry +1 or -1 in each row and column and
///
///     r(G x, p) = G r(x, p)    for all x, p,
///
/// so that G maps branches onto branches. Found by trying: at x = 0, which all of them keep, r_x G = G r_x leaves few candidates; those are tested
/// at random x and p of the size given. What agrees there to rounding may still differ by terms below it: an image is a candidate until Newton has
/// agreed to it.
///
///     for (const SignedPermutation& g : symmetries(flow, {.size = 2.0, .lower = -1.0, .upper = 1.0})) image = g.apply(x);

#include <vector>

#include "continuation/branch.hpp"

namespace whirl::continuation {

struct SignedPermutation {
  std::vector<int> to;  ///< coordinate i of x becomes coordinate to[i], times signs[i]
  Vector signs;
  /// G x; what stands behind the coordinates (parameters) stays.
  Vector apply(In x) const;
};

struct SymmetryOptions {
  double size = 1.0;                ///< of |x|
  double lower = 0.0, upper = 1.0;  ///< range of the one parameter
  int most_coordinates = 8;         ///< larger problems are not searched
  int most_candidates = 50000;      ///< of a problem with so many nothing is found
  double tolerance = 1e-11;         ///< on r(Gx) - Gr(x), relative to the largest |r| met
};

/// A branch moved by G: points, tangents, special points with their vectors. Stability and arclength are the same.
[[nodiscard]] Branch image(const SignedPermutation& g, const Branch& branch);

/// All but the identity. Empty for problems that are no flow, have not one parameter, or are too large.
[[nodiscard]] std::vector<SignedPermutation> symmetries(const Problem& f, const SymmetryOptions& options);

}  // namespace whirl::continuation
