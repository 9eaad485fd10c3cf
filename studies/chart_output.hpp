#pragma once
/// Curves of special points in two parameters as tables of the result file, as JSON, and as text: one list of columns for all three.

#include "continuation/two_parameter.hpp"
#include "studies/branch_output.hpp"
#include "studies/json.hpp"

namespace whirl::studies {

/// A curve of a chart, and the value at which a third parameter is held along it (NaN: there is none).
struct ChartCurve {
  continuation::DefiningCurve curve;
  double held = std::numeric_limits<double>::quiet_NaN();
  std::vector<PointColumn> columns = {};  ///< of a point (x, p1, p2), followed by the value held if there is one
  Vector point(const Vector& u) const;    ///< that, of (x, p1, p2)
};

/// "LP3": by type, or subtype, and its number in the chart.
std::string curve_name(const continuation::DefiningCurve& curve, std::size_t number);

struct ChartOutput {
  std::string first, first_unit, second, second_unit;
  std::string held = {}, held_unit = {};  ///< name of the third parameter, or ""

  /// /curves/<name>: both parameters, the state, normal-form coefficient, frequency, residual.
  void write_curve(ResultFile& file, const ChartCurve& curve) const;
  /// One row for each codimension-2 point of all curves.
  void write_points(ResultFile& file, const std::string& table, const std::vector<ChartCurve>& curves) const;
  /// The points, and the curves, as JSON lists.
  Json points_json(const std::vector<ChartCurve>& curves) const;
  static Json curves_json(const std::vector<ChartCurve>& curves);
  /// The table printed at the end of a run.
  std::string text(const std::vector<ChartCurve>& curves) const;
};

}  // namespace whirl::studies
