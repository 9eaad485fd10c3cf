#pragma once
/// Displacements and forces along the cable as Legendre series in the graded coordinate of mesh.hpp: known at any point, not only where they were
/// computed.
///
/// In plane the columns are U, V, N, T; N/c is the change of slope. Out of plane they are W, W_x. Real for modes, complex for damped modes and
/// forced motion. Units as in galerkin.hpp: displacements in a, forces in H.
///
///     Field<double> f = ...;
///     auto v = f.at(x, Quantity::V);                 // x between the ends

#include <array>

#include "models/catenary/galerkin.hpp"

namespace whirl::models::catenary {

enum class Quantity { U = 0, V = 1, N = 2, T = 3, W = 0, W_slope = 1 };

template <class S>
using ColumnVector = Eigen::Matrix<S, Eigen::Dynamic, 1>;

template <class S>
struct Field {
  Coordinate coordinate;
  Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic> coefficients;  ///< Legendre coefficients, one column a quantity

  ColumnVector<S> at(In x, Quantity quantity) const { return table(x).template cast<S>() * coefficients.col(static_cast<int>(quantity)); }
  /// All columns at the points x.
  Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic> at(In x) const { return table(x).template cast<S>() * coefficients; }
  /// One point, by Clenshaw's recurrence: nothing is allocated.
  S at(double x, Quantity quantity) const {
    std::array<S, 1> value;
    clenshaw(coordinate.t(x), coefficients.data() + static_cast<int>(quantity) * coefficients.rows(), value);
    return value[0];
  }
  /// The first `columns` quantities at one point.
  template <std::size_t columns>
  std::array<S, columns> first_at(double x) const {
    std::array<S, columns> values;
    clenshaw(coordinate.t(x), coefficients.data(), values);
    return values;
  }

 private:
  template <std::size_t columns>
  void clenshaw(double t, const S* a, std::array<S, columns>& values) const {
    const auto rows = coefficients.rows();
    std::array<S, columns> b1{}, b2{};
    for (Eigen::Index k = rows - 1; k > 0; --k) {
      const double n = static_cast<double>(k), first = (2.0 * n + 1.0) / (n + 1.0) * t, second = (n + 1.0) / (n + 2.0);
      for (std::size_t j = 0; j < columns; ++j) {
        const S b = a[k + Eigen::Index(j) * rows] + first * b1[j] - second * b2[j];
        b2[j] = b1[j];
        b1[j] = b;
      }
    }
    for (std::size_t j = 0; j < columns; ++j) values[j] = a[Eigen::Index(j) * rows] + t * b1[j] - 0.5 * b2[j];
  }
  Matrix table(In x) const {
    return legendre_values(x.unaryExpr([this](double s) { return coordinate.t(s); }), static_cast<int>(coefficients.rows()));
  }
};

/// The field behind U, V, N at the mesh points. The tension follows from the balance along the cable, its constant from the balance across:
///
///     T_x = L1 c U + N/c,     int [N p_x + (L2 c V - T/c) p] dx = 0 with p = phi_0
///
/// so that it is as accurate for an inextensible cable, whose tension is a reaction.
template <class S>
Field<S> field_of(const Mesh& mesh, const InPlaneGalerkin::Nodal<S>& at, S L1, S L2) {
  const auto n = mesh.t.size();
  Field<S> f{mesh.coordinate, {}};
  f.coefficients.resize(n, 4);
  f.coefficients.col(0) = at.U;
  f.coefficients.col(1) = at.V;
  f.coefficients.col(2) = at.N;
  const Vector cJ = mesh.c.cwiseProduct(mesh.J), Jc = mesh.J.cwiseQuotient(mesh.c);
  f.coefficients.col(3) = L1 * cJ.template cast<S>().cwiseProduct(at.U) + Jc.template cast<S>().cwiseProduct(at.N);  // T_t
  f.coefficients = mesh.project(f.coefficients);
  ColumnVector<S> T = ColumnVector<S>::Zero(n);
  for (Eigen::Index k = 0; k + 1 < n; ++k) {  // int P_k = (P_{k+1} - P_{k-1}) / (2 k + 1)
    const S part = f.coefficients(k, 3) / (2.0 * static_cast<double>(k) + 1.0);
    T[k + 1] += part;
    T[k == 0 ? 0 : k - 1] += k == 0 ? part : -part;
  }
  const Vector p = mesh.weight.array() * (1.0 - mesh.t.array().square());
  const Vector p_over_c = p.cwiseQuotient(mesh.c), pc = p.cwiseProduct(mesh.c), px = -2.0 * mesh.gauss.cwiseProduct(mesh.t);
  const Vector T_weight = mesh.legendre.transpose() * p_over_c;
  const S across = L2 * (pc.template cast<S>().transpose() * at.V)(0) + (px.template cast<S>().transpose() * at.N)(0);
  T[0] += (across - (T_weight.template cast<S>().transpose() * T)(0)) / p_over_c.sum();
  f.coefficients.col(3) = T;
  return f;
}

/// Parity of a motion on a cable that is not symmetric itself, told in the travel time of a transverse wave, tau = int sqrt(cosh x) dx, with the
/// amplitude such a wave keeps, V (cosh x)^(1/4): short waves are symmetric or antisymmetric about the middle in tau on any cable.
class Mirror {
 public:
  explicit Mirror(const Mesh& mesh);
  /// Share of int sqrt(c) V^2 dtau in the odd part: 0 symmetric, 1 antisymmetric.
  template <class S>
  double odd_share(const Field<S>& f, Quantity quantity) const {
    const ColumnVector<S> v = legendre_.leftCols(f.coefficients.rows()).template cast<S>() * f.coefficients.col(static_cast<int>(quantity));
    double odd = 0.0, all = 0.0;
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      const S here = amplitude_[i] * v[i], there = amplitude_[v.size() - 1 - i] * v[v.size() - 1 - i];
      odd += weight_[i] * std::norm(std::complex<double>(0.5 * (here - there)));
      all += weight_[i] * std::norm(std::complex<double>(here));
    }
    return all > 0.0 ? odd / all : 0.0;
  }

 private:
  Vector weight_, amplitude_;
  Matrix legendre_;
};

}  // namespace whirl::models::catenary
