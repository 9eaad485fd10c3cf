#include "models/catenary/gale_series.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

#include "models/catenary/geometry.hpp"
#include "models/catenary/modes.hpp"

namespace whirl::models::catenary {
namespace {

// A series and its z-derivatives at one point, summed until nothing more counts.
struct Sums {
  std::array<double, 4> derivative{};  // 0 ... 3
  double root_z_slope = 0.0;           // sqrt(z) times the first derivative, finite at z = 0
  double lost = 0.0;                   // digits
  int terms = 0;
};

// sum of a_k t^(k + r) with its derivatives; `next(k)` gives a_k in turn, a_0 first.
template <class Next>
Sums sum_series(double t, double r, int max_terms, Next&& next) {
  Sums s;
  std::array<double, 4> largest{};
  int quiet = 0;
  for (int k = 0; k < max_terms && quiet < 6; ++k) {
    const double a = next(k), m = k + r;
    double factor = 1.0;
    bool counts = k < 8;
    for (int d = 0; d < 4; ++d) {
      const double term = factor == 0.0 ? 0.0 : a * factor * std::pow(t, m - d);
      auto& sum = s.derivative[std::size_t(d)];
      auto& top = largest[std::size_t(d)];
      if (std::isfinite(term)) {
        sum += term;
        top = std::max(top, std::abs(term));
        counts = counts || std::abs(term) > 1e-18 * top;
      }
      factor *= m - d;
    }
    if (m != 0.0) s.root_z_slope += a * m * (t >= 0.0 ? std::pow(t, m - 0.5) : 0.0);
    quiet = counts ? 0 : quiet + 1;
    s.terms = k + 1;
  }
  if (quiet < 6) s.terms = max_terms + 1;  // did not converge
  // What cancels, against the size of the motion and its slope together: the value alone may be near a zero.
  const double here = std::abs(s.derivative[0]) + std::abs(t * s.derivative[1]) / (1.0 + largest[1] / std::max(largest[0], 1e-300) * std::abs(t));
  s.lost = std::log10(std::max(1.0, largest[0] / std::max(here, 1e-300)));
  return s;
}

// About xi = 0, in plane, exponent r.
Sums near_apex(double z, double r, double W, int max_terms) {
  std::array<double, 5> a{};  // a_k at k mod 5
  return sum_series(z, r, max_terms, [&](int k) {
    const double m = k + r;
    const auto at = [&](int j) { return k >= j ? a[std::size_t((k - j) % 5)] : 0.0; };
    double value = 1.0;
    if (k >= 1) value = -(4.0 * m * m - 7.0 * m + 4.0 + W) / (m * (2.0 * m - 1.0)) * at(1);
    if (k >= 2) {
      const double D = m * (2.0 * m - 1.0) * (2.0 * m - 3.0);
      value -= (((m - 2.0) * (5.0 * m * m - 15.0 * m + 12.0) + W * (5.0 * m - 11.0)) * at(2) + (m - 3.0) * ((m - 2.0) * (m - 2.0) + 4.0 * W) * at(3) +
                W * (m - 4.0) * at(4)) /
               D;
    }
    return a[std::size_t(k % 5)] = value;
  });
}

// About xi = 2, in plane: b_i = 1 for one i < 4.
Sums near_two(double z, int i, double W, int max_terms) {
  std::array<double, 7> b{};
  return sum_series(z - 2.0, 0.0, max_terms, [&](int k) {
    const double m = k;
    const auto at = [&](int j) { return k >= j ? b[std::size_t((k - j) % 7)] : 0.0; };
    double value = k == i ? 1.0 : 0.0;
    if (k >= 4) {
      const double m1 = m - 1.0, m2 = m - 2.0, m3 = m - 3.0, m4 = m - 4.0;
      value = 16.0 * m1 * m2 * m3 * (22.0 * m - 45.0) * at(1) + 3.0 * m2 * m3 * (84.0 * m * m - 424.0 * m + 547.0 + 24.0 * W) * at(2) +
              m3 * (88.0 * m * m * m - 794.0 * m * m + 2405.0 * m - 2446.0 + W * (102.0 * m - 309.0)) * at(3) +
              m3 * (15.0 * m * m * m - 165.0 * m * m + 606.0 * m - 744.0 + W * (53.0 * m - 213.0)) * at(4) +
              m3 * (m - 5.0) * (m4 * m4 + 12.0 * W) * at(5) + W * m3 * (m - 6.0) * at(6);
      value /= -192.0 * m * m1 * m2 * m3;
    }
    return b[std::size_t(k % 7)] = value;
  });
}

Sums lateral_near_apex(double z, double r, double W, int max_terms) {
  std::array<double, 3> e{};
  return sum_series(z, r, max_terms, [&](int k) {
    const double m = k + r;
    double value = 1.0;
    if (k >= 1)
      value = -(((m - 1.0) * (m - 1.0) + W) * e[std::size_t((k + 2) % 3)] + (k >= 2 ? W * e[std::size_t((k + 1) % 3)] : 0.0)) / (m * (2.0 * m - 1.0));
    return e[std::size_t(k % 3)] = value;
  });
}

Sums lateral_near_two(double z, int i, double W, int max_terms) {
  std::array<double, 4> f{};
  return sum_series(z - 2.0, 0.0, max_terms, [&](int k) {
    const double m = k;
    const auto at = [&](int j) { return k >= j ? f[std::size_t((k - j) % 4)] : 0.0; };
    double value = k == i ? 1.0 : 0.0;
    if (k >= 2) value = -(3.0 * (m - 1.0) * (2.0 * m - 3.0) * at(1) + ((m - 2.0) * (m - 2.0) + 3.0 * W) * at(2) + W * at(3)) / (8.0 * m * (m - 1.0));
    return f[std::size_t(k % 4)] = value;
  });
}

// Rows of end conditions for one end, linear in the constants of the apex series.
class Conditions {
 public:
  Conditions(double W, Plane plane, const SeriesOptions& o) : W_(W), lateral_(plane == Plane::out_of_plane), n_(lateral_ ? 2 : 4), o_(o) {}

