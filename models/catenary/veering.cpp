#include "models/catenary/veering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

#include <tuple>

#include "core/parallel.hpp"
#include "core/symmetric_pencil.hpp"

namespace whirl::models::catenary {
namespace {

// Frequencies and their slopes d ln w / ds, by parity where the cable is level.
struct Spectrum {
  Vector omega, slope;
};

Spectrum spectrum(const InPlaneGalerkin& g, double kappa, Parity parity, int count) {
  const auto i = g.indices(kappa, parity);
  const PencilModes modes = lowest_modes(pick(g.stiffness(kappa), i), pick(g.mass(kappa), i), count);
  const Matrix K1 = pick(g.stiffness_slope(kappa), i), M1 = pick(g.mass_slope(kappa), i);
  Spectrum s{modes.omega, Vector(modes.omega.size())};
  for (Eigen::Index k = 0; k < s.omega.size(); ++k) {
    const double w2 = s.omega[k] * s.omega[k];
    const auto q = modes.vectors.col(k);
    s.slope[k] = q.dot(K1 * q - w2 * (M1 * q)) / (2.0 * w2);
  }
  return s;
}

template <class F>
std::pair<double, double> bracket(F&& f, double lower, double upper, double fl, double fu) {
  std::uintmax_t steps = 100;
  return boost::math::tools::toms748_solve(f, lower, upper, fl, fu, boost::math::tools::eps_tolerance<double>(44), steps);
}

}  // namespace

int functions_for_range(double x1, double x2, double kappa_lower, double kappa_upper, int modes) {
  return std::max(functions_for({.x1 = x1, .x2 = x2, .kappa = kappa_lower}, modes), functions_for({.x1 = x1, .x2 = x2, .kappa = kappa_upper}, modes));
}

FrequencyCurve::FrequencyCurve(double x1, double x2, int functions, double reference_omega)
    : Problem(2 * functions + 2, 1, false), g_(x1, x2, functions), reference_(reference_omega) {
  name_parameters({"sqrt_flexibility"});
  offer_derivatives(3);
  K2_ = g_.stiffness_slope(1.0, 2);
  M2_ = reference_ * reference_ * g_.mass_slope(1.0, 2);
  if (std::abs(x1 + x2) < 1e-14 * (x2 - x1)) {
    Vector signs = Vector::Ones(size());
    for (const int i : g_.indices(1.0, Parity::antisymmetric)) signs[i] = -1.0;
    add_reflection({signs, "X"});
    signs.head(size() - 1) *= -1.0;  // leaves antisymmetric modes in place
    add_reflection({signs, "X"});
  }
}

void FrequencyCurve::update(double s) const {
  if (s == s_) return;
  const double kappa = std::max(s * s, 1e-300), w2 = reference_ * reference_;
  K_ = g_.stiffness(kappa);
  M_ = w2 * g_.mass(kappa);
  K1_ = g_.stiffness_slope(kappa);
  M1_ = w2 * g_.mass_slope(kappa);
  s_ = s;
}

Vector FrequencyCurve::start(double kappa, int mode, Parity parity) const {
  const auto i = g_.indices(kappa, parity);
  const PencilModes modes = lowest_modes(pick(g_.stiffness(kappa), i), pick(g_.mass(kappa), i), mode);
  if (mode < 1 || modes.omega.size() < mode) throw std::invalid_argument(fmt::format("there is no mode {}", mode));
  Vector u = Vector::Zero(size() + 1);
  for (std::size_t k = 0; k < i.size(); ++k) u[i[k]] = modes.vectors(Eigen::Index(k), mode - 1);
  u.head(size() - 1).normalize();
  const double ratio = modes.omega[mode - 1] / reference_;
  u[size() - 1] = ratio * ratio;
  u[size()] = std::sqrt(kappa);
  return u;
}

void FrequencyCurve::do_residual(In u, Out r) const {
  const int n = size() - 1;
  update(u[n + 1]);
  const auto q = u.head(n);
  r.head(n).noalias() = K_ * q;
  r.head(n).noalias() -= u[n] * (M_ * q);
  r[n] = 0.5 * (q.squaredNorm() - 1.0);
}

void FrequencyCurve::do_jacobian(In u, MatrixOut j) const {
  const int n = size() - 1;
  update(u[n + 1]);
  const auto q = u.head(n);
  j.topLeftCorner(n, n) = K_ - u[n] * M_;
  j.col(n).head(n) = -M_ * q;
  j.col(n + 1).head(n) = K1_ * q - u[n] * (M1_ * q);
  j.row(n).setZero();
  j.row(n).head(n) = q.transpose();
}

void FrequencyCurve::do_second(In u, In v, MatrixOut h) const {
  const int n = size() - 1;
  update(u[n + 1]);
  const auto q = u.head(n), vq = v.head(n);
  const double vn = v[n], vs = v[n + 1];
  h.topLeftCorner(n, n) = vs * (K1_ - u[n] * M1_) - vn * M_;
  h.col(n).head(n) = -M_ * vq - vs * (M1_ * q);
  h.col(n + 1).head(n) = K1_ * vq - u[n] * (M1_ * vq) + vs * (K2_ * q - u[n] * (M2_ * q)) - vn * (M1_ * q);
  h.row(n).setZero();
  h.row(n).head(n) = vq.transpose();
}

void FrequencyCurve::do_third(In u, In a, In b, In c, Out t) const {
  const int n = size() - 1;
  update(u[n + 1]);
  t.setZero();
  const auto term = [&](In x, In y, In z) {  // x in q, y and z in (nu, s)
    const double ss = y[n + 1] * z[n + 1], ns = y[n] * z[n + 1] + y[n + 1] * z[n];
    t.head(n) += ss * (K2_ * x.head(n) - u[n] * (M2_ * x.head(n))) - ns * (M1_ * x.head(n));
  };
  term(a, b, c);
  term(b, a, c);
  term(c, a, b);
  const double nss = a[n] * b[n + 1] * c[n + 1] + b[n] * a[n + 1] * c[n + 1] + c[n] * a[n + 1] * b[n + 1];
  t.head(n) -= nss * (M2_ * u.head(n));
}

FrequencyFan frequency_fan(double x1, double x2, const Vector& kappa, int count) {
  FrequencyFan fan{kappa, Matrix(kappa.size(), count), Matrix(kappa.size(), count), true};
  std::atomic<bool> resolved{true};
  parallel_for(static_cast<std::size_t>(kappa.size()), [&](std::size_t k) {
    const auto i = static_cast<Eigen::Index>(k);
    const ModeSet set = in_plane_modes({.x1 = x1, .x2 = x2, .kappa = kappa[i]}, {.count = count, .verify = false});
    if (!set.resolved) resolved = false;
    for (Eigen::Index j = 0; j < count; ++j) {
      fan.omega(i, j) = set.modes[static_cast<std::size_t>(j)].omega;
      fan.odd_share(i, j) = set.modes[static_cast<std::size_t>(j)].odd_share;
    }
  });
  fan.resolved = resolved;
  return fan;
}

namespace {

Approach described(double x1, double x2, int lower_mode, double s, double width, bool crossing) {
  const ModeSet set = in_plane_modes({.x1 = x1, .x2 = x2, .kappa = s * s}, {.count = lower_mode + 1, .verify = false});
  const Mode &a = set.modes[static_cast<std::size_t>(lower_mode) - 1], &b = set.modes[static_cast<std::size_t>(lower_mode)];
  return {lower_mode, s * s, a.omega, b.omega, 2.0 * (b.omega - a.omega) / (a.omega + b.omega), a.odd_share, b.odd_share, crossing, 2.0 * width / s};
}

// Level cable: symmetric frequency i and antisymmetric frequency j as functions of s meet between two scanned points.
void find_crossings(const InPlaneGalerkin& g, const Vector& s, int count, std::vector<Approach>& found) {
  std::vector<Spectrum> even, odd;
  for (const double value : s) {
    even.push_back(spectrum(g, value * value, Parity::symmetric, count));
    odd.push_back(spectrum(g, value * value, Parity::antisymmetric, count));
  }
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j)
      for (std::size_t k = 0; k + 1 < even.size(); ++k) {
        const auto difference = [&](const Spectrum& a, const Spectrum& b) { return std::log(a.omega[i] / b.omega[j]); };
        const double f0 = difference(even[k], odd[k]), f1 = difference(even[k + 1], odd[k + 1]);
        if (i + j + 2 > count || f0 * f1 >= 0.0) continue;
        const auto f = [&](double x) {
          return difference(spectrum(g, x * x, Parity::symmetric, i + 1), spectrum(g, x * x, Parity::antisymmetric, j + 1));
        };
        const auto [low, high] = bracket(f, s[Eigen::Index(k)], s[Eigen::Index(k) + 1], f0, f1);
        found.push_back(described(g.mesh().x1, g.mesh().x2, i + j + 1, 0.5 * (low + high), high - low, true));
      }
}

// One frequency among those of all parities, by its number within its own.
struct Level {
  double omega, slope;
  std::size_t parity;
  int index;
  bool same(const Level& other) const { return parity == other.parity && index == other.index; }
};

// The ratio of neighbours k, k + 1 has a least value where their slopes agree: searched between scanned points that have the same two there, for
// on a level cable modes of unlike parity change places.
void find_approaches(const InPlaneGalerkin& g, const Vector& s, int count, const std::vector<Parity>& parities, std::vector<Approach>& found) {
  std::vector<std::vector<Level>> at;
  for (const double value : s) {
    at.emplace_back();
    for (std::size_t p = 0; p < parities.size(); ++p) {
      const Spectrum z = spectrum(g, value * value, parities[p], count);
      for (Eigen::Index k = 0; k < z.omega.size(); ++k) at.back().push_back({z.omega[k], z.slope[k], p, static_cast<int>(k)});
    }
    std::sort(at.back().begin(), at.back().end(), [](const Level& x, const Level& y) { return x.omega < y.omega; });
  }
  for (std::size_t k = 0; k + 1 < static_cast<std::size_t>(count); ++k)
    for (std::size_t i = 0; i + 1 < at.size(); ++i) {
      const Level &lower = at[i][k], &upper = at[i][k + 1];
      if (!lower.same(at[i + 1][k]) || !upper.same(at[i + 1][k + 1])) continue;
      const double f0 = upper.slope - lower.slope, f1 = at[i + 1][k + 1].slope - at[i + 1][k].slope;
      if (!(f0 < 0.0 && f1 > 0.0)) continue;
      const auto slope_of = [&](const Level& l, double x) { return spectrum(g, x * x, parities[l.parity], l.index + 1).slope[l.index]; };
      const auto f = [&](double x) { return slope_of(upper, x) - slope_of(lower, x); };
      const auto [low, high] = bracket(f, s[Eigen::Index(i)], s[Eigen::Index(i) + 1], f0, f1);
      found.push_back(described(g.mesh().x1, g.mesh().x2, static_cast<int>(k) + 1, 0.5 * (low + high), high - low, false));
    }
}

}  // namespace

