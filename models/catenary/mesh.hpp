#pragma once
/// Where the discretisations of a hanging cable live: a graded coordinate, Gauss points in it, and projection on Legendre polynomials.
///
/// Solutions in plane are analytic in x but for x = +-i pi/2 (and beyond), where cosh x = 0: as the cable gets deeper its bottom becomes a narrow
/// layer, and polynomials in x converge as slowly as that is narrow. The coordinate t in [-1, 1] widens it,
///
///     x = (pi/2) sinh(beta + alpha t),     J = dx/dt = (pi/2) alpha cosh(beta + alpha t)
///
/// and carries the singularity to beta + alpha t = +-i pi/2: at b/2a = 3.5 half as many polynomials do. A level cable has beta = 0: parity in x is
/// parity in t. A taut one has J = b/2a, nearly.
///
///     Mesh mesh(x1, x2, 40);
///     double length = mesh.weight.dot(mesh.c);         // int cosh x dx
///
/// Throws std::invalid_argument for fewer than 2 functions or x1 >= x2.

#include <cmath>

#include "core/legendre.hpp"

namespace whirl::models::catenary {

class Coordinate {
 public:
  Coordinate() = default;
  Coordinate(double x1, double x2);
  double x1() const { return x1_; }
  double x2() const { return x2_; }
  double alpha() const { return alpha_; }
  double beta() const { return beta_; }
  bool level() const { return beta_ == 0.0; }  ///< ends at one height
  double x(double t) const { return std::min(std::max(scale * std::sinh(beta_ + alpha_ * t), x1_), x2_); }
  double slope(double t) const { return scale * alpha_ * std::cosh(beta_ + alpha_ * t); }  ///< J
  double t(double x) const { return (std::asinh(x / scale) - beta_) / alpha_; }
  static constexpr double scale = 1.57079632679489662;  ///< pi/2

 private:
  double x1_ = 0.0, x2_ = 0.0, alpha_ = 1.0, beta_ = 0.0;
};

/// Quadrature that integrates products of two functions of a discretisation of n to rounding.
struct Mesh {
  Mesh(double x1, double x2, int n);
  Coordinate coordinate;
  double x1, x2, m;
  Vector t, gauss;      ///< points in [-1, 1] and weights of dt
  Vector x, weight, c;  ///< points in [x1, x2], weights of dx, cosh x
  Vector J, J_t;        ///< dx/dt and its slope
  Matrix legendre;      ///< P_0 ... at the points, one column each
  /// Legendre coefficients in t of functions known at the points, one column each.
  template <class Derived>
  typename Derived::PlainObject project(const Eigen::MatrixBase<Derived>& values) const {
    using S = typename Derived::Scalar;
    typename Derived::PlainObject a = legendre.transpose().template cast<S>() * (gauss.template cast<S>().asDiagonal() * values);
    for (Eigen::Index k = 0; k < a.rows(); ++k) a.row(k) *= 0.5 * (2.0 * static_cast<double>(k) + 1.0);
    return a;
  }
};

}  // namespace whirl::models::catenary
