#include "models/catenary/galerkin.hpp"

#include <cmath>

namespace whirl::models::catenary {
namespace {

// Functions reach degree n + 4 and are multiplied by c = cosh x, entire, and 1/c, whose poles stand at +-i pi/2.
int mesh_points(double m, int n) { return n + 20 + static_cast<int>(6.0 * m); }

void require(bool right, const char* what) {
  if (!right) throw std::invalid_argument(what);
}

}  // namespace

Mesh::Mesh(double x1_, double x2_, int n) : x1(x1_), x2(x2_), m(0.5 * (x2_ - x1_)), x_m(0.5 * (x1_ + x2_)) {
  require(n >= 2, "a discretisation has at least two functions");
  require(x1 < x2 && std::isfinite(x1) && std::isfinite(x2), "the ends of a cable must satisfy x1 < x2");
  const GaussRule rule = gauss_legendre(mesh_points(m, n));
  t = rule.nodes;
  x = (x_m + m * t.array()).matrix();
  weight = m * rule.weights;
  c = x.array().cosh();
  legendre = legendre_values(t, static_cast<int>(t.size()));
}

InPlaneGalerkin::InPlaneGalerkin(double x1, double x2, int n) : n_(n), mesh_(x1, x2, n) {
  const double m = mesh_.m, sixth = 1.0 / std::sqrt(6.0);
  const Vector& c = mesh_.c;
  const Vector sinh = mesh_.x.array().sinh(), tangent = sinh.cwiseQuotient(c), t = mesh_.t;
  const auto points = t.size();
  const Matrix phi = dirichlet_values(mesh_.legendre, n + 1), slope = dirichlet_slopes(mesh_.legendre, n + 1);
  const Matrix phi_integral = dirichlet_integrals(mesh_.legendre, n + 1), p_integral = legendre_integrals(mesh_.legendre, n + 1);
  const int all = 2 * n + 1 + lifts;
  // Q, dQ/dx and U of every function; V = c Q, V_x = c (Q_x + tanh x Q)
  Matrix Q = Matrix::Zero(points, all), Qx = Q;
  U_.setZero(points, all);
  R_.setZero(points, 2 * n + 1);
  const double a_scale = std::sqrt(m);
  for (int k = 1; k <= n; ++k) {
    const double b_scale = std::sqrt((k + 0.5) / m);
    Q.col(k - 1) = a_scale * phi.col(k);
    Qx.col(k - 1) = (a_scale / m) * slope.col(k);
    U_.col(k - 1) = (a_scale * m) * phi_integral.col(k);
    U_.col(n + k - 1) = (b_scale * m) * p_integral.col(k);
    R_.col(n + k - 1) = b_scale * mesh_.legendre.col(k);
  }
  const double c_scale = 1.0 / std::sqrt(m);
  Q.col(2 * n) = c_scale * phi.col(0);
  Qx.col(2 * n) = (c_scale / m) * slope.col(0);
  U_.col(2 * n) = (c_scale * m) * (phi_integral.col(0) - sixth * p_integral.col(0));
  R_.col(2 * n).setConstant(-c_scale * sixth);
  // Lifts Q = alpha + beta t + gamma phi_0 with Q = V/c at the ends, U1 + m int Q = U2
  for (int i = 0; i < lifts; ++i) {
    const double U1 = i == 0, V1 = i == 1, U2 = i == 2, V2 = i == 3, Q1 = V1 / std::cosh(x1), Q2 = V2 / std::cosh(x2);
    const double alpha = 0.5 * (Q1 + Q2), beta = 0.5 * (Q2 - Q1), gamma = ((U2 - U1) / m - 2.0 * alpha) / (2.0 * sixth);
    const int j = 2 * n + 1 + i;
    Q.col(j) = (alpha + beta * t.array()).matrix() + gamma * phi.col(0);
    Qx.col(j) = ((beta + gamma * slope.col(0).array()) / m).matrix();
    U_.col(j) = (U1 + m * (alpha * p_integral.col(0).array() + beta * p_integral.col(1).array() + gamma * phi_integral.col(0).array())).matrix();
  }
  V_ = c.asDiagonal() * Q;
  F_ = c.asDiagonal() * Qx;
  F_ += sinh.asDiagonal() * Q;
  F_ += c.cwiseInverse().asDiagonal() * U_;
  const auto gram = [](const Matrix& a, const Vector& w) -> Matrix {
    const Matrix b = w.cwiseSqrt().asDiagonal() * a;
    Matrix g = Matrix::Zero(a.cols(), a.cols());
    g.selfadjointView<Eigen::Lower>().rankUpdate(b.transpose());
    return g.selfadjointView<Eigen::Lower>();
  };
  KF_ = gram(F_, mesh_.weight);
  KR_ = gram(R_, mesh_.weight.cwiseQuotient(c));
  MU_ = gram(U_, mesh_.weight.cwiseProduct(c));
  MV_ = gram(V_, mesh_.weight.cwiseProduct(c));
  if (std::abs(mesh_.x_m) < 1e-14 * m) {  // a level cable: what couples the parities is rounding
    const auto even = indices(1.0, Parity::symmetric), odd = indices(1.0, Parity::antisymmetric);
    for (const int i : even)
      for (const int j : odd)
        for (Matrix* a : {&KF_, &KR_, &MU_, &MV_}) (*a)(i, j) = (*a)(j, i) = 0.0;
  }
}

Vector InPlaneGalerkin::scale(double kappa, int order) const {
  require(kappa >= 0.0 && std::isfinite(kappa), "the flexibility kappa must be >= 0");
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
  const int n = size(kappa);
  return scaled(KF_, kappa, 0) + KR_.topLeftCorner(n, n);
}

Matrix InPlaneGalerkin::mass(double kappa, double tangential, double normal) const {
  return tangential * scaled(MU_, kappa, 0) + normal * scaled(MV_, kappa, 0);
}

Matrix InPlaneGalerkin::stiffness_slope(double kappa, int order) const { return scaled(KF_, kappa, order); }
Matrix InPlaneGalerkin::mass_slope(double kappa, int order) const { return scaled(MU_, kappa, order) + scaled(MV_, kappa, order); }

Matrix InPlaneGalerkin::lift_stiffness(double kappa) const { return scale(kappa).asDiagonal() * KF_.topRightCorner(size(kappa), lifts); }

Matrix InPlaneGalerkin::lift_mass(double kappa, double tangential, double normal) const {
  const int n = size(kappa);
  return scale(kappa).asDiagonal() * (tangential * MU_.topRightCorner(n, lifts) + normal * MV_.topRightCorner(n, lifts));
}

std::vector<int> InPlaneGalerkin::indices(double kappa, Parity parity) const {
  std::vector<int> chosen;
  for (int i = 0; i < size(kappa); ++i) {
    const int k = i == 2 * n_ ? 0 : i % n_ + 1;
    if (parity == Parity::both || (k % 2 == 0) == (parity == Parity::symmetric)) chosen.push_back(i);
  }
  return chosen;
}

LateralGalerkin::LateralGalerkin(double x1, double x2, int n) : mesh_(x1, x2, n) {
  const double m = mesh_.m;
  const auto points = mesh_.t.size();
  W_.resize(points, n + 2);
  slope_.resize(points, n + 2);
  W_.leftCols(n) = std::sqrt(m) * dirichlet_values(mesh_.legendre, n);
  slope_.leftCols(n) = dirichlet_slopes(mesh_.legendre, n) / std::sqrt(m);
  W_.col(n) = 0.5 * (1.0 - mesh_.t.array());
  W_.col(n + 1) = 0.5 * (1.0 + mesh_.t.array());
  slope_.col(n).setConstant(-0.5 / m);
  slope_.col(n + 1).setConstant(0.5 / m);
  const Matrix M = W_.transpose() * mesh_.weight.cwiseProduct(mesh_.c).asDiagonal() * W_, K = slope_.transpose() * mesh_.weight.asDiagonal() * slope_;
  M_ = M.topLeftCorner(n, n);
  M_lift_ = M.topRightCorner(n, 2);
  K_ = Matrix::Identity(n, n);
  K_lift_ = K.topRightCorner(n, 2);
}

std::vector<int> LateralGalerkin::indices(Parity parity) const {
  std::vector<int> chosen;
  for (int k = 0; k < size(); ++k)
    if (parity == Parity::both || (k % 2 == 0) == (parity == Parity::symmetric)) chosen.push_back(k);
  return chosen;
}

Matrix pick(const Matrix& a, const std::vector<int>& rows, const std::vector<int>& columns) {
  Matrix b(rows.size(), columns.size());
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (std::size_t i = 0; i < rows.size(); ++i) b(i, j) = a(rows[i], columns[j]);
  return b;
}

}  // namespace whirl::models::catenary
