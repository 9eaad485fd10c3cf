#pragma once
/// The series method of [Gale1976, sec. II.4] as a named method beside the spectral solver, with his recursions corrected.
///
/// In z = |xi| the tangential displacement has four Frobenius series about z = 0 (exponents 0, 1/2, 1, 3/2; radius 1) and four Taylor series about
/// z = 2 (radius 2); out of plane there are two (0, 1/2; radius 2) and two. U and V = sgn(xi) S q U_z, S = sqrt(z(z+2)), q = 1 + z, vanish at both
/// ends:
///
///     [ U(xi_1)  V(xi_1)  U(xi_2)  V(xi_2) ]' C = 0,     C the four constants; ends beyond the matching point go through the series about 2
///
/// Undamped, inextensible cables with both ends at |xi| < 4 only: others are refused. Where the source takes 80 terms and one matching point,
///   * every series is summed until its terms are below rounding; the cost of that is cancellation, reported as digits lost,
///   * the determinant is scaled by rows and columns, so that its sign is all that varies,
///   * each root is bracketed between neighbouring midpoints of the spectral solver's frequencies, where the sign must change exactly once: a root
///   too
///     many or too few is reported and not repaired.
///
/// Modes whose sums lose more than nine digits are refused, so that what is listed agrees with the spectral solver to 1e-6 or better.
///
///     SeriesModes s = series_modes(g.x1, g.x2, 8, Plane::in_plane);
///     s.omega, s.digits_lost, s.agrees()
///
/// Throws std::invalid_argument outside its region.

#include <vector>

#include "core/problem.hpp"

namespace whirl::models::catenary {

enum class Plane { in_plane, out_of_plane };

struct SeriesOptions {
  double match_in_plane = 0.57, match_out_of_plane = 1.0;  ///< |xi| where the two expansions meet
  int max_terms = 4000;
  double max_digits_lost = 9.0;  ///< modes whose sums cancel more are refused
};

struct SeriesModes {
  std::vector<double> omega;        ///< sqrt(g/a), increasing; those whose bracket held exactly one sign change
  std::vector<double> spectral;     ///< the spectral solver's frequencies, all wanted
  std::vector<double> digits_lost;  ///< decimal digits cancelled in the sums, one an entry of `omega`
  int terms = 0;                    ///< of the longest series
  int missing = 0, spurious = 0;    ///< brackets without a sign change, sign changes too many
  int refused = 0;                  ///< modes beyond `max_digits_lost`, always the highest
  double worst_difference() const;  ///< relative, from the spectral solver
  bool agrees() const { return missing == 0 && spurious == 0; }
};

SeriesModes series_modes(double x1, double x2, int count, Plane plane, const SeriesOptions& options = {});

/// The scaled determinant at one frequency, and what its series cost.
struct SeriesDeterminant {
  double value, digits_lost;
  int terms;
};
SeriesDeterminant series_determinant(double x1, double x2, double omega, Plane plane, const SeriesOptions& options = {});

}  // namespace whirl::models::catenary
