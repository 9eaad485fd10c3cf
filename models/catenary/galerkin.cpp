#include "models/catenary/galerkin.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

namespace whirl::models::catenary {
namespace {

void require(bool right, const char* what) {
  if (!right) throw std::invalid_argument(what);
}

}  // namespace

// Q, Q_t and U of every function, columns A, B, C and lifts.
InPlaneGalerkin::InPlaneGalerkin(double x1, double x2, int n, bool elastic) : n_(n), elastic_(elastic), mesh_(x1, x2, n) {
  const double m = mesh_.m, sixth = 1.0 / std::sqrt(6.0);
  const Vector &c = mesh_.c, &J = mesh_.J;
  const auto points = mesh_.t.size();
  const Matrix phi = dirichlet_values(mesh_.legendre, n + 1), slope = dirichlet_slopes(mesh_.legendre, n + 1);
  const Matrix phi_integral = dirichlet_integrals(mesh_.legendre, n + 1), p_integral = legendre_integrals(mesh_.legendre, n + 1);
  const int functions = elastic ? 2 * n + 1 : n;
  Matrix Q = Matrix::Zero(points, functions + lifts), Q_t = Q;
  U_.setZero(points, functions + lifts);
  const double scale = m * std::sqrt(m);
  Q.leftCols(n) = scale * phi.rightCols(n);
  Q_t.leftCols(n) = scale * slope.rightCols(n);
  U_.leftCols(n) = scale * phi_integral.rightCols(n);
  if (elastic) {
    R_.setZero(points, functions);
    for (int k = 1; k <= n; ++k) {
      const double b = std::sqrt((k + 0.5) * m);
      U_.col(n + k - 1) = b * p_integral.col(k);
      R_.col(n + k - 1) = b * mesh_.legendre.col(k).cwiseQuotient(J);
    }
    const double b = std::sqrt(m);
    Q.col(2 * n) = b * phi.col(0);
    Q_t.col(2 * n) = b * slope.col(0);
    U_.col(2 * n) = b * (phi_integral.col(0) - sixth * p_integral.col(0));
    R_.col(2 * n) = -b * sixth * J.cwiseInverse();
  }
  add_lifts(Q, Q_t, phi_integral, p_integral);
  // V = g Q, V_x + U/c = (g Q_t + g_t Q)/J + U/c,  g = c/J
  const Vector g = c.cwiseQuotient(J), g_t = mesh_.x.array().sinh() - c.array() * mesh_.J_t.array() / J.array().square();
  V_ = g.asDiagonal() * Q;
  F_ = g.cwiseQuotient(J).asDiagonal() * Q_t;
  F_ += g_t.cwiseQuotient(J).asDiagonal() * Q;
  F_ += c.cwiseInverse().asDiagonal() * U_;
  std::vector<int> every(std::size_t(functions), 0), turning(every.begin(), every.begin() + n), stretching;
  std::iota(every.begin(), every.end(), 0);
  std::iota(turning.begin(), turning.end(), 0);  // functions with Q, and with R
  if (elastic) {
    turning.push_back(2 * n);
    stretching.assign(every.begin() + n, every.end());
  }
  KF_ = gram(F_, mesh_.weight, every);
  MU_ = gram(U_, mesh_.weight.cwiseProduct(c), every);
  MV_ = gram(V_, mesh_.weight.cwiseProduct(c), turning);
  if (elastic) KR_ = gram(R_, mesh_.weight.cwiseQuotient(c), stretching).bottomRightCorner(n + 1, n + 1);
}

// Q = alpha + beta t + gamma phi_0 with c Q/J = V at the ends, U1 + int Q dt = U2.
void InPlaneGalerkin::add_lifts(Matrix& Q, Matrix& Q_t, const Matrix& phi_integral, const Matrix& p_integral) {
  const double sixth = 1.0 / std::sqrt(6.0);
  const Coordinate& map = mesh_.coordinate;
  const double one = map.slope(mesh_.x1) / std::cosh(mesh_.x1), two = map.slope(mesh_.x2) / std::cosh(mesh_.x2);
  const Vector phi = ((1.0 - mesh_.t.array().square()) * 1.5 * sixth).matrix(), phi_t = (-3.0 * sixth) * mesh_.t;
  for (int i = 0; i < lifts; ++i) {
    const double U1 = i == 0, V1 = i == 1, U2 = i == 2, V2 = i == 3, Q1 = V1 * one, Q2 = V2 * two;
    const double alpha = 0.5 * (Q1 + Q2), beta = 0.5 * (Q2 - Q1), gamma = ((U2 - U1) - 2.0 * alpha) / (2.0 * sixth);
    const auto j = Q.cols() - lifts + i;
    Q.col(j) = (alpha + beta * mesh_.t.array()).matrix() + gamma * phi;
    Q_t.col(j) = (beta + gamma * phi_t.array()).matrix();
    U_.col(j) = (U1 + alpha * p_integral.col(0).array() + beta * p_integral.col(1).array() + gamma * phi_integral.col(0).array()).matrix();
  }
}

// int w a_i a_j dx for some functions, zero for the others. On a level cable the parities do not meet and half the points are enough.
Matrix InPlaneGalerkin::gram(const Matrix& a, const Vector& weight, const std::vector<int>& chosen) const {
  const bool level = mesh_.coordinate.level();
  const auto points = level ? a.rows() - a.rows() / 2 : a.rows();
  Vector root = weight.head(points).cwiseSqrt();
  if (level) root *= std::numbers::sqrt2;
  if (level && a.rows() % 2 == 1) root[points - 1] *= std::sqrt(0.5);  // the middle point counts once
  Matrix g = Matrix::Zero(elastic_ ? 2 * n_ + 1 : n_, elastic_ ? 2 * n_ + 1 : n_), b(points, Eigen::Index(chosen.size())), products;
  std::vector<int> part;
  for (int parity = 0; parity < (level ? 2 : 1); ++parity) {
    part.clear();
    for (const int i : chosen)
      if (!level || order(i) % 2 == parity) part.push_back(i);
    const auto size = Eigen::Index(part.size());
    for (Eigen::Index j = 0; j < size; ++j) b.col(j) = root.cwiseProduct(a.col(part[std::size_t(j)]).head(points));
    products.setZero(size, size);
    products.selfadjointView<Eigen::Lower>().rankUpdate(b.leftCols(size).transpose());
    for (Eigen::Index j = 0; j < size; ++j)
      for (Eigen::Index i = j; i < size; ++i) {
        const auto row = part[std::size_t(i)], column = part[std::size_t(j)];
        g(row, column) = g(column, row) = products(i, j);
      }
  }
  return g;
}

// int w a_i a_j dx for functions i and lifts j.
Matrix InPlaneGalerkin::lift_work(const Matrix& a, const Vector& weight, double kappa) const {
  const Matrix lifted = weight.asDiagonal() * a.rightCols(lifts);
  return scale(kappa).asDiagonal() * (a.leftCols(size(kappa)).transpose() * lifted);
}

Vector InPlaneGalerkin::scale(double kappa, int order) const {
  require(kappa >= 0.0 && std::isfinite(kappa), "the flexibility kappa must be >= 0");
  require(elastic_ || kappa == 0.0, "a discretisation without stretch takes kappa = 0 only");
  Vector d = Vector::Constant(size(kappa), order == 0 ? std::sqrt(kappa) : order == 1 ? 1.0 : 0.0);
  d.head(n_).setConstant(order == 0 ? 1.0 : 0.0);
  return d;
}

// The derivative of D a D with respect to s: D is linear in s.
Matrix InPlaneGalerkin::scaled(const Matrix& a, double kappa, int order) const {
  const int n = size(kappa);
  const Vector d = scale(kappa), e = scale(kappa, 1);
  const auto block = a.topLeftCorner(n, n);
  if (order == 0) return d.asDiagonal() * block * d.asDiagonal();
  if (order == 2) return 2.0 * (e.asDiagonal() * block * e.asDiagonal());
  const Matrix once = e.asDiagonal() * block * d.asDiagonal();
  return once + once.transpose();
}

Matrix InPlaneGalerkin::stiffness(double kappa) const {
  Matrix K = scaled(KF_, kappa, 0);
  if (kappa > 0.0) K.bottomRightCorner(n_ + 1, n_ + 1) += KR_;
  return K;
}

Matrix InPlaneGalerkin::mass(double kappa, double tangential, double normal) const {
  return tangential * scaled(MU_, kappa, 0) + normal * scaled(MV_, kappa, 0);
}

Matrix InPlaneGalerkin::stiffness_slope(double kappa, int order) const { return scaled(KF_, kappa, order); }
Matrix InPlaneGalerkin::mass_slope(double kappa, int order) const { return scaled(MU_, kappa, order) + scaled(MV_, kappa, order); }

Matrix InPlaneGalerkin::lift_stiffness(double kappa) const { return lift_work(F_, mesh_.weight, kappa); }

Matrix InPlaneGalerkin::lift_mass(double kappa, double tangential, double normal) const {
  const Vector weight = mesh_.weight.cwiseProduct(mesh_.c);
  return tangential * lift_work(U_, weight, kappa) + normal * lift_work(V_, weight, kappa);
}

std::vector<int> InPlaneGalerkin::indices(double kappa, Parity parity, int largest_k) const {
  std::vector<int> chosen;
  for (int i = 0; i < size(kappa); ++i)
    if (order(i) <= largest_k && (parity == Parity::both || (order(i) % 2 == 0) == (parity == Parity::symmetric))) chosen.push_back(i);
  return chosen;
}

LateralGalerkin::LateralGalerkin(double x1, double x2, int n) : mesh_(x1, x2, n) {
  const double m = mesh_.m;
  const auto points = mesh_.t.size();
  W_.resize(points, n + 2);
  slope_.resize(points, n + 2);
  W_.leftCols(n) = std::sqrt(m) * dirichlet_values(mesh_.legendre, n);
  slope_.leftCols(n) = mesh_.J.cwiseInverse().asDiagonal() * (std::sqrt(m) * dirichlet_slopes(mesh_.legendre, n));
  W_.col(n) = (0.5 / m) * (x2 - mesh_.x.array());
  W_.col(n + 1) = (0.5 / m) * (mesh_.x.array() - x1);
  slope_.col(n).setConstant(-0.5 / m);
  slope_.col(n + 1).setConstant(0.5 / m);
  const Matrix M = W_.transpose() * mesh_.weight.cwiseProduct(mesh_.c).asDiagonal() * W_, K = slope_.transpose() * mesh_.weight.asDiagonal() * slope_;
  M_ = M.topLeftCorner(n, n);
  M_lift_ = M.topRightCorner(n, 2);
  K_ = K.topLeftCorner(n, n);
  K_lift_ = K.topRightCorner(n, 2);
}

std::vector<int> LateralGalerkin::indices(Parity parity, int largest_k) const {
  std::vector<int> chosen;
  for (int k = 0; k < size() && k <= largest_k; ++k)
    if (parity == Parity::both || (k % 2 == 0) == (parity == Parity::symmetric)) chosen.push_back(k);
  return chosen;
}

Matrix pick(const Matrix& a, const std::vector<int>& chosen) {
  const auto n = Eigen::Index(chosen.size());
  Matrix b(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto column = a.col(chosen[std::size_t(j)]);
    for (Eigen::Index i = 0; i < n; ++i) b(i, j) = column[chosen[std::size_t(i)]];
  }
  return b;
}

}  // namespace whirl::models::catenary
