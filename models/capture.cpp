#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "models/attractors.hpp"

namespace whirl::models {
namespace {

// S = sum_k (B^k)' B^k, B = A/sqrt(|mu|), by doubling: V(A d) <= |mu| V(d) in every direction. Not finite if A does not contract.
Matrix contraction_metric(Matrix a, double largest_multiplier) {
  a /= std::sqrt(std::max(largest_multiplier, 1e-3));
  Matrix s = Matrix::Identity(a.rows(), a.cols());
  for (int k = 0; k < 40 && a.norm() > 1e-12; ++k) {
    s += (a.transpose() * s * a).eval();
    a = (a * a).eval();
  }
  return s;
}

// Does one P^m bring every sample of the ellipsoid |U (x - p)| = r nearer?
bool contracts(Stroboscope& strobe, int multiple, const Vector& p, const Matrix& u, double r, const Matrix& directions) {
  for (const double shell : {1.0, 0.75, 0.5, 0.3, 0.15})
    for (Eigen::Index i = 0; i < directions.cols(); ++i) {
      const Vector offset = u.triangularView<Eigen::Upper>().solve(Vector(shell * r * directions.col(i)));
      Vector y = p + offset;
      if (!strobe.map(y, multiple)) return false;
      if (!((u * (y - p)).norm() < shell * r)) return false;
    }
  return true;
}

Matrix fixed_directions(Eigen::Index n) {
  std::mt19937 random(20250101);
  std::normal_distribution<double> normal;
  Matrix d(n, 32);
  for (Eigen::Index j = 0; j < d.cols(); ++j) {
    for (Eigen::Index i = 0; i < n; ++i) d(i, j) = normal(random);
    d.col(j).normalize();
  }
  return d;
}

}  // namespace

Capture::Capture(const Attractor& a, Stroboscope& coarse, Stroboscope& fine) : points_(a.points) {
  const Matrix directions = fixed_directions(points_.rows());
  radius_ = 0.5 * (1.0 + points_.colwise().norm().maxCoeff());
  for (Eigen::Index j = 0; j < points_.cols(); ++j) {
    Vector y = points_.col(j);
    Matrix derivative;
    if (!fine.map(y, derivative, a.multiple)) break;
    const Matrix s = contraction_metric(derivative, std::abs(a.multipliers[0]));
    if (!s.allFinite()) break;
    factors_.push_back(s.llt().matrixU());
  }
  if (static_cast<Eigen::Index>(factors_.size()) != points_.cols()) {  // no contraction seen: only the point itself
    factors_.assign(static_cast<std::size_t>(points_.cols()), Matrix::Identity(points_.rows(), points_.rows()));
    radius_ = 1e-9;
    return;
  }
  for (Eigen::Index j = 0; j < points_.cols(); ++j)
    while (radius_ > 1e-9 &&
           !contracts(radius_ > 1e-2 ? coarse : fine, a.multiple, points_.col(j), factors_[static_cast<std::size_t>(j)], radius_, directions))
      radius_ *= 0.7;
  radius_ *= 0.7;
}

Capture::Capture(const Attractor& a) : points_(a.points) {
  // Reach: nine tenths of the points have their nearest neighbour within half of it.
  std::vector<double> nearest;
  for (Eigen::Index i = 0; i < points_.cols(); ++i) {
    double best = 1e300;
    for (Eigen::Index j = 0; j < points_.cols(); ++j)
      if (i != j) best = std::min(best, (points_.col(i) - points_.col(j)).squaredNorm());
    nearest.push_back(std::sqrt(best));
  }
  const auto at = nearest.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(nearest.size()));
  std::nth_element(nearest.begin(), at, nearest.end());
  radius_ = 2.0 * *at;
}

Capture Capture::reflected(const Vector& signs) const {
  Capture c = *this;
  c.points_ = signs.asDiagonal() * points_;
  for (auto& u : c.factors_) u = (u * signs.asDiagonal()).eval();
  return c;
}

bool Capture::near(const Vector& y) const {
  for (Eigen::Index j = 0; j < points_.cols(); ++j) {
    const double apart = (y - points_.col(j)).squaredNorm();
    if (factors_.empty()) {
      if (apart < radius_ * radius_) return true;
    } else if (apart < radius_ * radius_) {  // S >= I: no ellipsoid reaches beyond
      if ((factors_[static_cast<std::size_t>(j)].lazyProduct(y - points_.col(j))).squaredNorm() < radius_ * radius_) return true;
    }
  }
  return false;
}

}  // namespace whirl::models
