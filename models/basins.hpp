#pragma once
/// Basins of attraction in a plane of initial conditions: which attractor each start of a grid goes to, on all cores.
///
/// The plane: two of the 2 n states (q, q') run over ranges, the others keep `base`. A start in a symmetric subspace (such as q1 = q1' = 0) would
/// never leave it and gets `perturbation` in the coordinates the reflection turns. Where a reflection of the system maps the grid to itself half of
/// it is integrated.
///
/// A cell is decided when its motion enters the tested neighbourhood of a known attractor (models/attractors.hpp), or settles by itself. Cells are
/// worked in fixed groups, attractors found in one group are known from the next one on and entered in the order of cells, and the numbers in the end
/// follow from the attractors themselves: the result does not depend on the number of threads.
///
/// What it is worth is counted: a share of the cells is integrated again at the fine tolerance until it is within 1e-6 of its attractor
/// (`checked`, `disagreed`).
///
///     BasinMap map = basins(system, reflections, {.x = {0, -10, 10, 200}, .y = {1, -10, 10, 200}, .base = Vector::Zero(4)});
///     map.cell(j, i)      // of x_i, y_j: index into map.attractors, or one of unsettled, diverging, not_computed
///
/// Throws std::invalid_argument for axes, sizes and options out of range.

#include <functional>

#include "models/attractors.hpp"

namespace whirl::models {

struct BasinAxis {
  int state = 0;  ///< index into (q, q')
  double lower = -1.0, upper = 1.0;
  int points = 100;
  double at(int i) const { return points == 1 ? lower : lower + (upper - lower) * i / (points - 1); }
};

struct BasinOptions {
  BasinAxis x, y;
  Vector base;                 ///< (q, q'); the entries of the axes are not used
  double phase = 0.0;          ///< of the excitation at the start [rad]
  double perturbation = 1e-6;  ///< in the unit of q
  double check_share = 0.01;   ///< of the integrated cells
  bool use_symmetry = true;
  unsigned threads = 0;  ///< 0: all
  AttractorOptions settle;
  std::function<void(long done, long total, int attractors)> progress = {};  ///< called from all threads
  void validate(int states) const;
};

struct BasinMap {
  static constexpr int unsettled = -1, diverging = -2, not_computed = -3;
  Eigen::MatrixXi cell;               ///< y.points x x.points
  Eigen::MatrixXi periods;            ///< excitation periods until decided; of a mirrored cell those of its image
  std::vector<Attractor> attractors;  ///< by kind, multiple, extent of the motion; of two mirror images one follows the other
  std::vector<long> cells;            ///< of each attractor
  long integrated = 0;                ///< cells that were not mirrored
  long checked = 0, disagreed = 0;
  std::string symmetry;  ///< reflection used
  bool complete = false;

  double share(int attractor) const;  ///< of the computed cells
};

BasinMap basins(const ModalSystem<double>& system, const std::vector<Reflection>& reflections, const BasinOptions& options);

}  // namespace whirl::models
