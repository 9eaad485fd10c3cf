#include "continuation/chart_units.hpp"

#include <algorithm>
#include <cmath>

#include "continuation/held_problem.hpp"
#include "continuation/normal_form.hpp"

namespace whirl::continuation {
namespace {

constexpr int most_coordinates = 8;  // looked at; of a large system some, evenly

double power_of_two(double size) { return std::exp2(std::round(std::log2(size))); }

// How far x may go from u, along a coordinate or all of them, before what is not linear is as large in an equation as all that is: terms in x, the
// largest over the ranges, and those in both parameters. Special points are where single terms vanish, so no single one is measured against.
class LinearPart {
 public:
  LinearPart(const Problem& f, const Vector& u, const TwoParameterOptions& o)
      : f_(f), u_(u), in_x_(Vector::Zero(f.size())), in_p_(in_x_), r0_(f.size()), r_(f.size()), j_(f.size(), f.size() + 2) {
    const int n = f.size();
    const double w1 = o.range1[1] - o.range1[0], w2 = o.range2[1] - o.range2[0];
    const auto look = [&](int i, double value) {
      Vector at = u;
      at[i] = value;
      f.jacobian(at, j_);
      if (!j_.allFinite()) return;
      in_x_ = in_x_.cwiseMax(j_.leftCols(n).cwiseAbs().rowwise().sum());
      in_p_ = in_p_.cwiseMax(w1 * j_.col(n).cwiseAbs() + w2 * j_.col(n + 1).cwiseAbs());
    };
    for (const double end : o.range1) look(n, end);
    for (const double end : o.range2) look(n + 1, end);
    look(n, u[n]);
    f.linearise(u, r0_, j_);
  }

  double size() {
    constexpr int most_decades = 40, bisections = 5;
    double below = 0.0, above = 0.0, s = 1.0;
    const bool curved = is_curved(s);
    for (int k = 0; k < most_decades && (below == 0.0 || above == 0.0); ++k, s *= curved ? 0.1 : 10.0) (is_curved(s) ? above : below) = s;
    if (below == 0.0 || above == 0.0) return 0.0;
    for (int k = 0; k < bisections; ++k) {
      const double middle = std::sqrt(below * above);
      (is_curved(middle) ? above : below) = middle;
    }
    return below;
  }

 private:
  bool is_curved(double s) {
    const int n = f_.size(), looked_at = std::min(n, most_coordinates);
    for (int k = 0; k <= looked_at; ++k) {
      Vector d = Vector::Zero(n);
      for (int i = 0; i < n; ++i) d[i] = k == looked_at ? 1.0 + 0.3 * std::cos(1.7 * i) : 0.0;
      if (k < looked_at) d[n <= most_coordinates ? k : k * n / most_coordinates] = 1.0;
      Vector at = u_;
      at.head(n) += s * d;
      f_.residual(at, r_);
      const Vector rest = (r_ - r0_ - s * (j_.leftCols(n) * d)).cwiseAbs(), linear = s * in_x_ + in_p_;
      if (!rest.allFinite() || ((rest - linear).array() > 0.0 && linear.array() > 0.0).any()) return true;
    }
    return false;
  }

