#include "models/shallow/modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <stdexcept>

namespace whirl::models::shallow {

using std::numbers::pi;

// g = lambda2 (sin x - x cos x) + 4 x^3 cos x has no pole and one root in each interval; scaled so that both limits of lambda2 are finite.
double symmetric_root(double lambda2, int n) {
  if (!(lambda2 >= 0.0)) throw std::invalid_argument(fmt::format("lambda2 must be >= 0, got {}", lambda2));
  if (n < 1) throw std::invalid_argument(fmt::format("the order of a mode starts at 1, got {}", n));
  const double left = (n - 0.5) * pi, right = (n + 0.5) * pi;
  const bool inextensible = std::isinf(lambda2);
  const double a = inextensible ? 1.0 : lambda2 / (1.0 + lambda2), c = inextensible ? 0.0 : 4.0 / (1.0 + lambda2);
  // Next to the taut string the root lies this far from the end of its interval, up to left * beyond^2.
  const double beyond = lambda2 / (4.0 * left * left * left);
  if (beyond < 1e-9) return 2.0 * (left + beyond);
  const double sign = n % 2 == 1 ? 1.0 : -1.0;
  const auto g = [&](double x) { return sign * (a * (std::sin(x) - x * std::cos(x)) + c * x * x * x * std::cos(x)); };
  boost::uintmax_t iterations = 200;
  const auto [lo, hi] = boost::math::tools::toms748_solve(g, left, right, boost::math::tools::eps_tolerance<double>(52), iterations);
  return lo + hi;
}

double cross_over(int n) { return 4.0 * n * n * pi * pi; }

const char* to_string(Family family) {
  switch (family) {
    case Family::out_of_plane:
      return "out of plane";
    case Family::symmetric:
      return "symmetric";
    case Family::antisymmetric:
      return "antisymmetric";
  }
  return "";
}

ModeShape::ModeShape(const Statics& s, const Cable<double>& cable, Family family, int order) : family_(family), order_(order), ratio_(s.sag_ratio) {
  if (order < 1) throw std::invalid_argument(fmt::format("the order of a mode starts at 1, got {}", order));
  b_ = family == Family::symmetric ? symmetric_root(s.lambda2, order) : (family == Family::antisymmetric ? 2.0 : 1.0) * order * pi;
  omega_ = b_ / cable.chord_length * std::sqrt(cable.chord_tension / cable.mass_per_length);
  half_cos_ = std::cos(0.5 * b_);
  half_sin_ = std::sin(0.5 * b_);
  divisor_ = (order % 2 == 1 ? 1.0 : -1.0) - half_cos_;
  if (family == Family::symmetric) {
    mean_ = (2.0 * half_sin_ / b_ - half_cos_) / divisor_;
    square_ = (0.5 + half_cos_ * half_cos_ - 3.0 * half_sin_ * half_cos_ / b_) / (divisor_ * divisor_);
  } else {
    const bool even = family == Family::antisymmetric || order % 2 == 0;
    mean_ = even ? 0.0 : 2.0 / (order * pi);
    square_ = 0.5;
  }
  tension_ = family == Family::symmetric ? cable.axial_stiffness / s.effective_length * 8.0 * ratio_ * mean_ : 0.0;
  strain_ = tension_ * cable.chord_length / cable.axial_stiffness;
}

int ModeShape::half_waves() const {
  switch (family_) {
    case Family::out_of_plane:
      return order_;
    case Family::symmetric:
      return 2 * order_ - 1;
    case Family::antisymmetric:
      return 2 * order_;
  }
  return 0;
}

std::string ModeShape::name() const { return fmt::format("{}{}", family_ == Family::out_of_plane ? 'y' : 'z', half_waves()); }

// cos t = cos(b/2) for |t| < b/2: t = b/2 - 2 pi k and 2 pi k - b/2, one pair +-t for each whole k with 2 pi k < b. A root of b at a
// cross-over is known to rounding only: there the pair stands at the supports, which is no internal node.
int ModeShape::internal_nodes() const {
  if (family_ != Family::symmetric) return half_waves() - 1;
  return 2 * static_cast<int>(std::ceil(b_ / (2.0 * pi) - 1e-12) - 1.0);
}

std::vector<ModeShape> lowest_modes(const Cable<double>& cable, int count) {
  const Statics s = statics(cable);
  std::vector<ModeShape> modes, in_plane;
  for (int n = 1; n <= count; ++n) {
    modes.emplace_back(s, cable, Family::out_of_plane, n);
    in_plane.emplace_back(s, cable, Family::symmetric, n);
    in_plane.emplace_back(s, cable, Family::antisymmetric, n);
  }
  std::stable_sort(in_plane.begin(), in_plane.end(), [](const auto& a, const auto& b) { return a.omega() < b.omega(); });
  modes.insert(modes.end(), in_plane.begin(), in_plane.begin() + count);
  return modes;
}

}  // namespace whirl::models::shallow
