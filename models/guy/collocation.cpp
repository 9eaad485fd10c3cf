#include "models/guy/collocation.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/chebyshev.hpp"
#include "models/guy/guy_matrices.hpp"

namespace whirl::models::guy {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Force operator F = D u' at the points, and (D u')' = derivative * F; blocks xx, xy, yx, yy in plane.
struct Operator {
  MatrixXd force, second;
};

Operator collocated(const Statics& g, Plane plane, int n) {
  require_exact(g, "guy collocation");
  if (n < 2) throw std::invalid_argument(fmt::format("guy collocation: n must be >= 2, got {}", n));
  const ChebyshevGrid grid(n, 0.0, g.unstressed_length);
  const Index N = n + 1;
  VectorXd xx(N), xy(N), yy(N), b(N);
  for (Index i = 0; i < N; ++i) {
    const LocalStiffness d = local_stiffness(g, grid.nodes[i]);
    xx[i] = d.xx, xy[i] = d.xy, yy[i] = d.yy, b[i] = d.b;
  }
  const MatrixXd& D = grid.derivative;
  if (plane == Plane::out_of_plane) return {b.asDiagonal() * D, D * (b.asDiagonal() * D)};
  Operator op{MatrixXd(2 * N, 2 * N), MatrixXd(2 * N, 2 * N)};
  op.force << xx.asDiagonal() * D, xy.asDiagonal() * D, xy.asDiagonal() * D, yy.asDiagonal() * D;
  op.second.topRows(N) = D * op.force.topRows(N);
  op.second.bottomRows(N) = D * op.force.bottomRows(N);
  return op;
}

// Unit motion of each component of the upper end, the forces there.
MatrixXcd end_stiffness(const Operator& op, int components, double mass, std::complex<double> pe2) {
  const Index N = op.force.rows() / components;
  MatrixXcd A = op.second.cast<std::complex<double>>(), rhs = MatrixXcd::Zero(A.rows(), components);
  A.diagonal().array() += mass * pe2;
  for (int c = 0; c < components; ++c)
    for (const Index row : {c * N, c * N + N - 1}) {
      A.row(row).setZero();
      A(row, row) = 1.0;
      if (row != c * N) rhs(row, c) = 1.0;
    }
  const MatrixXcd forces = op.force.cast<std::complex<double>>() * A.partialPivLu().solve(rhs);
  MatrixXcd k(components, components);
  for (int c = 0; c < components; ++c) k.row(c) = forces.row(c * N + N - 1);
  return k;
}

}  // namespace

StiffnessMatrix collocated_stiffness(const Statics& g, double p, double damping_rate, int n) {
  if (!(p >= 0.0) || !(damping_rate >= 0.0))
    throw std::invalid_argument(fmt::format("guy stiffness: frequency and damping must be >= 0, got {:g} and {:g}", p, damping_rate));
  const std::complex<double> pe2(p * p, -p * damping_rate);
  const MatrixXcd in = end_stiffness(collocated(g, Plane::in_plane, n), 2, g.guy.mass_per_length, pe2);
  const MatrixXcd out = end_stiffness(collocated(g, Plane::out_of_plane, n), 1, g.guy.mass_per_length, pe2);
  return {in(0, 0), 0.5 * (in(0, 1) + in(1, 0)), in(1, 1), out(0, 0)};
}

std::vector<double> collocated_frequencies(const Statics& g, Plane plane, int n) {
  const Operator op = collocated(g, plane, n);
  const int components = plane == Plane::in_plane ? 2 : 1;
  const Index N = n + 1, inner = N - 2;
  MatrixXd A(components * inner, components * inner);
  for (int a = 0; a < components; ++a)
    for (int b = 0; b < components; ++b) A.block(a * inner, b * inner, inner, inner) = op.second.block(a * N + 1, b * N + 1, inner, inner);
  const Eigen::EigenSolver<MatrixXd> eigen(A, false);
  std::vector<double> w;
  std::vector<std::complex<double>> all(eigen.eigenvalues().begin(), eigen.eigenvalues().end());
  std::sort(all.begin(), all.end(), [](auto a, auto b) { return std::abs(a) < std::abs(b); });
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto lambda = -all[i] / g.guy.mass_per_length;
    if (i < all.size() / 2 && !(lambda.real() > 0.0 && std::abs(lambda.imag()) < 1e-6 * lambda.real()))
      throw std::runtime_error("guy collocation: an eigenvalue is not real and positive; more points are needed");
    w.push_back(std::sqrt(std::abs(lambda)));
  }
  return w;
}

}  // namespace whirl::models::guy