  // U and V/(S q / sqrt z ...) at x (positive factors left out), or W alone; n/2 rows.
  Matrix at_end(double x) {
    const double z = std::abs(xi_of(x)), match = lateral_ ? o_.match_out_of_plane : o_.match_in_plane;
    Matrix rows(n_ / 2, n_);
    if (z <= match) {
      for (int j = 0; j < n_; ++j) fill(rows, j, note(apex(z, j)));
    } else {
      Matrix here(n_, n_), there(n_, n_), far(n_ / 2, n_);
      for (int j = 0; j < n_; ++j) {
        const Sums a = note(apex(match, j)), b = note(two(match, j)), e = note(two(z, j));
        for (int d = 0; d < n_; ++d) {
          here(d, j) = a.derivative[std::size_t(d)];
          there(d, j) = b.derivative[std::size_t(d)];
        }
        far(0, j) = e.derivative[0];
        if (!lateral_) far(1, j) = e.derivative[1];
      }
      rows = far * there.partialPivLu().solve(here);
    }
    if (x < 0.0)  // series of half order are odd in x; V has the sign of xi
      for (int j = 1; j < n_; j += 2) rows.col(j) *= -1.0;
    return rows;
  }
  double lost = 0.0;
  int terms = 0;

 private:
  Sums apex(double z, int j) const { return lateral_ ? lateral_near_apex(z, 0.5 * j, W_, o_.max_terms) : near_apex(z, 0.5 * j, W_, o_.max_terms); }
  Sums two(double z, int j) const { return lateral_ ? lateral_near_two(z, j, W_, o_.max_terms) : near_two(z, j, W_, o_.max_terms); }
  void fill(Matrix& rows, int j, const Sums& s) const {
    rows(0, j) = s.derivative[0];
    if (!lateral_) rows(1, j) = s.root_z_slope;
  }
  Sums note(const Sums& s) {
    lost = std::max(lost, s.lost);
    terms = std::max(terms, s.terms);
    return s;
  }

