#pragma once
/// One forced system at three levels of theory: averaged on the superharmonic ansatz with the linear response frozen (the paper's), averaged on the
/// complete ansatz, exact. Their special points side by side, and where in two parameters the first can be trusted.
///
///     Levels levels = walk_levels(source, options, context);
///     for (const Match& m : match_points(levels)) ...

#include "models/slow_flow/slow_flow.hpp"
#include "studies/orbit_branches.hpp"

namespace whirl::studies {

struct CompareOptions {
  int order = 2;               ///< n: amplitudes of the harmonic n omega are compared
  int complete_harmonics = 8;  ///< of the complete ansatz
  OrbitBranchOptions orbits;
};

/// An amplitude vector: of harmonic n omega in every coordinate.
using Amplitudes = Vector;

struct AveragedLevel {
  std::string name;  ///< "frozen", "complete"
  std::unique_ptr<models::SlowFlow> flow;
  std::unique_ptr<continuation::Network> net;
  Amplitudes amplitudes(In u, int order) const;
};

struct Levels {
  CompareOptions options;
  AveragedLevel frozen, complete;
  std::unique_ptr<OrbitBranches> exact;
  Amplitudes exact_amplitudes(In u) const;
};

/// Further starts of the frozen flow at a parameter value, where closed forms give them.
using ClosedForms = std::function<std::vector<Vector>(double p)>;

/// `with_complete` false leaves the complete ansatz out (the map needs only the other two).
Levels walk_levels(const ForcedSystem& source, const CompareOptions& options, const ClosedForms& closed_forms, RunContext& context,
                   bool with_complete = true);

/// A special point of some level.
struct LevelPoint {
  std::string level, branch, label, kind;  ///< kind: LP, WH, BP, PD, HB/TR
  double p = 0.0;
  Amplitudes amplitudes;
};
std::vector<LevelPoint> points_of(const Levels& levels, const std::string& level);

/// The same special point at up to three levels; an empty optional: not there.
struct Match {
  std::string kind;
  std::optional<LevelPoint> frozen, complete, exact;
  std::string words() const;  ///< "all", "only exact", "not frozen", ...
};
/// Points of one kind paired where they are each other's nearest, in units of the parameter range and of the largest amplitude, up to `reach`.
std::vector<Match> match_points(const Levels& levels, double reach = 0.2);

/// Error of the frozen level at p: over the exact stable motions the largest distance to the nearest stable averaged one, relative to the exact
/// amplitude.
struct CellError {
  double error = 0.0;       ///< NaN: no exact stable motion was found there
  double amplitude = 0.0;   ///< exact, of the motion with the largest error
  bool same_kinds = false;  ///< as many stable motions at rest out of plane, and moving, at both levels
};
CellError error_at(const Levels& levels, double p);

}  // namespace whirl::studies
