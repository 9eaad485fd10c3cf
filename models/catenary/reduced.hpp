#pragma once
/// A few catenary modes as a nonlinear model with constant coefficients: any sag, level or inclined, stiff or soft.
///
/// Projection on the modes alone locks: it keeps the cable from sliding along itself, and its quartic energy grows as EA/H. So what the kept modes xi
/// drive in all others is let follow without inertia (static condensation, to the order that a quartic energy needs). With nodal fields of
/// galerkin.hpp, e = U_x - V/c, N = V_x + U/c, G = (N^2 + W_x^2)/(2 c), h = 1/(kappa c) - 1:
///
///     V  = 1/2 sum w^2 xi^2 + V3 + V4 - 1/2 F' Kr^-1 F - 1/2 FW' KWr^-1 FW
///     V3 = int h e G dx,   V4 = 1/2 int h G^2 dx                              strains of order G, rotations of order 1: terms e^2 G, O(kappa), left
///     out F  = dV3/dq over all functions in plane, FW the same out of plane: quadratic in xi Kr^-1 = K^-1 - sum of kept phi phi'/w^2
///
/// The energy stays finite as kappa -> 0. Modes left out must be fast against twice the frequencies of motion: keep those in plane up to there.
///
///     ReducedModel r = reduced_model({.x1 = g.x1, .x2 = g.x2, .kappa = 1e-4}, {.out_of_plane = 1, .in_plane = 3});
///     ModalModel m = in_si_units(r, cable);                 // q_i [m]: the largest displacement of mode i; out of plane first
///
/// Throws std::invalid_argument for kappa = 0 (1e-7 stands for an inextensible cable), no mode at all or more than 12.

#include "models/catenary/cable.hpp"
#include "models/modal_model.hpp"

namespace whirl::models::catenary {

struct ReducedOptions {
  int out_of_plane = 1, in_plane = 2;  ///< the lowest so many
};

/// Energy sum coefficient xi^powers over coordinates xi: largest displacements in a; modes out of plane first, then in plane.
struct Monomial {
  std::vector<int> powers;
  double coefficient;
};

struct ReducedModel {
  int out_of_plane = 0, in_plane = 0;
  Vector tangential_share;                                   ///< of the kinetic energy
  Vector omega, mass;                                        ///< sqrt(g/a); int (U^2 + V^2 + W^2) c dx at largest displacement 1
  std::vector<Monomial> energy;                              ///< cubic and quartic part of V
  std::vector<Monomial> direct;                              ///< the quartic part of projection alone, for comparison
  double first_left_out = 0.0;                               ///< lowest frequency in plane of the modes that follow without inertia [sqrt(g/a)]
  double coefficient(const std::vector<int>& powers) const;  ///< of `energy`, 0 if absent
};

ReducedModel reduced_model(const CoreCable& cable, const ReducedOptions& options = {});

/// Equations of motion q_i'' + w_i^2 q_i + (1/m_i) dV/dq_i = 0 in metres and seconds; drag by its work on each mode alone.
ModalModel in_si_units(const ReducedModel& model, const HangingCable& cable);

/// omega = w (1 + curvature A^2) of one coordinate moving alone at first order, from the model's own coefficients (Lindstedt-Poincare).
double backbone_curvature(const ReducedModel& model, int coordinate);

}  // namespace whirl::models::catenary
