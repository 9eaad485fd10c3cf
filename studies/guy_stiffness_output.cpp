#include "studies/guy_stiffness_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/guy/collocation.hpp"
#include "models/guy/level.hpp"
#include "models/guy/longitudinal.hpp"
#include "models/guy/tangent.hpp"

namespace whirl::studies {

using namespace models::guy;
using C = std::complex<double>;
using std::numbers::pi;

namespace {

std::string underscored(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

void add_complex(std::vector<Column>& columns, const std::string& name, const std::string& what, const std::vector<C>& k) {
  columns.push_back(column(name + "_re", "N/m", what + ", real part", k.size(), [&](auto i) { return k[i].real(); }));
  columns.push_back(column(name + "_im", "N/m", what + ", imaginary part", k.size(), [&](auto i) { return k[i].imag(); }));
}

std::vector<Column> frequency_columns(const GuyStiffnessSetup& s) {
  const double w1 = string_frequency(s.guy.first_order, 1);
  const std::size_t n = s.omega.size();
  return {column("omega", "rad/s", "frequency of the mast's motion", n, [&](auto i) { return s.omega[i]; }),
          column("omega_ratio", "-", "omega / w_1 of the mean-tension string", n, [&](auto i) { return s.omega[i] / w1; }),
          column("frequency", "Hz", "omega / 2 pi", n, [&](auto i) { return s.omega[i] / (2.0 * pi); })};
}

}  // namespace

void write_horizontal(ResultFile& file, const GuyStiffnessSetup& s, const LinearGuy& full) {
  const std::size_t n = s.omega.size();
  std::vector<C> exact(n), undamped(n), closed(n);
  full.modulus(Direction::horizontal, s.omega, s.damping_rate, exact);
  full.modulus(Direction::horizontal, s.omega, 0.0, undamped);
  auto columns = frequency_columns(s);
  add_complex(columns, "full", "full linear problem", exact);
  columns.push_back(column("full_undamped", "N/m", "full linear problem without damping", n, [&](auto i) { return undamped[i].real(); }));
  const ClosedStiffness forms(s.guy.first_order, s.alpha);
  for (const ClosedForm form : s.forms) {
    const std::string name = underscored(std::string(to_string(form)));
    for (std::size_t i = 0; i < n; ++i) closed[i] = forms.modulus(form, s.omega[i], s.damping_rate);
    add_complex(columns, name, fmt::format("closed form {}", to_string(form)), closed);
    columns.push_back(
        column("error_" + name, "-", "relative to the full problem", n, [&](auto i) { return std::abs(closed[i] - exact[i]) / std::abs(exact[i]); }));
  }
  file.table("/stiffness/horizontal", columns);
  file.attribute("/stiffness/horizontal", "static", tangent(s.guy.exact).xx);
  file.attribute("/stiffness/horizontal", "taut", s.guy.rest.guy.taut_modulus());
  file.attribute("/stiffness/horizontal", "alpha", forms.alpha());
  file.attribute("/stiffness/horizontal", "string_frequency", forms.string_frequency());
  file.attribute("/stiffness/horizontal", "damping_rate", s.damping_rate);
  file.attribute("/stiffness/horizontal", "degree", full.degree());
}

void write_matrix(ResultFile& file, const GuyStiffnessSetup& s, const LinearGuy& full) {
  const std::size_t n = s.omega.size();
  std::vector<C> xy(n), yy(n), zz(n), closed(n);
  const ClosedStiffness forms(s.guy.first_order, s.alpha);
  for (std::size_t i = 0; i < n; ++i) {
    const StiffnessMatrix k = full.stiffness(s.omega[i], s.damping_rate);
    xy[i] = k.xy, yy[i] = k.yy, zz[i] = k.zz;
    closed[i] = forms.out_of_plane(s.omega[i], s.damping_rate);
  }
  auto columns = frequency_columns(s);
  add_complex(columns, "xy", "horizontal force per vertical motion", xy);
  add_complex(columns, "yy", "vertical", yy);
  add_complex(columns, "zz", "out of plane", zz);
  add_complex(columns, "zz_linear_tension", "out of plane, Bessel functions", closed);
  file.table("/stiffness/matrix", columns);
  if (s.azimuths.empty()) return;
  std::vector<LevelMember> level;
  for (const double a : s.azimuths) level.push_back({&full, a * pi / 180.0});
  std::vector<C> entries[4];
  for (const double omega : s.omega) {
    const Eigen::Matrix3cd k = level_stiffness(level, omega, s.damping_rate);
    int j = 0;
    for (const C& value : {k(0, 0), k(0, 1), k(1, 1), k(2, 2)}) entries[j++].push_back(value);
  }
  columns = frequency_columns(s);
  int j = 0;
  for (const char* name : {"XX", "XY", "YY", "ZZ"})
    add_complex(columns, name, fmt::format("level, {}: X at azimuth 0, Y at 90 degrees, Z upwards", name), entries[j++]);
  file.table("/stiffness/level", columns);
  file.attribute("/stiffness/level", "azimuths_deg", s.azimuths);
}

std::vector<PoleOrZero> poles_and_zeros(const LinearGuy& full) {
  std::vector<PoleOrZero> all;
  const std::pair<Direction, const char*> directions[] = {
      {Direction::horizontal, "horizontal"}, {Direction::vertical, "vertical"}, {Direction::out_of_plane, "out of plane"}};
  for (const auto& [d, name] : directions) {
    for (const Pole& p : full.poles(d == Direction::out_of_plane ? Plane::out_of_plane : Plane::in_plane))
      all.push_back({name, "pole", p.frequency,
                     d == Direction::horizontal ? p.strength_xx
                     : d == Direction::vertical ? p.strength_yy
                                                : p.strength_zz});
    for (const double z : full.zeros(d)) all.push_back({name, "zero", z, 0.0});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const PoleOrZero& a, const PoleOrZero& b) { return a.direction == b.direction ? a.omega < b.omega : false; });
  return all;
}

void write_listed(ResultFile& file, const GuyStiffnessSetup& s, const std::vector<PoleOrZero>& all) {
  const double w1 = string_frequency(s.guy.first_order, 1);
  TextColumn direction{"direction", "of force and motion", {}}, type{"type", "pole: a mode with both ends held; zero: no force at the mast", {}};
  for (const PoleOrZero& p : all) direction.values.push_back(p.direction), type.values.push_back(p.type);
  file.table(
      "/poles_and_zeros",
      {column("omega", "rad/s", "undamped", all.size(), [&](auto i) { return all[i].omega; }),
       column("omega_ratio", "-", "omega / w_1 of the mean-tension string", all.size(), [&](auto i) { return all[i].omega / w1; }),
       column("damping_ratio", "-", "c / (2 m omega), of this mode or zero", all.size(), [&](auto i) { return 0.5 * s.damping_rate / all[i].omega; }),
       column("strength", "N/m", "near a pole K ~ -strength / (1 - p_e^2 / omega^2); 0 for zeros", all.size(),
              [&](auto i) { return all[i].strength; })},
      {direction, type});
}

// Error of the horizontal modulus against the degree, up to 160, both methods, from a solution of twice the suitable degree.
void write_convergence(ResultFile& file, const GuyStiffnessSetup& s) {
  const double p = s.convergence_omega;
  const int fine = std::min(largest_degree, 2 * suitable_degree(s.guy.exact, p));
  const C reference = LinearGuy(s.guy.exact, p, fine).modulus(Direction::horizontal, p, s.damping_rate);
  std::vector<double> degree, galerkin, collocation;
  const int last = std::min(160, static_cast<int>(1.25 * suitable_degree(s.guy.exact, p)));
  const int step = 2 * std::max(1, last / 60);  // even: collocation differs with parity
  for (int n = 4; n <= last && !interrupted; n += step) {
    degree.push_back(n);
    galerkin.push_back(std::abs(LinearGuy(s.guy.exact, p, n).modulus(Direction::horizontal, p, s.damping_rate) - reference) / std::abs(reference));
    collocation.push_back(std::abs(collocated_stiffness(s.guy.exact, p, s.damping_rate, n).xx - reference) / std::abs(reference));
  }
  file.table("/convergence", {{"degree", "-", "polynomial degree; collocation uses one point more", degree},
                              {"error_galerkin", "-", "relative error of the horizontal modulus", galerkin},
                              {"error_collocation", "-", "relative error of the horizontal modulus", collocation}});
  file.attribute("/convergence", "omega", p);
  file.attribute("/convergence", "reference_degree", fine);
}

void write_longitudinal(ResultFile& file, const GuyStiffnessSetup& s) {
  const ClosedStiffness forms(s.guy.first_order, s.alpha);
  const Statics& rest = s.guy.first_order;
  const LongitudinalGuy bar(rest.length, rest.guy.axial_stiffness, rest.guy.mass_per_length, forms.alpha());
  const std::size_t n = 1000;
  const auto X = [&](std::size_t i) { return 4.0 * pi * static_cast<double>(i + 1) / static_cast<double>(n); };
  const auto p = [&](std::size_t i) { return X(i) * bar.wave_speed() / rest.length; };
  file.table("/longitudinal", {column("X", "-", "p L / a", n, X), column("omega", "rad/s", "p", n, p),
                               column("displacement", "-", "tan X / X: end displacement over static, constant force, no damping", n,
                                      [&](auto i) { return bar.magnification_of_displacement(p(i), 0.0).real(); }),
                               column("force", "-", "X / tan X: end force over static, constant displacement, no damping", n,
                                      [&](auto i) { return bar.magnification_of_force(p(i), 0.0).real(); }),
                               column("displacement_damped", "-", "modulus of tan X / X with the study's damping", n,
                                      [&](auto i) { return std::abs(bar.magnification_of_displacement(p(i), s.damping_rate)); }),
                               column("force_damped", "-", "modulus of X / tan X with the study's damping", n,
                                      [&](auto i) { return std::abs(bar.magnification_of_force(p(i), s.damping_rate)); })});
  file.attribute("/longitudinal", "wave_speed", bar.wave_speed());
  file.attribute("/longitudinal", "alpha", forms.alpha());
}

void report_stiffness(Json& results, const GuyStiffnessSetup& s, const std::vector<PoleOrZero>& all) {
  Json points = Json::array(), branches = Json::array(), branch = Json::object();
  for (const PoleOrZero& p : all) {
    Json o = Json::object();
    points.add(std::move(o.put("branch", p.direction).put("type", p.type).put("omega", p.omega).put("strength", p.strength)));
  }
  branches.add(std::move(branch.put("name", "horizontal").put("points", s.omega.size()).put("stop_reason", "end")));
  results.put("special_points", std::move(points)).put("branches", std::move(branches));
}

std::vector<StiffnessAt> stiffness_at(const GuyStiffnessSetup& s, const LinearGuy& full) {
  const ClosedStiffness forms(s.guy.first_order, s.alpha);
  std::vector<LevelMember> level;
  for (const double a : s.azimuths) level.push_back({&full, a * pi / 180.0});
  std::vector<StiffnessAt> rows;
  for (const double omega : s.at) {
    const StiffnessMatrix k = full.stiffness(omega, s.damping_rate);
    StiffnessAt row{omega, {{"xx", k.xx}, {"xy", k.xy}, {"yy", k.yy}, {"zz", k.zz}}};
    for (const ClosedForm form : s.forms)
      row.entries.emplace_back(underscored(std::string(to_string(form))), forms.modulus(form, omega, s.damping_rate));
    row.entries.emplace_back("zz_linear_tension", forms.out_of_plane(omega, s.damping_rate));
    if (!level.empty()) {
      const Eigen::Matrix3cd K = level_stiffness(level, omega, s.damping_rate);
      for (const auto& [name, value] : {std::pair{"XX", K(0, 0)}, {"XY", K(0, 1)}, {"YY", K(1, 1)}, {"ZZ", K(2, 2)}})
        row.entries.emplace_back(name, value);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void write_stiffness_at(ResultFile& file, RunContext& context, const std::vector<StiffnessAt>& rows) {
  if (rows.empty()) return;
  std::vector<Column> columns{column("omega", "rad/s", "frequency of the mast's motion", rows.size(), [&](auto i) { return rows[i].omega; })};
  Json list = Json::array();
  std::string text = "\nstiffness [N/m]\n";
  for (std::size_t k = 0; k < rows.front().entries.size(); ++k) {
    std::vector<C> values;
    for (const StiffnessAt& row : rows) values.push_back(row.entries[k].second);
    add_complex(columns, rows.front().entries[k].first, "as in the other tables of /stiffness; XX, XY, YY, ZZ: of the level", values);
  }
  for (const StiffnessAt& row : rows) {
    Json o = Json::object();
    o.put("omega", row.omega);
    for (const auto& [name, value] : row.entries) {
      o.put(name + "_re", value.real()).put(name + "_im", value.imag());
      text += fmt::format("at {:>14.8g} rad/s  {:<20} {:>18.10g} {:>+18.10g} i\n", row.omega, name, value.real(), value.imag());
    }
    list.add(std::move(o));
  }
  file.table("/stiffness/at", columns);
  context.report.put("stiffness", std::move(list));
  context.print(text);
}

std::string stiffness_text(const GuyStiffnessSetup& s, const std::vector<PoleOrZero>& all) {
  const double w1 = string_frequency(s.guy.first_order, 1);
  std::string out = fmt::format("\n{:<14} {:<6} {:>20} {:>14} {:>18}\n", "direction", "type", "omega [rad/s]", "omega/w_1", "strength [N/m]");
  for (const PoleOrZero& p : all)
    out += fmt::format("{:<14} {:<6} {:>20.11f} {:>14.8f} {:>18}\n", p.direction, p.type, p.omega, p.omega / w1,
                       p.type == "pole" ? fmt::format("{:.6g}", p.strength) : "");
  return out;
}

}  // namespace whirl::studies
