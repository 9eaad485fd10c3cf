#pragma once
/// Branches of exact periodic motion of a forced modal system: harmonic balance with as many harmonics as the truncation asks for, walked from the
/// linear response, from averaged and from integrated motions, through branch points and period doublings. In the end starts are integrated, and
/// where they settle on a motion that no branch holds, that motion starts another branch.
///
///     OrbitBranches orbits(system, options, context);
///     orbits.on_branch([&](const Branch& b, int level) { ... });
///     orbits.find();
///     orbits.network(level).branches();          // motions over nu 2^level excitation periods
///
/// A branch whose truncation error comes out above the tolerance is not handed on: everything starts again with the harmonics that its worst motion
/// needs. Throws std::invalid_argument for options out of range.

#include "continuation/orbit_network.hpp"
#include "studies/attractor_check.hpp"
#include "studies/orbit_seeds.hpp"

namespace whirl::studies {

struct OrbitBranchOptions {
  continuation::NetworkOptions network;
  int nu = 1;                          ///< base period in excitation periods
  int harmonics = 0;                   ///< of omega/nu; 0: as many as the tolerance needs
  double truncation_tolerance = 1e-9;  ///< on the motion, relative; see models::Truncation
  int max_harmonics = 120;
  int period_doublings = 1;         ///< how often a branch of doubled period is followed
  int seed_grid = 9;                ///< parameter values at which the linear response is tried
  bool averaged_seeds = true;       ///< and all averaged motions, with deflation (OrbitSeeds)
  std::vector<Vector> seeds;        ///< further starts: values of q at rest, integrated at every `seed_values`
  std::vector<double> seed_values;  ///< parameter values
  models::SettleOptions settle;
  AttractorCheckOptions check;  ///< integration from starts, in the end
};

class OrbitBranches {
 public:
  using OnBranch = std::function<void(const continuation::Branch&, int level, double truncation)>;

  OrbitBranches(ForcedSystem source, OrbitBranchOptions options, RunContext& context);

  void on_branch(OnBranch f) { on_branch_ = std::move(f); }
  void find();

  const ForcedSystem& source() const { return source_; }
  const models::HarmonicBalance& balance(int level) const;
  const models::HarmonicBalance& balance_of(In u) const;  ///< the one whose unknown u is, by its size
  const continuation::Network& network(int level) const { return net_->network(level); }
  int levels() const { return options_.period_doublings + 1; }
  int period(int level) const { return options_.nu << level; }  ///< in excitation periods
  std::vector<continuation::Branch> all() const;
  /// Periodic motions at parameter value p: branch, level, unknowns, stable.
  struct Motion {
    std::string branch;
    int level;
    Vector u;
    bool stable;
  };
  std::vector<Motion> motions_at(double p) const;
  const AttractorCheck& check() const { return check_; }

 private:
  bool pass();  // false: more harmonics are needed
  void judge(const continuation::Branch& b, int level);
  void seed_linear();
  void seed_averaged();
  void seed_integrated();
  void seed_attractors();
  std::string branch_of(const models::SteadyMotion& motion, double p, int& level, Vector& u) const;
  double walked_periods() const;
  Vector largest_motion() const;
  struct Settled {
    double p;
    models::SteadyMotion motion;
  };

  ForcedSystem source_;
  OrbitBranchOptions options_;
  RunContext& context_;
  int harmonics_;
  int needed_ = 0;  // harmonics that a branch of this pass asks for; 0: none
  std::vector<Settled> settled_;
  bool has_settled_ = false;
  std::unique_ptr<models::HarmonicBalance> balance_;
  std::unique_ptr<continuation::OrbitNetwork> net_;
  OnBranch on_branch_;
  std::unique_ptr<OrbitSeeds> averaged_;  // made in the first pass
  AttractorCheck check_;
};

}  // namespace whirl::studies
