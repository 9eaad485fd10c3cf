#pragma once
/// Where the discretisations of a hanging cable live: a graded coordinate, Gauss points in it, and projection on Legendre polynomials.
///
/// Motion in plane is analytic in x but for x = +-i pi/2 (and beyond), where cosh x = 0: the deeper the cable, the narrower the layer at its bottom,
/// and the denser the waves at its ends, where they travel with the speed 1/sqrt(cosh x). The coordinate t in [-1, 1] stretches both,
///
///     alpha t + beta = asinh(2 x/pi) + B sinh(x/2),     J = dx/dt
///
/// so that 60 polynomials resolve eight modes where 300 in x are needed (ends at x = +-14), 50 where 75 are (+-3.5). B leaves the second term at most
/// 0.6 at an end. A level cable has beta = 0: parity in x is parity in t. For a taut one J = b/2a, nearly.
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
  bool level() const { return beta_ == 0.0; }  ///< ends at one height
  double t(double x) const { return (stretched(x) - beta_) / alpha_; }
  double x(double t) const;  ///< by Newton's method
  /// J and dJ/dt at x.
  double slope(double x) const { return alpha_ / (1.0 / std::hypot(x, layer) + 0.5 * B_ * std::cosh(0.5 * x)); }
  double curvature(double x) const;
  /// rho: coefficients of a function that is singular at x = i pi/2 fall as rho^-k.
  double growth() const;

 private:
  static constexpr double layer = 1.57079632679489662;  // pi/2
  double stretched(double x) const { return std::asinh(x / layer) + B_ * std::sinh(0.5 * x); }

  double x1_ = 0.0, x2_ = 0.0, B_ = 0.0, alpha_ = 1.0, beta_ = 0.0;
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
