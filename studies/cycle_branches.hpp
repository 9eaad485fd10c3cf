#pragma once
/// The limit cycles that are born at Hopf points, followed with their folds, branch points, period doublings and torus points, and the doubled
/// families, over the one parameter of a flow.
///
///     CycleBranches cycles(flow, {.network = network});
///     for (const Branch& b : equilibria)
///       for (const SpecialPoint& s : b.special)
///         if (s.type == EventType::hopf) cycles.add_hopf(s, b.name + ":HB1");
///     cycles.add_motion(x0, p, 500.0);                       // the stable cycle that x0 settles on
///     for (const auto& f : cycles.families()) ...            // f->net holds the branches, f->problem(level) reads them
///
/// A family starts beside its Hopf point at a first harmonic that moves the parameter by about `start_shift` of its range (the parameter goes with
/// the square of the amplitude), and ends where it shrinks to an equilibrium again, at the parameter's bounds, or where its period passes
/// `longest_period`. A Hopf point at which a family known already ends starts none.

#include <functional>
#include <memory>

#include "continuation/orbit_network.hpp"
#include "models/dynamics/periodic/limit_cycle.hpp"

namespace whirl::studies {

struct CycleOptions {
  continuation::NetworkOptions network;
  models::LimitCycleOptions cycle;
  int period_doublings = 2;     ///< levels of doubled families that are followed
  double longest_period = 0.0;  ///< of the single cycle; 0: `longest_multiple` periods of the Hopf point
  double longest_multiple = 8.0;
  double start_shift = 1e-4;  ///< of the parameter from the Hopf point to the first cycle, in parts of its range
};

/// Where a branch of cycles ends.
enum class CycleEnd { other, equilibrium, long_period };

struct CycleFamily {
  std::string origin;  ///< "B1:HB1"
  Vector hopf;         ///< (x, p)
  std::unique_ptr<models::LimitCycle> single;
  std::unique_ptr<continuation::OrbitNetwork> net;    ///< level 0: the cycles, 1: doubled, ...
  double least_harmonic = 0.0, longest_period = 0.0;  ///< at which branches end
  const models::LimitCycle& problem(int level) const { return static_cast<const models::LimitCycle&>(net->problem(level)); }
  /// What the first or the last point of a branch of this family is.
  CycleEnd end(In u, int level) const;
};

class CycleBranches {
 public:
  using OnBranch = std::function<void(const continuation::Branch&, const CycleFamily&, int level)>;

  /// `flow` is kept by reference and has one parameter.
  CycleBranches(const Problem& flow, CycleOptions options);

  void on_branch(OnBranch f) { on_branch_ = std::move(f); }
  void set_observer(continuation::Observer observer) { observer_ = std::move(observer); }
  /// Follows the family of this Hopf point; empty if it is one, a reason if there is none.
  std::string add_hopf(const continuation::SpecialPoint& hopf, const std::string& origin);
  static constexpr const char* not_periodic = "no periodic motion was met";
  /// Integrates from x0 at parameter value p over `transient`, and follows the family of the stable cycle met; empty, or a reason if there is none.
  std::string add_motion(const Vector& x0, double p, double transient, const std::string& origin);
  const std::vector<std::unique_ptr<CycleFamily>>& families() const { return families_; }

 private:
  bool ends_at(const continuation::SpecialPoint& hopf) const;
  Vector start(const models::LimitCycle& cycle, const continuation::SpecialPoint& hopf) const;
  std::string follow(std::unique_ptr<CycleFamily> family, const Vector& u0);  // "", or why there is no branch
  bool knows(double period, double p) const;

  const Problem& flow_;
  CycleOptions options_;
  OnBranch on_branch_;
  continuation::Observer observer_;
  std::vector<std::unique_ptr<CycleFamily>> families_;
};

}  // namespace whirl::studies
