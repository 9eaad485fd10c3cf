#include "continuation/multiple_point.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>

#include "core/problem_in_units.hpp"

namespace whirl::continuation {
namespace {

constexpr double nearly_singular = 1e-4;  // singular values below it, in parts of the usual size of r_x, belong to the kernel
constexpr double beside_by = 0.01;        // of 1 + |u|: no further, for what grows exponentially
constexpr double rank = 1e-9;             // singular values of the equations' Jacobian below it, relative, leave a direction open
constexpr double solved = 1e-9;           // of r and G, in parts of the usual size
constexpr double settled = 1e-11;         // last step
constexpr int most_steps = 40;
// Where the equations fix a coordinate by its square or cube Newton contracts by 1/2 or 2/3: the rest of such a series is added at once.
constexpr double slowest = 0.8, fastest = 0.3, alike = 0.03;

// The equations and their Jacobian at u; B and C are the borders.
struct Equations {
  Equations(const Problem& f, const Matrix& left, const Matrix& right) : f_(f), left_(left), right_(right) {}

  void evaluate(const Vector& u, Vector& values, Matrix& slopes) const {
    const auto n = static_cast<Eigen::Index>(f_.size()), d = left_.cols();
    Vector r(n);
    Matrix j(n, n + 1), bordered = Matrix::Zero(n + d, n + d), unit = Matrix::Zero(n + d, d), h(n, n + 1);
    f_.linearise(u, r, j);
    bordered << j.leftCols(n), left_, right_.transpose(), Matrix::Zero(d, d);
    unit.bottomRows(d).setIdentity();
    const Matrix vg = bordered.fullPivLu().solve(unit), wg = bordered.transpose().fullPivLu().solve(unit);
    values.resize(n + d * d);
    slopes.resize(n + d * d, n + 1);
    values.head(n) = r;
    slopes.topRows(n) = j;
    Vector along = Vector::Zero(n + 1);
    for (Eigen::Index k = 0; k < d; ++k) {
      along.head(n) = vg.col(k).head(n);
      f_.second(u, along, h);
      for (Eigen::Index i = 0; i < d; ++i) {
        values[n + k * d + i] = vg(n + i, k);
        slopes.row(n + k * d + i) = -wg.col(i).head(n).transpose() * h;
      }
    }
  }

 private:
  const Problem& f_;
  Matrix left_, right_;
};

}  // namespace

double usual_jacobian(const Problem& f, In u) {
  const int n = f.size();
  Matrix around(n, n + 1);
  std::vector<double> sizes;
  for (int i = 0; i <= n; ++i) {
    Vector beside = u;
    beside[i] += beside_by * (1.0 + std::abs(u[i]));
    f.jacobian(beside, around);
    if (around.allFinite()) sizes.push_back(around.norm());
  }
  f.jacobian(u, around);
  if (!around.allFinite() || sizes.empty()) return 0.0;
  std::nth_element(sizes.begin(), sizes.begin() + sizes.size() / 2, sizes.end());
  return std::max(around.norm(), sizes[sizes.size() / 2]);
}

namespace {

// x and p of order one.
std::optional<MultiplePoint> multiple_point_in_units(const Problem& f, const Vector& u) {
  const int n = f.size();
  const double usual = usual_jacobian(f, u);
  if (!(usual > 0.0) || n < 2) return std::nullopt;
  Matrix j(n, n + 1);
  f.jacobian(u, j);
  const Eigen::JacobiSVD<Matrix> svd(j.leftCols(n), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const auto d = (svd.singularValues().array() <= nearly_singular * usual).count();
  if (d < 2) return std::nullopt;
  const Equations equations(f, svd.matrixU().rightCols(d), svd.matrixV().rightCols(d));
  MultiplePoint point{u, static_cast<int>(d), 0.0};
  Vector values;
  Matrix slopes;
  double last_step = 0.0, last_ratio = 0.0;
  for (int i = 0; i < most_steps; ++i) {
    equations.evaluate(point.u, values, slopes);
    if (!values.allFinite() || !slopes.allFinite()) return std::nullopt;
    Eigen::JacobiSVD<Matrix> least(slopes, Eigen::ComputeThinU | Eigen::ComputeThinV);
    least.setThreshold(rank);
    const Vector step = least.solve(-values);
    point.u += step;
    const double ratio = step.norm() / last_step;
    if (ratio > fastest && ratio < slowest && std::abs(ratio - last_ratio) < alike) point.u += ratio / (1.0 - ratio) * step;
    last_ratio = ratio;
    last_step = step.norm();
    if (!(step.norm() <= settled * (1.0 + point.u.norm()))) continue;
    equations.evaluate(point.u, values, slopes);
    point.residual = values.lpNorm<Eigen::Infinity>();
    if (!(point.residual < solved * usual)) return std::nullopt;
    // On a fold r_p fills a dimension: of [r_x r_p] two must be missing.
    f.jacobian(point.u, j);
    const Eigen::VectorXd whole = Eigen::JacobiSVD<Matrix>(j).singularValues();
    if ((whole.array() <= nearly_singular * usual).count() < 2) return std::nullopt;
    return point;
  }
  return std::nullopt;
}

}  // namespace

std::optional<MultiplePoint> multiple_point_near(const Problem& f, In u, double x_scale, double p_scale) {
  Vector units = Vector::Constant(f.size() + 1, x_scale);
  units[f.size()] = p_scale;
  const ProblemInUnits scaled(f, units, Vector::Ones(f.size()));
  auto point = multiple_point_in_units(scaled, u.cwiseQuotient(units));
  if (point) point->u.array() *= units.array();
  return point;
}

}  // namespace whirl::continuation
