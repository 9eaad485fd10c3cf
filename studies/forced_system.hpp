#pragma once
/// The forced modal system a study file describes, whatever the section it comes from, as every exact study kind takes it.
///
///     ForcedSystem s = forced_system_of(configuration, {"omega"});
///     HarmonicBalance balance(s.system, {.harmonics = 15, .reflections = s.reflections});
///
/// Throws InputError (one line) for lenses that do not exist and values out of range.

#include "models/harmonic_balance.hpp"
#include "studies/configuration.hpp"
#include "studies/result_file.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

struct ForcedSystem {
  models::ParametricSystem system;
  std::vector<models::CoordinateReflection> reflections;  ///< "WH" of a cable
  std::vector<std::string> coordinates;                   ///< "q1", "q2", ...
  std::string length_unit;                                ///< of the coordinates: "m", or "-" for a model without units
  std::vector<std::string> lens_units;                    ///< of the parameters of `system`
  /// Of a cable at the parameters p: its tension averaged along the chord [N] at coordinates q and phase omega t. Empty for a model without one.
  using Tension = std::function<double(In q, double phase)>;
  std::function<Tension(In p)> tension = {};

  models::ModalSystem<double> at(In p) const;  ///< with the parameters at p
};

/// The two coordinates that show a motion best: the first out of plane and the first in plane, or the first two; twice the only one.
std::array<int, 2> leading_coordinates(const ForcedSystem& s);
/// Names of the coordinates that the first reflection changes the sign of, "y1, y2"; empty without one.
std::string mirrored_coordinates(const ForcedSystem& s);
/// The state (q, q') with `amount` added to the first coordinate of every reflection, which a motion symmetric by chance would never leave; to q1 of
/// a system without.
Vector off_symmetry(const ForcedSystem& s, Vector y, double amount);

/// [cable], [model], [damping], [support_motion], or [modal_model] in their place; omega.
void add_forced_system_keys(Schema& schema);
ForcedSystem forced_system_of(const Configuration& c, const std::vector<std::string>& lenses);
/// The lens exists and the model takes it on [lower, upper]: InputError at `key` or `range_key` otherwise.
void check_forced_lens(const Configuration& c, const std::string& key, const std::string& lens, const std::string& range_key, double lower,
                       double upper);
/// The value a lens has in the file.
double forced_lens_value(const Configuration& c, const std::string& lens);
/// Warnings about the validity of the model; refusals as InputError.
std::vector<std::string> check_forced_system(const Configuration& c);
/// Derived numbers of the cable into /cable; nothing for a model without one.
void write_forced_system(ResultFile& file, RunContext& context, const Configuration& c);

}  // namespace whirl::studies
