#pragma once
/// What a limit cycle and an equilibrium have in common for tables: extremes of every quantity, the period, the trivial multiplier's error; and what
/// a family tends to where its period grows.

#include <optional>

#include "studies/cycle_branches.hpp"
#include "studies/equilibrium_source.hpp"

namespace whirl::studies {

/// Reads cycles of any level of a flow, whatever family they belong to. Keeps the last one it was asked about.
class CycleReader {
 public:
  /// `flow` and `columns` are kept by reference and by value.
  CycleReader(const Problem& flow, std::vector<PointColumn> columns, const models::LimitCycleOptions& options);

  /// "x_max", "x_min", ... for every quantity of the flow, "cycle_period", "trivial_error"; of equilibria both extremes are the value.
  std::vector<PointColumn> extremes(const std::string& unit_of_time);
  double period(In u);  ///< 0 for an equilibrium
  int multiple(In u);   ///< periods of the single cycle: 1, 2, 4 ...; 0 for an equilibrium
  /// t and the flow's variables at `count` equal instants of the period and its end.
  std::vector<Column> orbit(In u, int count, const std::string& unit_of_time);

 private:
  const models::LimitCycle* cycle_of(In u);
  void look_at(In u);

  const Problem& flow_;
  std::vector<PointColumn> columns_;
  std::vector<std::unique_ptr<models::LimitCycle>> levels_;  // the first owns what it doubles to
  const models::LimitCycle* single_;
  Vector last_;
  Matrix extremes_;  // largest and least of each column
  double error_ = 0.0;
};

/// The equilibrium a cycle of long period comes near, if any: one line for the user, and numbers for the file.
struct NearEquilibrium {
  Vector x;
  Eigen::VectorXcd eigenvalues;
  double saddle_quantity = 0.0;  ///< leading unstable plus leading stable real part; > 0 with a complex leading pair: Shilnikov
  double slowness = 1.0;         ///< least speed along the cycle over the largest
};
std::optional<NearEquilibrium> equilibrium_approached(const Problem& flow, const models::LimitCycle& cycle, In u);
std::string describe(const NearEquilibrium& near);

}  // namespace whirl::studies
