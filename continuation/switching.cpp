#include "continuation/switching.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>

namespace whirl::continuation {
namespace {

constexpr int largest_searched = 64;  // unknowns; the search costs some hundred factorisations
constexpr int largest_kernel = 5;     // dimensions: 5^5 starts

// Newton on r(u) = 0, |u - u0| = radius, from a point of that sphere.
bool solve_on_sphere(const Problem& f, const Vector& u0, double radius, Vector& u) {
  const int n = f.size();
  Matrix full(n + 1, n + 1), j(n, n + 1);
  Vector r(n), rhs(n + 1);
  for (int i = 0; i < 80; ++i) {
    f.linearise(u, r, j);
    const Vector from = u - u0;
    rhs << -r, 0.5 * (radius * radius - from.squaredNorm()) / radius;
    full << j, from.transpose() / radius;
    Vector step = full.fullPivLu().solve(rhs);
    if (!step.allFinite()) return false;
    if (step.norm() > 0.5 * radius) step *= 0.5 * radius / step.norm();
    u += step;
    if (step.norm() < 1e-10 * radius) return true;
  }
  return false;
}

// Where two or more eigenvalues are zero at once no quadratic form tells the directions: what meets a small sphere about the point does. The starts
// fill the kernel: every sign pattern of its basis.
std::vector<Departure> search_sphere(const Problem& f, const SpecialPoint& point, const Matrix& kernel) {
  const double radius = 1e-3 * (1.0 + point.u.norm());
  const auto d = kernel.cols();
  const Vector along = point.tangent.normalized();
  std::vector<Vector> met;
  int patterns = 1;
  for (Eigen::Index k = 0; k < d; ++k) patterns *= 5;
  for (int pattern = 0; pattern < patterns; ++pattern) {
    Vector c(d);
    for (Eigen::Index k = 0, rest = pattern; k < d; ++k, rest /= 5) c[k] = static_cast<double>(rest % 5) - 2.0;
    if (c.norm() == 0.0) continue;
    Vector u = point.u + kernel * c * (radius / c.norm());
    if (!solve_on_sphere(f, point.u, radius, u)) continue;
    const Vector direction = (u - point.u).normalized();
    if (std::abs(direction.dot(along)) > 0.999) continue;
    if (std::any_of(met.begin(), met.end(), [&](const Vector& m) { return (m - direction).norm() < 1e-2; })) continue;
    met.push_back(direction);
  }
  std::vector<Departure> all;
  for (const Vector& direction : met) all.push_back({direction, false});
  return all;
}

// Basis of the kernel of [r_x r_p] if it has more than two dimensions, else empty.
Matrix multiple_kernel(const Problem& f, In u) {
  const int n = f.size();
  if (!f.is_flow() || n < 2 || n > largest_searched) return {};
  Matrix j(n, n + 1), around(n, n + 1);
  f.jacobian(u, j);
  std::vector<double> sizes;
  for (int i = 0; i <= n; ++i) {  // at the point itself all of it may vanish
    Vector beside = u;
    beside[i] += 0.1 * (1.0 + std::abs(u[i]));
    f.jacobian(beside, around);
    if (around.allFinite()) sizes.push_back(around.norm());
  }
  if (!j.allFinite() || sizes.empty()) return {};
  std::nth_element(sizes.begin(), sizes.begin() + sizes.size() / 2, sizes.end());
  const double usual = std::max(j.norm(), sizes[sizes.size() / 2]);
  const Eigen::JacobiSVD<Matrix> svd(j, Eigen::ComputeFullV);
  const auto rank = (svd.singularValues().array() > 1e-6 * usual).count();
  const auto dimensions = n + 1 - rank;
  return dimensions > 2 && dimensions <= largest_kernel ? Matrix(svd.matrixV().rightCols(dimensions)) : Matrix();
}

}  // namespace

std::vector<Departure> departures(const Problem& f, SpecialPoint& point) {
  const int n = f.size();
  if (const Matrix kernel = multiple_kernel(f, point.u); kernel.size() > 0) return search_sphere(f, point, kernel);
  if (point.block > 0) {  // a reflection breaks: along the odd null vector, its mirror image the other way
    Vector direction = Vector::Zero(n + 1);
    direction.head(n) = point.null_vector;
    return {{direction, false}};
  }
  if (f.derivatives() < 2) return {};
  Matrix j(n, n + 1), h(n, n + 1);
  f.jacobian(point.u, j);
  const Eigen::JacobiSVD<Matrix> svd(j, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix phi = svd.matrixV().rightCols(2);
  const Vector w = svd.matrixU().col(n - 1);
  Eigen::Matrix2d q;
  for (int i = 0; i < 2; ++i) {
    f.second(point.u, phi.col(i), h);
    for (int k = 0; k < 2; ++k) q(i, k) = w.dot(h * phi.col(k));
  }
  // q00 a^2 + 2 q01 a b + q11 b^2 = 0, two real directions if the discriminant is positive
  const double d = q(0, 1) * q(0, 1) - q(0, 0) * q(1, 1), scale = q.cwiseAbs().maxCoeff();
  if (!(d > 1e-14 * scale * scale)) return {};
  std::vector<Vector> directions;
  const double root = std::sqrt(d);
  for (const double sign : {1.0, -1.0}) {
    // (a, b) from the larger pivot
    const double t = -q(0, 1) + sign * root;
    Eigen::Vector2d ab = std::abs(q(0, 0)) > std::abs(q(1, 1)) ? Eigen::Vector2d(t, q(0, 0)) : Eigen::Vector2d(q(1, 1), t);
    if (ab.norm() < 1e-12 * scale) ab = std::abs(q(0, 0)) > std::abs(q(1, 1)) ? Eigen::Vector2d(0.0, 1.0) : Eigen::Vector2d(1.0, 0.0);
    directions.push_back((phi * ab).normalized());
  }
  const Vector along = point.tangent.normalized();
  const bool first_is_known = std::abs(along.dot(directions[0])) > std::abs(along.dot(directions[1]));
  const Vector& leaving = directions[first_is_known ? 1 : 0];
  if (point.subtype.empty()) {
    const bool upright = std::abs(leaving[n]) < 1e-6 || std::abs(directions[first_is_known ? 0 : 1][n]) < 1e-6;
    point.subtype = upright ? "PF" : "TC";
  }
  return {{leaving, true}};
}

}  // namespace whirl::continuation