  const Problem& f_;
  Vector u_, in_x_, in_p_, r0_, r_;
  Matrix j_;
};

double state_unit(const Problem& f, const Vector& u, const TwoParameterOptions& o) {
  const double size = LinearPart(f, u, o).size(), state = u.head(f.size()).lpNorm<Eigen::Infinity>();
  return power_of_two(std::max(size > 0.0 ? size : 1.0, state));  // a linear system has no size of its own: one is as good as any
}

// Size of r_x around u, where r_x itself may be singular or zero.
double usual_rate(const Problem& f, const Vector& u, double x, const TwoParameterOptions& o) {
  constexpr double beside_by = 0.1;  // of the units
  const int n = f.size();
  Matrix j(n, n + 2);
  std::vector<double> rates;
  const auto look = [&](int i, double by) {
    Vector beside = u;
    beside[i] += by;
    f.jacobian(beside, j);
    if (j.allFinite()) rates.push_back(j.leftCols(n).norm());
  };
  look(0, 0.0);
  for (int k = 0; k < std::min(n, most_coordinates); ++k) look(n <= most_coordinates ? k : k * n / most_coordinates, beside_by * x);
  look(n, beside_by * (o.range1[1] - o.range1[0]));
  look(n + 1, beside_by * (o.range2[1] - o.range2[0]));
  if (rates.empty()) return 0.0;
  const double here = rates.front();
  std::nth_element(rates.begin(), rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 2), rates.end());
  return std::max(here, rates[rates.size() / 2]);
}

// A frequency far below the rates of the other states is what the curve is about; one that is only near zero, as beside a double zero, is not.
double time_unit(const Problem& f, const Vector& u, double frequency, double x, const TwoParameterOptions& o) {
  constexpr double slow = 30.0;
  const double rate = usual_rate(f, u, x, o);
  const double unit = frequency > 0.0 ? std::max(frequency, std::min(rate, slow * frequency)) : rate;
  return unit > 0.0 && std::isfinite(unit) ? power_of_two(1.0 / unit) : 1.0;
}

Vector all_units(const Problem& f, double x, double w1, double w2) {
  Vector units = Vector::Constant(f.size() + 2, x);
  units[f.size()] = w1;
  units[f.size() + 1] = w2;
  return units;
}

}  // namespace

ChartUnits::ChartUnits(const Problem& f, const Vector& u, double frequency, const TwoParameterOptions& options)
    : f_(f),
      x_(state_unit(f, u, options)),
      w1_(power_of_two(options.range1[1] - options.range1[0])),
      w2_(power_of_two(options.range2[1] - options.range2[0])),
      time_(time_unit(f, u, frequency, x_, options)),
      problem_(f, all_units(f, x_, w1_, w2_), Vector::Constant(f.size(), x_ / time_)),
      options_(options) {
  for (double& end : options_.range1) end /= w1_;
  for (double& end : options_.range2) end /= w2_;
  for (double& value : options_.walk.user_values) value /= w2_;
  for (auto& peak : options_.walk.peaks)
    if (peak.form) peak.form->Q *= x_;  // and the form itself in units of X
}

SpecialPoint ChartUnits::inwards(const SpecialPoint& point) const {
  SpecialPoint in = point;
  const int n = f_.size();
  for (Vector* v : {&in.u, &in.tangent}) {
    if (v->size() != n + 1) continue;
    v->head(n) /= x_;
    (*v)[n] /= w1_;
  }
  in.frequency *= time_;
  return in;
}

CodimensionTwo ChartUnits::inwards(const CodimensionTwo& point) const {
  CodimensionTwo in = point;
  in.u.array() /= problem_.units().array();
  return in;
}

void ChartUnits::outwards(CurveStart& start) const {
  const int n = f_.size();
  for (Vector* v : {&start.point.u, &start.point.tangent}) {
    if (v->size() != n + 1) continue;
    v->head(n) *= x_;
    (*v)[n] *= w1_;
  }
  start.point.frequency /= time_;
  start.p2 *= w2_;
}

void ChartUnits::outwards(DefiningCurve& curve) const {
  for (auto& z : curve.special) z.u.array() *= problem_.units().array();
  curve.u = problem_.units().asDiagonal() * curve.u;
  for (Eigen::Index i = 0; i < curve.coefficient.size(); ++i) curve.coefficient[i] = coefficient_outwards(curve, i);
  if (curve.type == EventType::hopf) curve.frequency /= time_;
}

// Of normal_form.hpp: w'B(v, v) goes with 1 / (X T), w'C(v, v, v) with 1 / (X^2 T), l1 with 1 / X^2.
double ChartUnits::coefficient_outwards(const DefiningCurve& curve, Eigen::Index i) const {
  const double c = curve.coefficient[i];
  if (curve.type == EventType::hopf) return c / (x_ * x_);
  if (curve.type != EventType::branch_point || curve.subtype == "TC") return c / (x_ * time_);
  if (curve.block > 0 || !curve.subtype.empty()) return c / (x_ * x_ * time_);
  const int n = f_.size();  // which of both it is hangs on the point
  SpecialPoint point;
  point.type = curve.type;
  point.u = curve.u.col(i).head(n + 1);
  set_normal_form(HeldProblem(f_, curve.u(n + 1, i)), point);
  return point.has_coefficient ? point.coefficient : std::nan("");
}

}  // namespace whirl::continuation
