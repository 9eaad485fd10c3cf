#pragma once
/// Time integration of the modal equations beside the averaged branches: does the motion settle where the curve says, and how far off is the curve?

#include <optional>

#include "models/steady_motion.hpp"
#include "models/superharmonic.hpp"
#include "studies/result_file.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

/// An averaged solution at one frequency.
struct AveragedState {
  std::string branch;
  Vector u;  ///< (u1, v1, u2, v2, omega)
  bool stable;
};

struct VerificationRun {
  double omega;
  Vector start;  ///< (q1, q2, q1', q2')
  std::string start_name;
  std::optional<AveragedState> averaged;  ///< the start's own state, or the nearest stable one afterwards
  models::SteadyMotion motion;
  std::string contradiction = {};  ///< what the motion says against the stable state that it started from; "" nothing
};

struct VerificationOptions {
  models::StayParameters<double> stay;
  models::Coefficients coefficients = models::Coefficients::exact;
  models::Terms terms = models::Terms::reduced;
  int order = 2;
  double perturbation = 1e-3;  ///< added to q1 [m]: q1 = 0 is invariant
  std::vector<double> starts;  ///< pairs q1, q2 at rest [m]
  models::SettleOptions settle;
};

/// Runs from every averaged state given and from the other starts at each frequency, on all cores.
std::vector<VerificationRun> verify(const models::SuperharmonicFlow& flow, const std::vector<double>& omegas,
                                    const std::vector<std::vector<AveragedState>>& states, const VerificationOptions& options, RunContext& context);

/// Steady motions while the frequency rises or falls from point to point, each starting where the one before ended.
std::vector<VerificationRun> sweep(const std::vector<double>& omegas, const VerificationOptions& options, RunContext& context);

/// A line for each run that did not settle or could not be integrated, and for each that left the stable state where it started.
std::vector<std::string> not_settled(const std::vector<VerificationRun>& runs);

void write_runs(ResultFile& file, const std::vector<VerificationRun>& runs, const models::SuperharmonicFlow& flow, int order);
void write_sweep(ResultFile& file, const std::string& group, const std::vector<VerificationRun>& runs);
/// One averaged orbit over a period as t, q1, q2.
void write_averaged_orbit(ResultFile& file, const std::string& group, const models::SuperharmonicFlow& flow, const AveragedState& state);
/// The recorded motion as t, q1, q2 and its harmonics.
void write_motion(ResultFile& file, const std::string& series_group, const std::string& spectrum_group, const VerificationRun& run);
/// "verification": a row a run.
void report_runs(Json& results, const std::vector<VerificationRun>& runs, const models::SuperharmonicFlow& flow, int order);
std::string runs_text(const std::vector<VerificationRun>& runs, const models::SuperharmonicFlow& flow, int order);

}  // namespace whirl::studies
