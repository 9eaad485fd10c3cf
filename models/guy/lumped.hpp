#pragma once
/// Two static constructions of a chain of lumped masses that stands for a guy, [Sarvi1968, ch. VI].
///
/// `funicular_polygon`: the stretched catenary is cut into n equal arcs; the weight of each hangs where the tangents at its ends meet (6.1)-(6.18).
/// Its lines carry the catenary's tensions; the polygon is longer than the cable.
///
/// `hung_masses`: n weights W_i on a weightless line of given segments l_0 ... l_n between the ends (6.19)-(6.23). Horizontal tension H and the lower
/// vertical force V minimise the convex complementary energy, whose gradient is (6.23):
///
///     Phi(H, V) = sum l_i (T_i + T_i^2/2AE) - H l - V h,   T_i = hypot(H, V + W_1 + ... + W_i)
///
/// so with V balanced for each H its slope is monotone in H, and bracketing finds the only solution. Segments may stretch. Throws
/// std::invalid_argument for fewer than one mass, weights or segments that are not positive, and an inextensible line shorter than the chord;
/// std::runtime_error if a line would hang slack.
///
///     const Polygon p = hung_masses(guy, std::vector(6, L/6), std::vector(5, w*L/6));
///     p.horizontal_tension, p.x[3], p.tension[0]

#include <limits>
#include <vector>

#include "models/guy/statics.hpp"

namespace whirl::models::guy {

struct Polygon {
  double horizontal_tension = 0.0;     ///< H [N]
  std::vector<double> slope = {};      ///< tan gamma_i of line i, n + 1
  std::vector<double> tension = {};    ///< of line i, n + 1 [N]
  std::vector<double> length = {};     ///< of line i, stretched, n + 1 [m]
  std::vector<double> x = {}, y = {};  ///< lower end, masses, upper end, n + 2 [m]
  std::vector<double> weight = {};     ///< of the masses, n [N]
};

[[nodiscard]] Polygon funicular_polygon(const Statics& first_order, int n);

[[nodiscard]] Polygon hung_masses(const Guy& guy, const std::vector<double>& segments, const std::vector<double>& weights,
                                  double axial_stiffness = std::numeric_limits<double>::infinity());

/// n masses of weight w L/(n + 1) on n + 1 equal segments of the stretched length L: the ends carry the rest.
[[nodiscard]] Polygon equal_hung_masses(const Statics& first_order, int n);

}  // namespace whirl::models::guy
