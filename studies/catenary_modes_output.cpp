#include "studies/catenary_modes_output.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace whirl::studies {

using namespace models::catenary;

namespace {

// The model as text for a study file: [modal_model] of any kind that integrates or balances.
std::string modal_model_text(const models::ModalModel& m, const ReducedModel& r) {
  std::string text = fmt::format("[modal_model]                       # {} modes out of plane, then {} in plane; largest displacements [m]\n",
                                 r.out_of_plane, r.in_plane);
  text += fmt::format("frequency = [{:.12g}]\ndamping = [{:.6g}]\nterm = [\n", fmt::join(m.frequency, ", "), fmt::join(m.damping, ", "));
  for (const auto& t : m.terms)
    text += fmt::format("  {{ equation = {}, coefficient = {:.10g}, powers = [{}] }},\n", t.equation + 1, t.coefficient, fmt::join(t.powers, ", "));
  return text + "]\n";
}

double ratio(const DampedMode& mode) { return -mode.lambda.real() / std::abs(mode.lambda); }

}  // namespace

void write_damped(ResultFile& file, const HangingCable& cable, const DampedSet& set, int points) {
  const double unit = frequency_unit(cable), H = horizontal_tension(cable), a = cable.shape.a;
  std::vector<Column> t{{"mode", "-", "number", {}},
                        {"decay", "1/s", "decay rate, -Re lambda", {}},
                        {"damped_omega", "rad/s", "frequency of oscillation, Im lambda", {}},
                        {"damping_ratio", "-", "-Re lambda over its modulus", {}},
                        {"odd_share", "-", "as in /modes/in_plane", {}}};
  for (std::size_t i = 0; i < set.modes.size(); ++i) {
    const DampedMode& mode = set.modes[i];
    const double values[] = {double(i + 1), -mode.lambda.real() * unit, mode.lambda.imag() * unit, ratio(mode), mode.odd_share};
    for (std::size_t k = 0; k < t.size(); ++k) t[k].values.push_back(values[k]);
  }
  file.table("/modes/damped", t);
  std::vector<double> overdamped = set.overdamped;
  for (double& rate : overdamped) rate *= -unit;
  file.attribute("/modes/damped", "overdamped_decay", overdamped);
  if (points < 2) return;
  const Along line = along(cable, points);
  for (std::size_t i = 0; i < set.modes.size(); ++i) {
    const Eigen::MatrixXcd f = set.modes[i].field.at(line.x);
    auto columns = line.columns;
    const auto add = [&](const char* name, const char* phase, const char* unit_name, const char* what, Quantity quantity, double scale) {
      const auto values = f.col(static_cast<int>(quantity));
      columns.push_back(
          {name, unit_name, fmt::format("amplitude of the {}; the largest displacement is 1 m", what), to_std(values.cwiseAbs() * scale)});
      columns.push_back({phase, "rad", fmt::format("phase of the {}", what), to_std(values.array().arg().matrix())});
    };
    add("U", "U_phase", "m", "tangential displacement", Quantity::U, 1.0);
    add("V", "V_phase", "m", "normal displacement", Quantity::V, 1.0);
    add("tension", "tension_phase", "N", "dynamic tension", Quantity::T, H / a);
    file.table(fmt::format("/shapes/damped/mode{}", i + 1), columns);
  }
}

std::string damped_text(const DampedSet& set, double unit) {
  if (set.modes.empty()) return {};
  std::string out = fmt::format("{:<13} {:>4} {:>18} {:>16} {:>16}\n", "with drag", "mode", "omega [rad/s]", "decay [1/s]", "damping ratio");
  for (std::size_t i = 0; i < set.modes.size(); ++i) {
    const DampedMode& m = set.modes[i];
    out += fmt::format("{:<13} {:>4} {:>18.11g} {:>16.9g} {:>16.6g}\n", "", i + 1, m.lambda.imag() * unit, -m.lambda.real() * unit, ratio(m));
  }
  if (!set.overdamped.empty()) out += fmt::format("{:<13} {} roots do not oscillate\n", "", set.overdamped.size());
  return out;
}

// The model's frequencies and coefficients: in the report, and as the lines of a study file on screen.
static void report_reduced(RunContext& context, const models::ModalModel& m, const ReducedModel& r, const HangingCable& cable) {
  const double a = cable.shape.a, left_out = r.first_left_out * frequency_unit(cable);
  std::vector<double> curvature;
  for (int i = 0; i < m.size(); ++i) curvature.push_back(backbone_curvature(r, i) / (a * a));
  Json terms = Json::array();
  for (const auto& t : m.terms) {
    Json powers = Json::array(), o = Json::object();
    for (const int power : t.powers) powers.add(power);
    terms.add(std::move(o.put("equation", t.equation + 1).put("coefficient", t.coefficient).put("powers", std::move(powers))));
  }
  Json model = Json::object();
  model.put("frequency", Json::array(m.frequency)).put("damping", Json::array(m.damping)).put("curvature", Json::array(curvature));
  context.report.put("reduced", std::move(model.put("first_left_out", left_out).put("terms", std::move(terms))));
  context.print(
      fmt::format("nonlinear model of {} modes: {} terms; lowest frequency in plane without inertia {:.6g} rad/s; relative change of frequency per "
                  "m^2: {:.4g}\n{}",
                  m.size(), m.terms.size(), left_out, fmt::join(curvature, " "), modal_model_text(m, r)));
}

void write_reduced(ResultFile& file, const HangingCable& cable, const ReducedOptions& o, RunContext& context) {
  if (o.out_of_plane + o.in_plane == 0) return;
  CoreCable core = core_of(cable);
  core.kappa = std::max(core.kappa, 1e-7);  // stands for an inextensible cable
  const ReducedModel r = reduced_model(core, o);
  for (Eigen::Index i = 0; i < r.omega.size(); ++i)
    for (Eigen::Index j = 0; j < r.omega.size(); ++j)
      for (const int multiple : {1, 3}) {
        const double detuning = multiple * r.omega[i] / r.omega[j] - 1.0;
        if (i == j || (multiple == 1 && i > j) || std::abs(detuning) > 0.02) continue;
        context.warn(fmt::format(
            "reduced: coordinates q{} and q{} are within {:.2g} % of 1:{}, where the model's second order does not hold: keep fewer modes", i + 1,
            j + 1, 100.0 * std::abs(detuning), multiple));
      }
  const models::ModalModel m = in_si_units(r, cable);
  std::vector<Column> t{{"equation", "-", "number of the coordinate, from 1", {}}, {"coefficient", "1/s^2/m^k", "on the left-hand side", {}}};
  for (int i = 0; i < m.size(); ++i) t.push_back({fmt::format("power{}", i + 1), "-", fmt::format("of q{}", i + 1), {}});
  for (const auto& term : m.terms) {
    t[0].values.push_back(term.equation + 1.0);
    t[1].values.push_back(term.coefficient);
    for (std::size_t i = 0; i < term.powers.size(); ++i) t[i + 2].values.push_back(term.powers[i]);
  }
  file.table("/reduced", t);
  file.text("/reduced", "modal_model", modal_model_text(m, r));
  file.attribute("/reduced", "first_left_out", r.first_left_out * frequency_unit(cable));
  report_reduced(context, m, r, cable);
}

}  // namespace whirl::studies
