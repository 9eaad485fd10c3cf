#pragma once
/// Keys and result tables that the kinds `integrate` and `basins` share: [integration], attractors with their harmonics, sections, spectra.

#include "models/attractors.hpp"
#include "studies/forced_system.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

/// [integration]: tolerances, how long to wait, what to look for.
void add_integration_keys(Schema& schema);
models::AttractorOptions attractor_options_of(const Configuration& c);

/// Reflections of the coordinates as reflections of states (q, q').
std::vector<Reflection> state_reflections(const ForcedSystem& s);
/// "q1", "q2", "q1'", "q2'"
std::vector<std::string> state_names(const ForcedSystem& s);
std::string state_unit(const ForcedSystem& s, int state);
/// Starts that a reflection leaves alone would stay in its subspace: `amount` is added to the coordinates it turns.
Vector perturbed(Vector y, const std::vector<Reflection>& reflections, double amount);

/// One attractor as the tables show it.
struct AttractorRow {
  double omega;
  const models::Attractor* attractor;
  models::SteadyMotion motion;
  std::string name;    ///< "A1"
  std::string mirror;  ///< name of its mirror image; "" if it has none of its own
};
/// omega, kind, multiple, exponent, multiplier, second frequency, extremes and harmonics of every coordinate.
std::vector<Column> attractor_columns(const std::vector<AttractorRow>& rows, const ForcedSystem& s);
std::vector<TextColumn> attractor_texts(const std::vector<AttractorRow>& rows);
std::string attractor_text(const std::vector<AttractorRow>& rows, const ForcedSystem& s, const std::vector<std::string>& extra_heads = {},
                           const std::vector<std::vector<std::string>>& extra = {});
void put_attractor(Json& object, const AttractorRow& row, const ForcedSystem& s);

/// series, spectrum (lines: coordinate, multiple of omega, amplitude, phase), for motions without period the whole amplitude spectrum.
void write_motion_tables(ResultFile& file, const std::string& group, const AttractorRow& row, const ForcedSystem& s);
/// Stroboscopic points at omega t = phase.
void write_section(ResultFile& file, const std::string& group, const Matrix& points, const ForcedSystem& s);

}  // namespace whirl::studies
