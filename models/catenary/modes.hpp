#pragma once
/// Natural frequencies and modes of a hanging cable, in plane and out of plane, each set with the count that proves none is missing.
///
/// The spectral problem of galerkin.hpp is solved with as many functions as the highest mode wanted needs: they are added until its last
/// coefficients are below 1e-9 of the whole. Then frequencies below the gap behind the last mode are counted by inertia in a finer discretisation.
/// Frequencies are in sqrt(g/a), increasing. Modes are scaled to a largest displacement of 1 and start with V (or W) > 0 at the lower end.
///
///     ModeSet set = in_plane_modes({.x1 = g.x1, .x2 = g.x2, .kappa = 1e-3}, {.count = 8});
///     set.modes[0].omega, set.modes[0].kind, set.complete
///     Vector v = set.modes[0].field.at(x, Quantity::V);
///
/// Throws std::invalid_argument for parameters out of range. A set that could not be resolved or counted says so: `resolved`, `complete`.

#include <complex>
#include <optional>
#include <vector>

#include "models/catenary/field.hpp"
#include "models/catenary/resolution.hpp"

namespace whirl::models::catenary {

/// The dimensionless cable.
struct CoreCable {
  double x1, x2;
  double kappa = 0.0;                         ///< H/EA
  double eta1 = 0.0, eta2 = 0.0, eta3 = 0.0;  ///< drag over mass, tangential, normal, out of plane [sqrt(g/a)]
};

enum class ModeKind { symmetric, antisymmetric, hybrid };
const char* to_string(ModeKind kind);
/// Below 5 % and above 95 % odd share a mode counts as symmetric and antisymmetric.
ModeKind kind_of(double odd_share);

struct ModeOptions {
  static constexpr int most = 2000;  ///< modes of a set: more than lie below `highest_frequency` of a taut or a sagging cable
  int count = 8;
  int functions = 0;   ///< 0: as many as the highest mode needs
  bool shapes = true;  ///< fields too
  bool verify = true;  ///< count by inertia
  void validate() const;
};

struct Mode {
  double omega = 0.0;
  double odd_share = 0.0;  ///< of V (W out of plane), in the sense of `Mirror`
  ModeKind kind = ModeKind::symmetric;
  double elastic_share = 0.0;  ///< of the potential energy that is in stretching
  double modal_mass = 0.0;     ///< int (U^2 + V^2) c dx at the scale of the field [mu a]
  Field<double> field;         ///< empty without `shapes`
};

struct ModeSet {
  std::vector<Mode> modes;
  int functions = 0;
  double tail = 0.0;      ///< last coefficients of the highest mode, relative
  bool resolved = false;  ///< tail small enough
  int counted = 0;        ///< frequencies below `counted_below` in the finer discretisation; 0 without `verify`
  int expected = 0;       ///< the same from the list
  double counted_below = 0.0;
  bool complete() const { return resolved && counted == expected; }
};

ModeSet in_plane_modes(const CoreCable& cable, const ModeOptions& options = {});
ModeSet out_of_plane_modes(const CoreCable& cable, const ModeOptions& options = {});

/// A damped mode exp(lambda t), Im lambda >= 0, the frequency of oscillation increasing.
struct DampedMode {
  std::complex<double> lambda;
  double odd_share = 0.0;
  Field<std::complex<double>> field;  ///< largest displacement 1
};

/// Oscillating modes in plane, the `count` of lowest frequency, as far as a discretisation half as fine again leaves them where they are; roots
/// whose drag leaves no oscillation, that stay in place too, are in `overdamped`.
struct DampedSet {
  std::vector<DampedMode> modes;
  std::vector<double> overdamped;  ///< real lambda, slowest decay first
  int functions = 0;
  bool resolved = false;  ///< all modes asked for, or all there are, are listed
};
DampedSet damped_modes(const CoreCable& cable, const ModeOptions& options = {});
/// Which damped mode an undamped one becomes: the one of most alike shape, -1 where none has half of it in common. Both with shapes.
std::vector<int> partners(const std::vector<Mode>& modes, const std::vector<DampedMode>& damped);
/// Out of plane L3 = lambda^2 + eta3 lambda = -w^2 with the undamped w: both roots in closed form, that with Im lambda >= 0.
std::complex<double> damped_root(double omega, double eta);

}  // namespace whirl::models::catenary
