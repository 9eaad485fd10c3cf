#pragma once
/// What a person reads of a periodic motion: amplitudes per coordinate and harmonic, peak displacement; motions over time; and how well an
/// integration agrees.

#include "studies/branch_output.hpp"
#include "studies/extremes.hpp"
#include "studies/orbit_branches.hpp"

namespace whirl::studies {

/// Columns q<i>_h<k> (k in multiples of the excitation frequency, up to `harmonics`), their phases, q<i>_max (of |q|), q<i>_crest and q<i>_trough
/// (with sign), and derived frequencies. `orbits` must live on.
BranchOutput orbit_output(const OrbitBranches& orbits, const std::string& parameter, int harmonics);

/// Largest and least q_i over the period.
Extremes extremes(const models::HarmonicBalance& hb, In u, int coordinate);

/// Largest |q_i| over the period.
double peak(const models::HarmonicBalance& hb, In u, int coordinate);

/// One period of the motion as t, q..., q'... into `group`.
void write_orbit(ResultFile& file, const std::string& group, const OrbitBranches& orbits, const OrbitBranches::Motion& motion);

/// The motion carried over its period by CVODE: how far its end misses its start, and its multipliers those of the integration.
struct OrbitCheck {
  double p;
  OrbitBranches::Motion motion;
  double defect;      ///< |end - start| over |start|
  double multiplier;  ///< largest distance of a multiplier from the nearest integrated one
  bool ok;
  int least_unstable = 0, most_unstable = 0;  ///< integrated multipliers outside the unit circle: surely, and at most
};
std::vector<OrbitCheck> check_orbits(const OrbitBranches& orbits, const std::vector<double>& values, RunContext& context);
/// What the checks say against the branches, a line each: more or fewer unstable directions than told, a stable motion that is none. `tolerance` of
/// the defect.
std::vector<std::string> contradictions(const std::vector<OrbitCheck>& checks, const std::string& parameter, double tolerance);
void write_checks(ResultFile& file, const OrbitBranches& orbits, const std::vector<OrbitCheck>& checks);
std::string checks_text(const OrbitBranches& orbits, const std::vector<OrbitCheck>& checks, const std::string& parameter);

}  // namespace whirl::studies
