#pragma once
/// A hanging cable in SI units and the dimensionless numbers its motion depends on.
///
///     H = mu g a,   kappa = H/EA,   frequency unit sqrt(g/a),   eta_i = (drag_i / mu) sqrt(a/g)              [Gale1976, eqs (2.28)]
///     lambda^2 = (b/a)^2 (b/Le) / kappa,  Le = int (ds/dx)^3 dx                                              [IrvineCaughey1974, eq. (19)]
///
/// The shape is that of the inextensible cable of the given length; static stretch, of order kappa, is left out: for a soft cable give the stretched
/// length, or the sag.
///
///     HangingCable cable{.shape = geometry({.span = 100.0, .height = 20.0, .length = 130.0}), .mass_per_length = 10.0, .axial_stiffness = 1e7};
///     ModeSet modes = in_plane_modes(core_of(cable));
///     double hertz = modes.modes[0].omega * frequency_unit(cable) / (2.0 * pi);

#include <limits>

#include "models/catenary/geometry.hpp"
#include "models/catenary/modes.hpp"

namespace whirl::models::catenary {

struct HangingCable {
  Geometry shape;
  double mass_per_length;                                               ///< mu [kg/m]
  double gravity = 9.81;                                                ///< [m/s^2]
  double axial_stiffness = std::numeric_limits<double>::infinity();     ///< EA [N]; infinite: inextensible
  double drag_tangential = 0.0, drag_normal = 0.0, drag_lateral = 0.0;  ///< force per length and velocity [N s/m^2]
};

double horizontal_tension(const HangingCable& cable);  ///< H [N]
double frequency_unit(const HangingCable& cable);      ///< sqrt(g/a) [rad/s]
/// Throws std::invalid_argument for a mass, gravity or stiffness that is not positive or a negative drag.
CoreCable core_of(const HangingCable& cable);

double irvine_lambda2(const Geometry& shape, double kappa);

/// Rayleigh's estimate of the first frequency out of plane, the cable swinging about its chord like a rigid wire, in sqrt(g/a). z is the distance
/// from the chord and gravity acts across it by its part b/sqrt(b^2 + h^2), which [Gale1976, app. B-5] leaves out:
///
///     w^2 = a (b / sqrt(b^2 + h^2)) int z ds / int z^2 ds
double pendulum_estimate(const Geometry& shape);

}  // namespace whirl::models::catenary
