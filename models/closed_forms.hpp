#pragma once
/// All steady states of the superharmonic slow flow at one parameter record, [NielsenKirkegaard2002, eqs (50)-(58)]: roots of polynomials, polished
/// by Newton on the flow itself, next to folds those nearly real too. They seed every branch, also one that nothing else leads to.
///
/// In plane (A = 0): |(D2 + g4 y) + i d2|^2 y = P^2, a cubic in y = B^2.                                                      (51)
/// Coupled: sin 2Phi = k/y, k = d1/g2, and y cos 2Phi = +- sqrt(y^2 - k^2). With y = (k/2)(t + 1/t), y cos 2Phi = (k/2)(t - 1/t), t > 0
/// (t > 1: phase motion, t < 1: whirling), A^2 = -(D1 + g2 (2 y + y cos 2Phi)) / g1 and the squared balance of q2 is a polynomial of
/// degree 8 in t, in place of the iteration of (56)-(57):
///
///     [ d2 y + g3 k A^2 ]^2 + [ D2 y + g4 y^2 + g3 (2 y + y cos 2Phi) A^2 ]^2 = P^2 y
///
/// d_a = 2 z_a w_a n w. Undamped out-of-plane motion (k = 0) is taken in the limit: sin 2Phi = 0, cos 2Phi = +-1, a cubic in y each.

#include <vector>

#include "models/superharmonic.hpp"

namespace whirl::models {

/// States (u1, v1, u2, v2); of each mirror pair +-(u1, v1) one.
std::vector<Eigen::Vector4d> in_plane_states(const SlowFlowCoefficients<double>& c);
std::vector<Eigen::Vector4d> coupled_states(const SlowFlowCoefficients<double>& c);

}  // namespace whirl::models
