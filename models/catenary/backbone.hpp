#pragma once
/// How the frequency of a swing out of plane depends on its amplitude, to second order, for a hanging cable of any sag: catenary modes as a basis.
///
/// With W = A phi(x) cos(w t) the cable is stretched by G = phi_x^2 / (2 c) times A^2 cos^2, at 0 and 2 w; the motion in plane that this drives, all
/// of it, is solved for in the discretisation of galerkin.hpp (Lindstedt-Poincare):
///
///     f_i = (1/kappa) int (U_x - V/c)_i G / c dx,     E = (1/2 kappa) int G^2 / c dx
///     omega^2 = w^2 + (A^2 / M) [3 E - f' K^-1 f - (1/2) f' (K - 4 w^2 M)^-1 f],      M = int phi^2 c dx
///
/// 3 E alone is the direct projection on the mode: it grows as 1/kappa, because a single mode cannot let the cable slide along itself. The bracket
/// stays finite. It is unbounded where 2 w is a natural frequency in plane (internal resonance): there the motion in plane is no longer small.
///
///     Backbone b = lateral_backbone(core, 1);
///     double omega = b.omega * (1.0 + b.curvature * A * A);      // A: largest displacement, in a
///
/// Throws std::invalid_argument for kappa = 0 (take 1e-7: the rest is the same to seven digits) or a mode that is not there.

#include "models/catenary/modes.hpp"

namespace whirl::models::catenary {

struct Backbone {
  double omega = 0.0;           ///< w at small amplitude [sqrt(g/a)]
  double curvature = 0.0;       ///< d omega / d A^2 over w, A the largest displacement in a; > 0 hardening
  double direct = 0.0;          ///< the same by direct projection on the mode
  Field<double> steady, twice;  ///< the motion in plane that goes with it, A^2 (steady + twice cos 2 w t): columns U, V [a] for A in a
  double detuning = 0.0;        ///< distance of 2 w to the nearest natural frequency in plane, relative: small means internal resonance
};

Backbone lateral_backbone(const CoreCable& cable, int mode);

}  // namespace whirl::models::catenary
