#pragma once
/// Time integration beside averaged branches of any ansatz: where does the motion settle, and how far is the averaged one from it?

#include <optional>

#include "studies/run_context.hpp"
#include "studies/slow_flow_ansatz.hpp"

namespace whirl::studies {

/// An averaged solution at one frequency.
struct AveragedSolution {
  std::string branch;
  Vector u;  ///< (x, omega)
  bool stable;
};

struct IntegratedRun {
  double omega;
  Vector start;  ///< (q, q')
  std::string start_name;
  bool at_rest;  ///< started from rest, not from an averaged state
  models::SteadyMotion motion;
  std::optional<AveragedSolution> averaged;   ///< the nearest stable one that moves in the same coordinates, with fractions of omega or without
  Matrix transient;                           ///< coordinates x samples, from the start on
  std::optional<AveragedSolution> told = {};  ///< the averaged solution that it started from
  std::string contradiction = {};             ///< what the motion says against that one, if it is stable; "" nothing
};

struct IntegrationOptions {
  double perturbation = 1e-3;               ///< added to the first coordinate
  std::vector<std::vector<double>> starts;  ///< displacements at rest
  models::SettleOptions settle;
  int transient_periods = 60;
  static constexpr int transient_samples = 32;  ///< per excitation period
};

/// Amplitude of harmonic k (units of omega/nu) of coordinate i.
double amplitude_of(const models::Ansatz& ansatz, const models::SteadyMotion& motion, int i, int k);

/// From every averaged solution and from the starts at each frequency, on all cores.
std::vector<IntegratedRun> integrate_beside(const ForcedSystem& forced, const AveragedEquations& averaged, const std::vector<double>& omegas,
                                            const std::vector<std::vector<AveragedSolution>>& solutions, const IntegrationOptions& options,
                                            RunContext& context);

/// /verification/averaged/w<omega>-<n>: one period of each averaged solution.
void write_averaged(ResultFile& file, const ForcedSystem& forced, const AveragedEquations& averaged,
                    const std::vector<std::vector<AveragedSolution>>& solutions);
/// /verification/runs, series, spectra, transients.
void write_integrated(ResultFile& file, const ForcedSystem& forced, const AveragedEquations& averaged, const std::vector<IntegratedRun>& runs);
/// A line for each run that did not settle or could not be integrated, and for each that left the stable solution where it started.
std::vector<std::string> not_settled(const std::vector<IntegratedRun>& runs);
/// "verification": a row a run.
void report_integrated(Json& results, const ForcedSystem& forced, const AveragedEquations& averaged, const std::vector<IntegratedRun>& runs);
std::string integrated_text(const ForcedSystem& forced, const AveragedEquations& averaged, const std::vector<IntegratedRun>& runs);

}  // namespace whirl::studies