std::vector<Approach> closest_approaches(double x1, double x2, double kappa_lower, double kappa_upper, int count, int scan_points) {
  if (!(kappa_lower > 0.0 && kappa_lower < kappa_upper))
    throw std::invalid_argument(fmt::format("the range of kappa must be positive and increasing, got {:g} to {:g}", kappa_lower, kappa_upper));
  if (count < 2 || scan_points < 2) throw std::invalid_argument("closest approaches need at least two modes and two points");
  const Vector s = Vector::LinSpaced(scan_points, 0.5 * std::log(kappa_lower), 0.5 * std::log(kappa_upper)).array().exp();
  const InPlaneGalerkin g(x1, x2, functions_for_range(x1, x2, kappa_lower, kappa_upper, count) + 6);
  std::vector<Approach> found;
  if (std::abs(x1 + x2) < 1e-14 * (x2 - x1)) {
    find_crossings(g, s, count, found);
    find_approaches(g, s, count, {Parity::symmetric, Parity::antisymmetric}, found);
  } else {
    find_approaches(g, s, count, {Parity::both}, found);
  }
  std::sort(found.begin(), found.end(),
            [](const Approach& a, const Approach& b) { return std::tie(a.lower_mode, a.kappa) < std::tie(b.lower_mode, b.kappa); });
  return found;
}

}  // namespace whirl::models::catenary
