#pragma once
/// The ansatz of a slow-flow study: its keys and the averaged equations they choose.

#include "models/slow_flow/ansatz.hpp"
#include "studies/branch_output.hpp"
#include "studies/forced_system.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

/// Averaged equations of one ansatz, whichever class they come from.
struct AveragedEquations {
  std::unique_ptr<Problem> flow;
  models::Ansatz ansatz;
  std::function<Vector(In u, double t)> motion;  ///< (q, q') at time t
  std::function<Vector(In u)> balance_state;     ///< in the layout of Floquet
  int balance_harmonics = 0;
};

/// [ansatz]. `own_default`: a further kind, which the study handles itself, and the default.
void add_ansatz_keys(Schema& schema, const std::string& own_default = "");
/// `forced` must outlive the result. Throws InputError (one line) for lists and systems that do not fit.
/// ansatz.kind, "auto" resolved.
std::string ansatz_kind(const Configuration& c, const ForcedSystem& forced);

AveragedEquations averaged_of(const Configuration& c, const ForcedSystem& forced);

/// Amplitudes and means, then phases, of a point (x, parameters).
std::vector<PointColumn> harmonic_columns(const ForcedSystem& forced, const models::Ansatz& ansatz);
/// "IP" in plane, "W" whirling, "IPD" and "WD" where a subharmonic is present; "P" and "D" for a model without that reflection.
std::string motion_prefix(const ForcedSystem& forced, const models::Ansatz& ansatz, const continuation::Branch& branch);
/// A solution symmetric but for rounding is made so to the last bit: the walker tells symmetric branches by exact zeros.
Vector symmetric_to_the_bit(const Problem& f, Vector u);

/// Hopf points faster than first-order averaging holds for get the subtype "fast", and a warning says so.
std::vector<continuation::Branch> with_fast_marked(const ForcedSystem& forced, const models::Ansatz& ansatz,
                                                   const std::vector<continuation::Branch>& branches, RunContext& context);
/// Forces whose harmonic the ansatz does not hold, one warning each.
std::vector<std::string> dropped_forces(const ForcedSystem& forced, const models::Ansatz& ansatz);

}  // namespace whirl::studies