  double W_;
  bool lateral_;
  int n_;
  SeriesOptions o_;
};

void check_region(double x1, double x2, const SeriesOptions& o) {
  if (!(x1 < x2)) throw std::invalid_argument("the ends of a cable must satisfy x1 < x2");
  for (const double x : {x1, x2})
    if (!(std::abs(xi_of(x)) < 4.0))
      throw std::invalid_argument(
          fmt::format("the series method needs both ends within |xi| < 4, got xi = {:.6g}: use the spectral solver", xi_of(x)));
  if (!(o.match_in_plane > 0.0 && o.match_in_plane < 1.0 && o.match_out_of_plane > 0.0 && o.match_out_of_plane < 2.0))
    throw std::invalid_argument("matching points must lie within both radii of convergence: (0, 1) in plane, (0, 2) out of plane");
}

}  // namespace

SeriesDeterminant series_determinant(double x1, double x2, double omega, Plane plane, const SeriesOptions& o) {
  check_region(x1, x2, o);
  Conditions conditions(omega * omega, plane, o);
  const int n = plane == Plane::out_of_plane ? 2 : 4;
  Matrix d(n, n);
  d.topRows(n / 2) = conditions.at_end(x1);
  d.bottomRows(n / 2) = conditions.at_end(x2);
  if (conditions.terms > o.max_terms)
    throw std::invalid_argument(
        fmt::format("the series method does not converge in {} terms with an end at xi = {:.6g}: use the spectral solver", o.max_terms, xi_of(x2)));
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < n; ++i) d.row(i) /= std::max(d.row(i).norm(), 1e-300);
    for (int i = 0; i < n; ++i) d.col(i) /= std::max(d.col(i).norm(), 1e-300);
  }
  return {d.determinant(), conditions.lost, conditions.terms};
}

SeriesModes series_modes(double x1, double x2, int count, Plane plane, const SeriesOptions& o) {
  check_region(x1, x2, o);
  const CoreCable cable{.x1 = x1, .x2 = x2};
  const ModeOptions wanted{.count = count + 1, .shapes = false};
  const ModeSet set = plane == Plane::in_plane ? in_plane_modes(cable, wanted) : out_of_plane_modes(cable, wanted);
  SeriesModes result;
  for (int k = 0; k < count; ++k) result.spectral.push_back(set.modes[std::size_t(k)].omega);
  const auto determinant = [&](double w) {
    const SeriesDeterminant d = series_determinant(x1, x2, w, plane, o);
    result.terms = std::max(result.terms, d.terms);
    return d.value;
  };
  constexpr int parts = 6;
  for (int k = 0; k < count; ++k) {
    const double here = set.modes[std::size_t(k)].omega, upper = 0.5 * (here + set.modes[std::size_t(k) + 1].omega);
    const double lower = k == 0 ? 0.5 * here : 0.5 * (here + set.modes[std::size_t(k) - 1].omega);
    if (series_determinant(x1, x2, here, plane, o).digits_lost > o.max_digits_lost) {
      result.refused = count - k;
      break;
    }
    double last = determinant(lower), from = 0.0, to = 0.0, f_from = 0.0, f_to = 0.0;
    int changes = 0;
    for (int i = 1; i <= parts; ++i) {
      const double w = lower + (upper - lower) * i / parts, value = determinant(w);
      if (value * last < 0.0 && ++changes == 1) {
        from = lower + (upper - lower) * (i - 1) / parts;
        to = w;
        f_from = last;
        f_to = value;
      }
      last = value;
    }
    if (changes == 0) ++result.missing;
    if (changes > 1) result.spurious += changes - 1;
    if (changes != 1) continue;
    std::uintmax_t steps = 100;
    const auto root = boost::math::tools::toms748_solve(determinant, from, to, f_from, f_to, boost::math::tools::eps_tolerance<double>(48), steps);
    result.omega.push_back(0.5 * (root.first + root.second));
    result.digits_lost.push_back(series_determinant(x1, x2, result.omega.back(), plane, o).digits_lost);
  }
  return result;
}

double SeriesModes::worst_difference() const {
  if (!agrees()) return std::numeric_limits<double>::infinity();
  double worst = 0.0;
  for (std::size_t k = 0; k < omega.size(); ++k) worst = std::max(worst, std::abs(omega[k] / spectral[k] - 1.0));
  return worst;
}

}  // namespace whirl::models::catenary
