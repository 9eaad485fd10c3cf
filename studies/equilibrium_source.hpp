#pragma once
/// Where the equilibrium problem of a study comes from: the averaged superharmonic slow flow of a [cable], the slow flow of any [ansatz] of a
/// [cable] or a [modal_model] (averaged_source.hpp), or an [equilibrium_model].
/// The kinds `continuation` and `two-parameter` ask it for problems, columns, names and starts and know nothing else of the model.
///
///     const auto source = equilibrium_source(configuration);
///     const auto f = source->problem({"omega"});
///     for (const Start& s : source->starts(*f, lower, upper)) network.add_seed(s.u, s.origin);

#include <memory>

#include "continuation/network.hpp"
#include "studies/branch_output.hpp"
#include "studies/configuration.hpp"
#include "studies/result_file.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

struct Start {
  Vector u;  ///< (x, p), near a solution
  std::string origin;
};

/// An angle that walks keep within one turn, and all that turns with it.
struct AngleWindow {
  continuation::CoordinateBound bound;
  Vector turn;  ///< 2 pi in the angle, multiples of it in others that it takes along
};

class EquilibriumSource {
 public:
  virtual ~EquilibriumSource() = default;

  virtual std::unique_ptr<Problem> problem(const std::vector<std::string>& lenses) const = 0;
  virtual double value(const std::string& lens) const = 0;
  virtual std::string unit(const std::string& lens) const = 0;
  /// InputError at `key` if the lens is unknown, at `range_key` if the model does not take it there.
  virtual void check_lens(const std::string& key, const std::string& lens, const std::string& range_key, double lower, double upper) const = 0;
  virtual std::vector<std::string> warnings() const = 0;

  /// Quantities of a point (x, parameters) of a problem of this source.
  virtual std::vector<PointColumn> columns(const Problem& f) const = 0;
  /// Further columns where the unknowns are amplitudes: extremes of the coordinates over a period.
  virtual std::vector<PointColumn> extremes(const Problem&) const { return {}; }
  /// Those of `columns` whose extrema can be found, each with x'Qx + l'x.
  virtual std::vector<continuation::Observable> observables() const = 0;
  virtual continuation::Network::Namer namer() const = 0;
  /// Points near solutions, in the order in which they are to be tried; f has one free parameter.
  virtual std::vector<Start> starts(const Problem& f, const std::string& lens, double lower, double upper) const = 0;
  virtual void write(ResultFile& file, RunContext& context) const = 0;
  /// Coordinates of which values a turn apart are one.
  virtual std::vector<AngleWindow> angles() const { return {}; }
  /// Why the solution u of f is not isolated, one line with what to do about it; "" if it is, or if the source cannot tell.
  virtual std::string not_isolated(const Problem&, In) const { return ""; }
  /// Can a branch that begins with isolated solutions lead to others that are not?
  virtual bool may_leave_isolation() const { return false; }
  /// The branches as they are to be told: special points that the source does not stand for are marked, and that is warned of.
  virtual std::vector<continuation::Branch> marked(const std::vector<continuation::Branch>& branches, RunContext&) const { return branches; }
};

/// [cable] and what belongs to it, or [modal_model], with response.order or [ansatz]; or [equilibrium_model].
void add_equilibrium_source_keys(Schema& schema);
std::unique_ptr<EquilibriumSource> equilibrium_source(const Configuration& c);

/// A model given as expressions has no parameter by default: InputError that names those there are, if `key` is left out.
void check_parameter_given(const Configuration& c, const std::string& key);
/// The observables that continuation.peaks names.
std::vector<continuation::Observable> peaks_of(const Configuration& c, const EquilibriumSource& source);
/// A start that leads nowhere is told, not fatal. Angles are brought into their windows.
void try_seed(continuation::Network& net, const Vector& u, const std::string& origin, RunContext& context);
/// Goes on at the other end of an angle's window where a branch has left it.
void follow_angles(continuation::Network& net, const EquilibriumSource& source, RunContext& context);
/// u with each angle within its window.
Vector within_windows(Vector u, const std::vector<AngleWindow>& windows);

}  // namespace whirl::studies
