#include "continuation/chart.hpp"

#include <algorithm>
#include <cmath>

#include "core/orbit_problem.hpp"

namespace whirl::continuation {
namespace {

constexpr double chord_part = 5e-3;  // how far a cubic through four points of a walk is off its curve, over their distance
constexpr double rounding = 1e-7;    // of a located point, in units of the ranges
constexpr double same_way = 0.995;   // cosine between a curve and one through the same point that may cross it

// (x, p1, p2, frequency) in units of the curve's own extent and of the ranges.
Matrix scaled(const DefiningCurve& curve, const Vector& units) {
  Matrix z(curve.u.rows() + 1, curve.u.cols());
  z.topRows(curve.u.rows()) = units.head(curve.u.rows()).cwiseInverse().asDiagonal() * curve.u;
  z.bottomRows(1) = curve.frequency.transpose() / units[curve.u.rows()];
  return z;
}

Vector units_of(const DefiningCurve& curve, const TwoParameterOptions& options) {
  const auto rows = curve.u.rows();
  Vector units(rows + 1);
  const double x = curve.u.topRows(rows - 2).colwise().norm().maxCoeff(), frequency = curve.frequency.cwiseAbs().maxCoeff();
  units.setConstant(x > 0.0 ? x : 1.0);
  units[rows - 2] = options.range1[1] - options.range1[0];
  units[rows - 1] = options.range2[1] - options.range2[0];
  units[rows] = frequency > 0.0 ? frequency : 1.0;
  return units;
}

// Slope at node i per unit of chord, of the parabola through it and its neighbours.
Vector slope_at(const Matrix& z, Eigen::Index i) {
  const auto last = z.cols() - 1;
  const Eigen::Index a = i == 0 ? 0 : i - 1, b = i == last ? last : i + 1;
  const Vector before = z.col(i) - z.col(a), behind = z.col(b) - z.col(i);
  const double h = before.norm(), k = behind.norm();
  if (!(h > 0.0)) return k > 0.0 ? Vector(behind / k) : Vector(behind);
  if (!(k > 0.0)) return before / h;
  return (before * (k / h) + behind * (h / k)) / (h + k);
}

// Distance of w from the cubic between nodes i and i + 1, and the cubic's direction there.
double distance_from(const Matrix& z, Eigen::Index i, const Vector& w, Vector& direction) {
  const Vector chord = z.col(i + 1) - z.col(i);
  const double h = chord.norm();
  const Vector m0 = h * slope_at(z, i), m1 = h * slope_at(z, i + 1);
  double s = std::clamp((w - z.col(i)).dot(chord) / (h * h), 0.0, 1.0), distance = 0.0;
  for (int k = 0; k < 4; ++k) {
    const double s2 = s * s, s3 = s2 * s;
    const Vector at = (2.0 * s3 - 3.0 * s2 + 1.0) * z.col(i) + (s3 - 2.0 * s2 + s) * m0 + (3.0 * s2 - 2.0 * s3) * z.col(i + 1) + (s3 - s2) * m1;
    direction = (6.0 * s2 - 6.0 * s) * (z.col(i) - z.col(i + 1)) + (3.0 * s2 - 4.0 * s + 1.0) * m0 + (3.0 * s2 - 2.0 * s) * m1;
    distance = (w - at).norm();
    s = std::clamp(s + (w - at).dot(direction) / direction.squaredNorm(), 0.0, 1.0);
  }
  return distance;
}

// Where it tells curves apart.
double frequency_of(EventType type, double frequency) { return type == EventType::hopf || type == EventType::torus ? frequency : 0.0; }

}  // namespace

bool lies_on(const Problem& f, const DefiningCurve& curve, const Vector& u, double frequency, const Vector& along,
             const TwoParameterOptions& options) {
  if (u.size() != curve.u.rows() || curve.u.cols() < 2) return false;
  const int n = f.size();
  const Vector units = units_of(curve, options);
  const Matrix z = scaled(curve, units);
  const std::size_t images = std::size_t{1} << f.reflections().size();
  for (std::size_t subset = 0; subset < images; ++subset) {
    Vector signs = Vector::Ones(u.size() + 1);
    for (std::size_t r = 0; r < f.reflections().size(); ++r)
      if (subset >> r & 1) signs.head(n).array() *= f.reflections()[r].signs.array();
    Vector w(u.size() + 1), way;
    w << u, frequency;
    w = w.cwiseQuotient(units).cwiseProduct(signs);
    if (along.size() > 0) way = along.cwiseQuotient(units.head(u.size())).cwiseProduct(signs.head(u.size()));
    for (Eigen::Index i = 0; i + 1 < z.cols(); ++i) {
      const double chord = (z.col(i + 1) - z.col(i)).norm();
      if (!(chord > 0.0) || std::min((w - z.col(i)).norm(), (w - z.col(i + 1)).norm()) > chord + rounding) continue;
      Vector direction;
      if (distance_from(z, i, w, direction) > chord_part * chord + rounding) continue;
      const Vector here = direction.head(u.size());
      if (way.size() == 0 || std::abs(here.dot(way)) > same_way * here.norm() * way.norm()) return true;
    }
  }
  return false;
}

bool Chart::wants(EventType type) const { return wanted_.empty() || std::find(wanted_.begin(), wanted_.end(), type) != wanted_.end(); }

// In which the states of a curve of this type stand.
const Problem& Chart::problem_of(EventType type) const {
  const auto* orbit = dynamic_cast<const OrbitProblem*>(&f_);
  return orbit && type == EventType::period_doubling ? orbit->doubled() : f_;
}

bool Chart::is_known(const SpecialPoint& point, double p2, const Vector& along) const {
  Vector u(point.u.size() + 1);
  u << point.u, p2;
  const Problem& problem = problem_of(point.type);
  if (&problem != &f_) u = dynamic_cast<const OrbitProblem&>(f_).in_doubled(u);
  return std::any_of(curves_.begin(), curves_.end(), [&](const DefiningCurve& c) {
    const bool same_kind = c.type == point.type && (point.type != EventType::peak || c.subtype == point.subtype);
    return same_kind && lies_on(problem, c, u, frequency_of(point.type, point.frequency), along, options_);
  });
}

// Does most of a curve lie on one followed before?
bool Chart::repeats(const DefiningCurve& curve) const {
  constexpr int looked_at = 5;
  return std::any_of(curves_.begin(), curves_.end(), [&](const DefiningCurve& known) {
    if (known.type != curve.type || (curve.type == EventType::peak && known.subtype != curve.subtype)) return false;
    int on = 0;
    for (int part = 1; part <= looked_at; ++part) {
      const Eigen::Index i = part * (curve.u.cols() - 1) / (looked_at + 1);
      on += lies_on(problem_of(curve.type), known, curve.u.col(i), frequency_of(curve.type, curve.frequency[i]), {}, options_) ? 1 : 0;
    }
    return 2 * on > looked_at;
  });
}

void Chart::follow_from(const SpecialPoint& point, double p2, const std::string& origin) {
  if (wants(point.type) && !is_known(point, p2, {})) adopt(point, p2, origin, true);
}

void Chart::adopt(const SpecialPoint& point, double p2, const std::string& origin, bool warn) {
  DefiningCurve curve;
  try {
    curve = follow(f_, point, p2, options_, observer_);
  } catch (const std::invalid_argument& e) {
    if (warn && on_warning_) on_warning_(origin + ": " + e.what());
    return;
  }
  if (!wants(curve.type) || repeats(curve)) return;
  curve.born_at = origin;
  if (on_curve_) on_curve_(curve);
  curves_.push_back(std::move(curve));
}

void Chart::follow_meetings() {
  for (std::size_t k = 0; k < curves_.size(); ++k) {
    const std::vector<CodimensionTwo> met = curves_[k].special;
    for (const auto& z : met)
      for (const CurveStart& start : curves_through(f_, curves_[k], z, options_)) {
        Vector u(z.u.size());
        u << start.point.u, start.p2;
        if (!wants(start.point.type) || is_known(start.point, start.p2, u - z.u)) continue;
        adopt(start.point, start.p2, curves_[k].name + ":" + z.type, false);
      }
  }
}

}  // namespace whirl::continuation
