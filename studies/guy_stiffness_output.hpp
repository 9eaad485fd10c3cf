#pragma once
/// Tables and texts of a guy-stiffness run. Frequencies in rad/s, stiffness in N/m; what each table holds stands in its columns.

#include <complex>
#include <string>
#include <utility>
#include <vector>

#include "models/guy/closed_stiffness.hpp"
#include "models/guy/linear_guy.hpp"
#include "studies/guy_keys.hpp"

namespace whirl::studies {

struct GuyStiffnessSetup {
  GuyInput guy;
  std::vector<double> omega, at, azimuths;  ///< frequencies of the tables, those asked for; azimuths of a level's guys [deg], empty: no level
  std::vector<models::guy::ClosedForm> forms;
  double damping_rate = 0.0, alpha = 0.0, convergence_omega = 0.0;
  int degree = 0;  ///< 0: chosen
};

/// The stiffness at one frequency asked for: of the guy, by the closed forms, of the level.
struct StiffnessAt {
  double omega;
  std::vector<std::pair<std::string, std::complex<double>>> entries;
};
std::vector<StiffnessAt> stiffness_at(const GuyStiffnessSetup& s, const models::guy::LinearGuy& full);
/// /stiffness/at, "stiffness" of the report, a printed table; nothing if no frequency is asked for.
void write_stiffness_at(ResultFile& file, RunContext& context, const std::vector<StiffnessAt>& rows);

/// A pole or zero of one direction's undamped stiffness.
struct PoleOrZero {
  std::string direction, type;
  double omega, strength;
};
std::vector<PoleOrZero> poles_and_zeros(const models::guy::LinearGuy& full);

void write_horizontal(ResultFile& file, const GuyStiffnessSetup& s, const models::guy::LinearGuy& full);  ///< /stiffness/horizontal
void write_matrix(ResultFile& file, const GuyStiffnessSetup& s, const models::guy::LinearGuy& full);      ///< /stiffness/matrix, /stiffness/level
void write_listed(ResultFile& file, const GuyStiffnessSetup& s, const std::vector<PoleOrZero>& all);      ///< /poles_and_zeros
void write_convergence(ResultFile& file, const GuyStiffnessSetup& s);                                     ///< /convergence
void write_longitudinal(ResultFile& file, const GuyStiffnessSetup& s);                                    ///< /longitudinal

void report_stiffness(Json& results, const GuyStiffnessSetup& s, const std::vector<PoleOrZero>& all);
std::string stiffness_text(const GuyStiffnessSetup& s, const std::vector<PoleOrZero>& all);

}  // namespace whirl::studies
