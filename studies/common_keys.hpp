#pragma once
/// Keys, conversions and result-file parts that study kinds share.

#include "continuation/network.hpp"
#include "models/nielsen_kirkegaard.hpp"
#include "models/steady_motion.hpp"
#include "models/superharmonic.hpp"
#include "studies/configuration.hpp"
#include "studies/numbers.hpp"
#include "studies/result_file.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

/// [cable] with coefficients, [model], [damping], [support_motion], omega. `any_motion`: either end moves, in any direction.
void add_stay_keys(Schema& schema, bool any_motion = false);
/// [continuation] with the parameter's default.
void add_continuation_keys(Schema& schema, const std::string& default_parameter);
void add_verification_keys(Schema& schema);

models::StayParameters<double> stay_of(const Configuration& c);
models::Coefficients coefficients_of(const Configuration& c);
models::Terms terms_of(const Configuration& c);
continuation::NetworkOptions network_of(const Configuration& c);
models::SettleOptions settle_of(const Configuration& c);

/// The parameter exists and its range lies within what the field accepts; InputError otherwise.
void check_lens_range(const Configuration& c, const std::string& parameter, const continuation::WalkOptions& walk);
/// Warnings of models::check; its refusals as InputError at the key's place.
std::vector<std::string> check_cable(const Configuration& c);

/// Largest chord tension over an excitation period at an averaged state [N].
double largest_tension(const models::SuperharmonicFlow& flow, models::Coefficients choice, In u);

/// /study: kind, version, git hash, libraries, configuration as text and as attributes.
void write_study(ResultFile& file, const Configuration& c);
/// "w2.1000", with more digits where four decimals do not tell the frequency [rad/s]: part of a group's name.
std::string frequency_label(double omega);
/// Sag, stiffness ratio and frequencies of a shallow cable into /cable and the report.
void write_cable_numbers(ResultFile& file, RunContext& context, const models::Cable<double>& cable);
/// Warnings and stop reasons into /study and the report; the exit status they amount to.
/// `failures`: what else was not reached, such as motions that did not settle; each is a warning, a stop reason and exit status 1.
ExitStatus finish(ResultFile& file, RunContext& context, const std::vector<continuation::Branch>& branches,
                  const std::vector<std::string>& failures = {});
/// The same where the outcome is known: `status`, or that the user stopped the run, with the reasons that stopped its parts.
ExitStatus finish(ResultFile& file, RunContext& context, ExitStatus status, const std::vector<std::string>& reasons = {});

}  // namespace whirl::studies
