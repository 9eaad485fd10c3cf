#include "studies/branch_output.hpp"

#include "continuation/normal_form.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>
#include <span>

#include "studies/open_results.hpp"

namespace whirl::studies {
namespace {

using continuation::Branch;
using continuation::criticality;
using continuation::EventType;
using continuation::SpecialPoint;

std::string json_number(double x) { return std::isfinite(x) ? fmt::format("{:.17g}", x) : "null"; }

std::string json_text(const std::string& s) {
  std::string out = "\"";
  for (char c : s) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string ends(const Branch& b) { return fmt::format("{}, {}", to_string(b.start_reason), to_string(b.stop_reason)); }

}  // namespace

bool is_own_column(const std::string& name) {
  static const std::set<std::string> own = {
      "branch",          "label",          "type",       "subtype",   "criticality",       "point",         "period",
      "unstable_before", "unstable_after", "n_unstable", "frequency", "coefficient",       "arclength",     "residual",
      "bracket_lower",   "bracket_upper",  "bracket",    "step",      "newton_iterations", "stable_before", "stable_after",
      "curve",           "stable"};
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
  for (const auto& column : columns) add(column.name, column.unit, column.description, [&](int i) { return column.value(b.u(i)); });
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
  add("frequency", "rad/s", "Hopf, torus: of the motion that is born, in the slow time or beside the excitation",
      [](const SpecialPoint& s) { return s.frequency; });
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

std::string BranchOutput::json(const std::vector<Branch>& branches) const {
  std::string points, summary;
  for (const auto& b : branches) {
    for (std::size_t i = 0; i < b.special.size(); ++i) {
      const auto& s = b.special[i];
      std::string o = fmt::format(R"({{"branch": {}, "label": {}, "type": "{}", "subtype": {}, "{}": {}, "period": {})", json_text(b.name),
                                  json_text(label(b, i)), to_string(s.type), json_text(s.subtype), parameter, json_number(s.u[s.u.size() - 1]),
                                  json_number(period_at(s.u)));
      o += fmt::format(R"(, "stable_before": {}, "stable_after": {}, "unstable_before": {}, "unstable_after": {})", s.stable_before(),
                       s.stable_after(), s.unstable_before, s.unstable_after);
      for (const auto& column : columns) o += fmt::format(R"(, "{}": {})", column.name, json_number(column.value(s.u)));
      if (s.type == EventType::hopf || s.type == EventType::torus) o += fmt::format(R"(, "frequency": {})", json_number(s.frequency));
      if (s.has_coefficient) o += fmt::format(R"(, "coefficient": {})", json_number(s.coefficient));
      if (const std::string how = criticality(s); !how.empty()) o += fmt::format(R"(, "criticality": "{}")", how);
      o += fmt::format(R"(, "residual": {}, "bracket": [{}, {}]}})", json_number(s.residual), json_number(s.bracket[0]), json_number(s.bracket[1]));
      points += (points.empty() ? "\n    " : ",\n    ") + o;
    }
    summary += fmt::format(R"({}    {{"name": {}, "born_at": {}, "points": {}, "start_reason": "{}", "stop_reason": "{}", "isola": {}}})",
                           summary.empty() ? "\n" : ",\n", json_text(b.name), json_text(b.born_at), b.points(), to_string(b.start_reason),
                           to_string(b.stop_reason), b.isola);
  }
  return fmt::format("{{\n  \"special_points\": [{}\n  ],\n  \"branches\": [{}\n  ]\n}}\n", points, summary);
}

std::string BranchOutput::text(const std::vector<Branch>& branches) const {
  std::string out;
  // Amplitudes only: phases and derived numbers stand in the file.
  std::vector<const PointColumn*> shown;
  const bool chosen = std::any_of(columns.begin(), columns.end(), [](const auto& c) { return c.shown; });
  for (const auto& c : columns)
    if ((c.shown || (!chosen && c.unit != "rad" && c.name.starts_with("q"))) && shown.size() < 5) shown.push_back(&c);
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
          fmt::format(" {:>9} {:>9.1e}{}{}\n", fmt::format("{} -> {}", s.unstable_before, s.unstable_after), s.residual, how.empty() ? "" : " ", how);
    }
  for (const auto& b : branches)
    out += fmt::format("branch {:<7} {:>5} points{}, born at {}, ends: {}\n", b.name, b.points(), b.isola ? ", an isola" : "",
                       b.born_at.empty() ? "-" : b.born_at, ends(b));
  return out;
}

}  // namespace whirl::studies
