#include "studies/chart_output.hpp"

#include <fmt/format.h>

#include <cmath>

namespace whirl::studies {
namespace {

using continuation::to_string;

constexpr const char* point_types =
    "CP cusp, BT Bogdanov-Takens, ZH zero-Hopf, GH generalised Hopf, HH double Hopf, DP degenerate pitchfork, FT contact of folds and transcritical "
    "points, FP fold and pitchfork, PP two pitchforks, R1 to R4 strong resonances, UZ value asked for, MIN and MAX of the second parameter";

}  // namespace

std::string curve_name(const continuation::DefiningCurve& curve, std::size_t number) {
  return fmt::format("{}{}", curve.subtype.empty() ? to_string(curve.type) : curve.subtype.c_str(), number);
}

Vector ChartCurve::point(const Vector& u) const {
  if (std::isnan(held)) return u;
  Vector wide(u.size() + 1);
  wide << u, held;
  return wide;
}

void ChartOutput::write_curve(ResultFile& file, const ChartCurve& of) const {
  const auto& curve = of.curve;
  const auto n = curve.u.rows() - 2;
  const auto column = [&](const std::string& name, const std::string& unit, const std::string& description, auto value) {
    Column c{name, unit, description, {}};
    for (Eigen::Index i = 0; i < curve.u.cols(); ++i) c.values.push_back(value(i));
    return c;
  };
  std::vector<Column> table = {column(first, first_unit, "first parameter", [&](auto i) { return curve.u(n, i); }),
                               column(second, second_unit, "second parameter", [&](auto i) { return curve.u(n + 1, i); })};
  if (!held.empty()) table.push_back(column(held, held_unit, "held along the curve", [&](auto) { return of.held; }));
  for (const auto& c : of.columns) table.push_back(column(c.name, c.unit, c.description, [&](auto i) { return c.value(of.point(curve.u.col(i))); }));
  table.push_back(column("coefficient", "-", "normal-form coefficient", [&](auto i) { return curve.coefficient[i]; }));
  table.push_back(column("frequency", "rad/s", "Hopf and torus curves: of the motion that is born", [&](auto i) { return curve.frequency[i]; }));
  table.push_back(column("residual", "-", "largest residual of the defining system", [&](auto i) { return curve.residual[i]; }));
  const std::string group = "/curves/" + curve.name;
  file.table(group, table);
  file.attribute(group, "type", std::string(to_string(curve.type)));
  file.attribute(group, "subtype", curve.subtype);
  file.attribute(group, "born_at", curve.born_at);
  file.attribute(group, "start_reason", std::string(to_string(curve.start_reason)));
  file.attribute(group, "stop_reason", std::string(to_string(curve.stop_reason)));
}

void ChartOutput::write_points(ResultFile& file, const std::string& path, const std::vector<ChartCurve>& curves) const {
  std::vector<Column> table{
      {first, first_unit, "first parameter", {}}, {second, second_unit, "second parameter", {}}, {"residual", "-", "of the defining system", {}}};
  TextColumn names{"curve", "curve the point lies on", {}}, types{"type", point_types, {}}, subtypes{"subtype", "FT: of the curve met there", {}};
  if (!held.empty()) table.push_back({held, held_unit, "held along the curve", {}});
  const std::size_t state = table.size();
  if (!curves.empty())
    for (const auto& c : curves.front().columns) table.push_back({c.name, c.unit, c.description, {}});
  for (const auto& of : curves)
    for (const auto& z : of.curve.special) {
      const auto n = z.u.size() - 2;
      std::vector<double> row = {z.u[n], z.u[n + 1], z.residual};
      if (!held.empty()) row.push_back(of.held);
      for (const auto& c : of.columns) row.push_back(c.value(of.point(z.u)));
      for (std::size_t i = 0; i < table.size(); ++i) table[i].values.push_back(i < row.size() || i < state ? row[i] : std::nan(""));
      names.values.push_back(of.curve.name);
      types.values.push_back(z.type);
      subtypes.values.push_back(z.subtype);
    }
  file.table(path, table, {names, types, subtypes});
}

Json ChartOutput::points_json(const std::vector<ChartCurve>& curves) const {
  Json points = Json::array();
  for (const auto& of : curves)
    for (const auto& z : of.curve.special) {
      const auto n = z.u.size() - 2;
      Json o = Json::object();
      o.put("curve", of.curve.name).put("type", z.type);
      if (!z.subtype.empty()) o.put("subtype", z.subtype);
      o.put(first, z.u[n]).put(second, z.u[n + 1]);
      if (!held.empty()) o.put(held, of.held);
      for (const auto& c : of.columns)
        if (const double x = c.value(of.point(z.u)); std::isfinite(x)) o.put(c.name, x);
      points.add(std::move(o.put("residual", z.residual)));
    }
  return points;
}

Json ChartOutput::curves_json(const std::vector<ChartCurve>& curves) {
  Json summary = Json::array();
  for (const auto& of : curves) {
    const auto& c = of.curve;
    Json o = Json::object();
    o.put("name", c.name).put("type", to_string(c.type)).put("subtype", c.subtype).put("born_at", c.born_at).put("points", c.u.cols());
    summary.add(std::move(o.put("start_reason", to_string(c.start_reason)).put("stop_reason", to_string(c.stop_reason))));
  }
  return summary;
}

std::string ChartOutput::text(const std::vector<ChartCurve>& curves) const {
  std::string out = fmt::format("{:<8} {:<6} {:>22} {:>26} {:>9}\n", "curve", "point", fmt::format("{} [{}]", first, first_unit),
                                fmt::format("{} [{}]", second, second_unit), "residual");
  for (const auto& of : curves)
    for (const auto& z : of.curve.special)
      out += fmt::format("{:<8} {:<6} {:>22.11f} {:>26.11f} {:>9.1e}\n", of.curve.name, z.type, z.u[z.u.size() - 2], z.u[z.u.size() - 1], z.residual);
  for (const auto& of : curves)
    out += fmt::format("curve {:<8} {:>5} points, born at {}, ends: {}, {}\n", of.curve.name, of.curve.u.cols(), of.curve.born_at,
                       to_string(of.curve.start_reason), to_string(of.curve.stop_reason));
  return out;
}

}  // namespace whirl::studies
