#pragma once
/// Branches and special points as tables of the result file, as JSON, and as text: one list of columns for all three.

#include <functional>

#include "continuation/network.hpp"
#include "studies/json.hpp"
#include "studies/result_file.hpp"

namespace whirl::studies {

/// A quantity of a point u = (x, p) of a branch.
struct PointColumn {
  std::string name, unit, description;
  std::function<double(In u)> value;
  bool shown = false;  ///< in the printed table; amplitudes q.. in m always are
};

/// Hopf and torus points have a `critical_frequency`: Im of the critical eigenvalue, or that of the second motion beside the excitation [rad/s].
/// `frequency` is the excitation's in Hz where the kind has a column of that name; where it has none, the critical frequency once more.
struct BranchOutput {
  std::string parameter, parameter_unit;
  std::vector<PointColumn> columns;            ///< amplitudes, phases, derived numbers
  double period = 0.0;                         ///< in excitation periods; 0 for equilibria
  std::function<double(In u)> period_of = {};  ///< in place of `period`, where branches differ
  bool multipliers = false;                    ///< the spectrum of a branch is Floquet multipliers

  /// /branches/<name>: the columns, then n_unstable, eigenvalues, arclength, residual, step, newton_iterations.
  void write_branch(ResultFile& file, const continuation::Branch& branch) const;
  /// /special_points: one row each, all branches.
  void write_special_points(ResultFile& file, const std::vector<continuation::Branch>& branches) const;
  /// "special_points": [...], "branches": [...]
  void report(Json& results, const std::vector<continuation::Branch>& branches) const;
  /// The table printed at the end of a run.
  std::string text(const std::vector<continuation::Branch>& branches) const;
  double period_at(In u) const { return period_of ? period_of(u) : period; }

 private:
  Json json_of(const continuation::Branch& branch, std::size_t special) const;
  bool has_column(const std::string& name) const;
};

/// "q1_h2", "z3_h0.5": harmonic k, in multiples of the excitation frequency, of a coordinate.
std::string harmonic_name(const std::string& coordinate, double k);

/// Is it a column that every table of branches, special points or curves has? No quantity of a model may be named so.
bool is_own_column(const std::string& name);

/// "LP", "BP", ...: with its running number on the branch, "LP2".
std::string label(const continuation::Branch& branch, std::size_t special);

}  // namespace whirl::studies
