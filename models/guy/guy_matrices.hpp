#pragma once
/// Stiffness and mass of a stretch of a guy about its exact static state, in hierarchical polynomials of the unstretched arc s:
///
///     (D u')' + m p_e^2 u = 0,   D = AE e e^T + b (I - e e^T),   b = T/(1 + T/AE)  (also the out-of-plane stiffness)
///
/// One scalar function set for all components: j = 0 rises to 1 at the upper end, j = 1 ... degree - 1 vanish at both, j = degree falls from 1 at the
/// lower end. The in-plane matrix is 2 x 2 blocks xx, xy, yx, yy of size degree + 1. Used by LinearGuy (one stretch) and by the mode count (many).
///
///     const GuyMatrices m(rest, 0.0, rest.unstressed_length, 48);

#include <Eigen/Core>

#include "models/guy/statics.hpp"

namespace whirl::models::guy {

struct GuyMatrices {
  GuyMatrices(const Statics& exact, double from, double to, int degree);
  Eigen::MatrixXd in_plane;      ///< 2 (degree + 1) square [N/m]
  Eigen::MatrixXd out_of_plane;  ///< degree + 1 square [N/m]
  Eigen::MatrixXd mass;          ///< degree + 1 square, of one component [kg]
};

/// Coefficients at unstretched arc s.
struct LocalStiffness {
  double xx, xy, yy, b;  ///< of D, and the transverse stiffness [N]
};
LocalStiffness local_stiffness(const Statics& exact, double s);

/// 1/rho-decay of Legendre coefficients of the tension on [0, L0]: degree that resolves it to rounding. Large for slack guys.
int degree_of_tension(const Statics& exact);

/// Time a transverse wave takes from end to end, int ds / sqrt(b/m) [s].
double travel_time(const Statics& exact);

/// Throws std::invalid_argument for a state of the first-order form.
void require_exact(const Statics& state, const char* who);

}  // namespace whirl::models::guy
