#include "models/guy/mode_count.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "models/guy/guy_matrices.hpp"

namespace whirl::models::guy {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int degree = 12;

// Dynamic stiffness of an element at its two ends, order (lower, upper): K_ee - K_ei K_ii^-1 K_ie.
MatrixXd element(const Statics& g, Plane plane, double from, double to, double lambda) {
  const GuyMatrices m(g, from, to, degree);
  const int components = plane == Plane::in_plane ? 2 : 1;
  const Index n = degree + 1, inner = degree - 1;
  const MatrixXd& stiffness = plane == Plane::in_plane ? m.in_plane : m.out_of_plane;
  MatrixXd ee(2 * components, 2 * components), ei(2 * components, components * inner), ii(components * inner, components * inner);
  for (int a = 0; a < components; ++a)
    for (int b = 0; b < components; ++b) {
      MatrixXd k = stiffness.block(a * n, b * n, n, n);
      if (a == b) k -= lambda * m.mass;
      const auto end = [&](int e) { return e == 0 ? Index{degree} : Index{0}; };
      for (int e = 0; e < 2; ++e) {
        for (int f = 0; f < 2; ++f) ee(e * components + a, f * components + b) = k(end(e), end(f));
        ei.row(e * components + a).segment(b * inner, inner) = k.row(end(e)).segment(1, inner);
      }
      ii.block(a * inner, b * inner, inner, inner) = k.block(1, 1, inner, inner);
    }
  const Eigen::LLT<MatrixXd> factor(ii);
  if (factor.info() != Eigen::Success) throw std::logic_error("mode count: an element has a mode of its own below the frequency");
  return ee - ei * factor.solve(ei.transpose());
}

int negative(const MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(symmetric, Eigen::EigenvaluesOnly);
  return static_cast<int>((eigen.eigenvalues().array() < 0.0).count());
}

// b grows with T, and T is least where the guy is level, or at an end.
double smallest_stiffness(const Statics& g) {
  const double lowest = std::clamp(-g.vertical_tension / g.guy.weight(), 0.0, g.unstressed_length);
  return local_stiffness(g, lowest).b;
}

}  // namespace

int modes_below(const Statics& g, Plane plane, double frequency) {
  require_exact(g, "mode count");
  if (!(frequency > 0.0) || !std::isfinite(frequency))
    throw std::invalid_argument(fmt::format("mode count: frequency must be > 0, got {:g}", frequency));
  const double longest = std::numbers::pi / frequency * std::sqrt(smallest_stiffness(g) / g.guy.mass_per_length);
  const double by_slackness = 8.0 * g.horizontal_tension / g.guy.weight();  // keeps degree 12 exact for slack guys
  const int elements = 2 + static_cast<int>(std::ceil(g.unstressed_length / std::min(0.6 * longest, by_slackness)));
  const int c = plane == Plane::in_plane ? 2 : 1;
  const double lambda = frequency * frequency, size = g.unstressed_length / elements;
  int count = 0;
  MatrixXd pivot, below;  // pivot of the cut under way, its coupling to the next
  for (int e = 0; e < elements; ++e) {
    const MatrixXd k = element(g, plane, e * size, (e + 1) * size, lambda);
    if (e > 0) {
      pivot += k.topLeftCorner(c, c);
      count += negative(pivot);
      const MatrixXd next = k.bottomRightCorner(c, c) - k.bottomLeftCorner(c, c) * pivot.partialPivLu().solve(MatrixXd(k.topRightCorner(c, c)));
      pivot = next;
    } else {
      pivot = k.bottomRightCorner(c, c);
    }
  }
  return count;
}

}  // namespace whirl::models::guy
