#include "studies/branch_output.hpp"

#include "continuation/normal_form.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>
#include <span>

#include "studies/open_results.hpp"
#include "studies/shown_columns.hpp"

namespace whirl::studies {
namespace {

using continuation::Branch;
using continuation::criticality;
using continuation::EventType;
using continuation::SpecialPoint;

bool has_critical_frequency(const SpecialPoint& s) { return s.type == EventType::hopf || s.type == EventType::torus; }

std::string ends(const Branch& b) { return fmt::format("{}, {}", to_string(b.start_reason), to_string(b.stop_reason)); }

}  // namespace

bool is_own_column(const std::string& name) {
  static const std::set<std::string> own = {"branch",
                                            "label",
                                            "type",
                                            "subtype",
                                            "criticality",
                                            "point",
                                            "period",
                                            "unstable_before",
                                            "unstable_after",
                                            "n_unstable",
                                            "frequency",
                                            "coefficient",
                                            "arclength",
                                            "residual",
                                            "bracket_lower",
                                            "bracket_upper",
                                            "bracket",
                                            "step",
                                            "newton_iterations",
                                            "stable_before",
                                            "stable_after",
                                            "curve",
                                            "stable",
                                            "critical_frequency"};
  static const std::regex eigenvalue("(eig|mu)[0-9]+_(re|im)");
  return own.contains(name) || std::regex_match(name, eigenvalue);
}

std::string harmonic_name(const std::string& coordinate, double k) { return fmt::format("{}_h{:g}", coordinate, k); }

std::string label(const Branch& branch, std::size_t special) {
  int number = 0;
  for (std::size_t i = 0; i <= special; ++i) number += branch.special[i].type == branch.special[special].type ? 1 : 0;
  return fmt::format("{}{}", to_string(branch.special[special].type), number);
}

namespace {
enum class Rows { add, replace };
void put_special_points(ResultFile& file, const BranchOutput& out, std::span<const Branch> branches, Rows rows);
}  // namespace

void BranchOutput::write_branch(ResultFile& file, const Branch& b) const {
  const std::string group = "/branches/" + b.name;
  const int n = b.points();
  std::vector<Column> table;
  const auto add = [&](const std::string& name, const std::string& unit, const std::string& description, auto value) {
    Column c{name, unit, description, std::vector<double>(static_cast<std::size_t>(n))};
    for (int i = 0; i < n; ++i) c.values[static_cast<std::size_t>(i)] = static_cast<double>(value(i));
    table.push_back(std::move(c));
  };
  add(parameter, parameter_unit, "continuation parameter", [&](int i) { return b.parameter(i); });
  for (const auto& column : columns) add(column.name, column.unit, column.description, [](int) { return 0.0; });
  for (int i = 0; i < n; ++i)  // point by point: columns share what they compute of a point
    for (std::size_t k = 0; k < columns.size(); ++k) table[k + 1].values[static_cast<std::size_t>(i)] = columns[k].value(b.u(i));
  add("n_unstable", "-", "number of unstable directions; 0 is stable", [&](int i) { return b.n_unstable(i); });
  if (b.has_spectrum())
    for (int k = 0; k < b.spectrum_size(); ++k) {
      const std::string name = fmt::format("{}{}", multipliers ? "mu" : "eig", k + 1), unit = multipliers ? "-" : "1/s",
                        what = multipliers ? "Floquet multiplier over the motion's period" : "eigenvalue of the Jacobian";
      add(name + "_re", unit, what + ", real part", [&](int i) { return b.eigenvalues(i)[k].real(); });
      add(name + "_im", unit, what + ", imaginary part", [&](int i) { return b.eigenvalues(i)[k].imag(); });
    }
  add("arclength", "-", "along the branch, in the walker's metric", [&](int i) { return b.arclength(i); });
  add("residual", "-", "largest residual", [&](int i) { return b.residual(i); });
  add("step", "-", "arclength step that led here", [&](int i) { return b.step(i); });
  add("newton_iterations", "-", "corrections", [&](int i) { return b.iterations(i); });
  file.table(group, table);
  file.attribute(group, "born_at", b.born_at);
  file.attribute(group, "start_reason", std::string(to_string(b.start_reason)));
  file.attribute(group, "stop_reason", std::string(to_string(b.stop_reason)));
  file.attribute(group, "isola", b.isola ? 1.0 : 0.0);
  file.attribute(group, "mirror_image_exists", b.mirror_image ? 1.0 : 0.0);
  put_special_points(file, *this, {&b, 1}, Rows::add);
}

void BranchOutput::write_special_points(ResultFile& file, const std::vector<Branch>& branches) const {
  put_special_points(file, *this, branches, Rows::replace);
}

namespace {

void put_special_points(ResultFile& file, const BranchOutput& out, std::span<const Branch> branches, Rows rows) {
  const auto &parameter = out.parameter, &parameter_unit = out.parameter_unit;
  const auto& columns = out.columns;
  const auto period_at = [&out](In u) { return out.period_at(u); };
  std::vector<const Branch*> branch_of;
  std::vector<const SpecialPoint*> points;
  TextColumn names{"branch", "branch the point lies on", {}}, labels{"label", "type and running number on the branch", {}},
      types{"type", "LP fold, BP branch point, HB Hopf, UZ user value, RP peak, PD period doubling, TR torus, unresolved", {}},
      subtypes{"subtype", "WH whirling starts, PF pitchfork, TC transcritical, ZH a Hopf point with a zero eigenvalue, or the peak's quantity", {}},
      criticalities{"criticality", "supercritical or subcritical, of pitchforks and Hopf points", {}};
  for (const auto& b : branches)
    for (std::size_t i = 0; i < b.special.size(); ++i) {
      const auto& s = b.special[i];
      points.push_back(&s);
      names.values.push_back(b.name);
      labels.values.push_back(label(b, i));
      types.values.emplace_back(to_string(s.type));
      subtypes.values.push_back(s.subtype);
      criticalities.values.push_back(criticality(s));
    }
  std::vector<Column> table;
  const auto add = [&](const std::string& name, const std::string& unit, const std::string& description, auto value) {
    Column c{name, unit, description, {}};
    for (const auto* s : points) c.values.push_back(static_cast<double>(value(*s)));
    table.push_back(std::move(c));
  };
  add(parameter, parameter_unit, "continuation parameter", [](const SpecialPoint& s) { return s.u[s.u.size() - 1]; });
  for (const auto& column : columns) add(column.name, column.unit, column.description, [&](const SpecialPoint& s) { return column.value(s.u); });
  add("period", "-", "of the motion in excitation periods, 0 for equilibria", [&](const SpecialPoint& s) { return period_at(s.u); });
  add("unstable_before", "-", "unstable directions before, along the branch", [](const SpecialPoint& s) { return s.unstable_before; });
  add("unstable_after", "-", "unstable directions after", [](const SpecialPoint& s) { return s.unstable_after; });
  const char* critical = "Hopf, torus: of the motion that is born, in the slow time or beside the excitation";
  const bool in_hertz = std::any_of(columns.begin(), columns.end(), [](const PointColumn& c) { return c.name == "frequency"; });
  if (!in_hertz) add("frequency", "rad/s", critical, [](const SpecialPoint& s) { return s.frequency; });
  add("critical_frequency", "rad/s", critical, [](const SpecialPoint& s) { return s.frequency; });
  add("coefficient", "-", "normal-form coefficient; NaN if not computed",
      [](const SpecialPoint& s) { return s.has_coefficient ? s.coefficient : std::nan(""); });
  add("arclength", "-", "along the branch", [](const SpecialPoint& s) { return s.arclength; });
  add("residual", "-", "of the system that defines the point", [](const SpecialPoint& s) { return s.residual; });
  add("bracket_lower", parameter_unit, "the test function changes between bracket_lower and bracket_upper",
      [](const SpecialPoint& s) { return s.bracket[0]; });
  add("bracket_upper", parameter_unit, "see bracket_lower", [](const SpecialPoint& s) { return s.bracket[1]; });
  const std::vector<TextColumn> texts{names, labels, types, subtypes, criticalities};
  if (rows == Rows::add) extend_table(file, "/special_points", table, texts);
  else file.table("/special_points", table, texts);
}

}  // namespace

bool BranchOutput::has_column(const std::string& name) const {
  return std::any_of(columns.begin(), columns.end(), [&](const PointColumn& c) { return c.name == name; });
}

Json BranchOutput::json_of(const Branch& b, std::size_t special) const {
  const SpecialPoint& s = b.special[special];
  Json o = Json::object();
  o.put("branch", b.name).put("label", label(b, special)).put("type", to_string(s.type)).put("subtype", s.subtype);
  o.put(parameter, s.u[s.u.size() - 1]).put("period", period_at(s.u));
  o.put("stable_before", s.stable_before()).put("stable_after", s.stable_after());
  o.put("unstable_before", s.unstable_before).put("unstable_after", s.unstable_after);
  for (const auto& column : columns) o.put(column.name, column.value(s.u));
  if (has_critical_frequency(s)) {
    if (!has_column("frequency")) o.put("frequency", s.frequency);
    o.put("critical_frequency", s.frequency);
  }
  if (s.has_coefficient) o.put("coefficient", s.coefficient);
  if (const std::string how = criticality(s); !how.empty()) o.put("criticality", how);
  return std::move(o.put("residual", s.residual).put("bracket", Json::array(std::vector<double>{s.bracket[0], s.bracket[1]})));
}

void BranchOutput::report(Json& results, const std::vector<Branch>& branches) const {
  Json points = Json::array(), summary = Json::array();
  for (const auto& b : branches) {
    for (std::size_t i = 0; i < b.special.size(); ++i) points.add(json_of(b, i));
    Json o = Json::object();
    o.put("name", b.name).put("born_at", b.born_at).put("points", b.points()).put("start_reason", to_string(b.start_reason));
    summary.add(std::move(o.put("stop_reason", to_string(b.stop_reason)).put("isola", b.isola)));
  }
  results.put("special_points", std::move(points)).put("branches", std::move(summary));
}

std::string BranchOutput::text(const std::vector<Branch>& branches) const {
  std::string out;
  std::vector<const PointColumn*> shown;
  for (const std::size_t i : shown_columns(columns)) shown.push_back(&columns[i]);
  out += fmt::format("{:<7} {:<6} {:<10} {:>18}", "branch", "point", "subtype", fmt::format("{} [{}]", parameter, parameter_unit));
  for (const auto* c : shown) out += fmt::format(" {:>14}", fmt::format("{} [{}]", c->name, c->unit));
  out += fmt::format(" {:>9} {:>9}\n", "unstable", "residual");
  for (const auto& b : branches)
    for (std::size_t i = 0; i < b.special.size(); ++i) {
      const auto& s = b.special[i];
      out += fmt::format("{:<7} {:<6} {:<10} {:>18.11f}", b.name, label(b, i), s.subtype, s.u[s.u.size() - 1]);
      for (const auto* c : shown) out += fmt::format(" {:>14.8f}", c->value(s.u));
      const std::string how = criticality(s);
      out +=
          fmt::format(" {:>9} {:>9.1e}{}{}", fmt::format("{} -> {}", s.unstable_before, s.unstable_after), s.residual, how.empty() ? "" : " ", how);
      if (s.has_coefficient) out += fmt::format(", coefficient {:.6g}", s.coefficient);
      if (has_critical_frequency(s)) out += fmt::format(", frequency {:.8g} rad/s", s.frequency);
      out += '\n';
    }
  for (const auto& b : branches)
    out += fmt::format("branch {:<7} {:>5} points{}, born at {}, ends: {}\n", b.name, b.points(), b.isola ? ", an isola" : "",
                       b.born_at.empty() ? "-" : b.born_at, ends(b));
  return out;
}

}  // namespace whirl::studies
