#include "models/guy/group.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "models/guy/tangent.hpp"

namespace whirl::models::guy {

Group equal_group(const Statics& rest, int n, double first) {
  if (n < 1) throw std::invalid_argument(fmt::format("guy group: number of guys must be >= 1, got {}", n));
  Group group;
  for (int j = 0; j < n; ++j) group.push_back({rest, first + 2.0 * std::numbers::pi * j / n});
  return group;
}

// In the frame (along, across) of the displacement, the anchor of guy j lies at l_j (cos b, sin b), b = a_j - t.
Reaction reaction(const Group& group, double displacement, double direction, GroupTerms terms) {
  if (group.empty()) throw std::invalid_argument("guy group: needs a guy");
  Reaction sum{0.0, 0.0, 0.0, std::numeric_limits<double>::infinity()};
  for (const auto& [rest, azimuth] : group) {
    const double b = azimuth - direction, l = rest.guy.horizontal_span;
    double x = l * std::cos(b), y = l * std::sin(b), span = 0.0;
    if (terms == GroupTerms::axial) {
      span = l - displacement * std::cos(b);
      x = std::cos(b), y = std::sin(b);
    } else {
      span = std::hypot(x - displacement, y);
      x = (x - displacement) / span, y /= span;
    }
    Guy moved = rest.guy;
    moved.horizontal_span = span;
    const Statics s = solve(moved, Known::unstressed_length, rest.unstressed_length, rest.form);
    sum.along -= s.horizontal_tension * x;
    sum.across -= s.horizontal_tension * y;
    sum.largest_tension = std::max(sum.largest_tension, s.upper_tension);
    sum.smallest_tension = std::min(sum.smallest_tension, s.upper_tension);
  }
  return sum;
}

double group_modulus(const Group& group, double direction, GroupTerms terms) {
  if (group.empty()) throw std::invalid_argument("guy group: needs a guy");
  double sum = 0.0;
  for (const auto& [rest, azimuth] : group) {
    const double c = std::cos(azimuth - direction), s = std::sin(azimuth - direction);
    sum += horizontal_modulus(rest) * c * c;
    if (terms == GroupTerms::full_geometry) sum += rest.horizontal_tension / rest.guy.horizontal_span * s * s;
  }
  return sum;
}

}  // namespace whirl::models::guy
