#include "continuation/switching.hpp"

#include <Eigen/SVD>

namespace whirl::continuation {

std::vector<Departure> departures(const Problem& f, SpecialPoint& point) {
  const int n = f.size();
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
