#include "models/guy/guy_matrices.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <stdexcept>

#include "models/guy/legendre_basis.hpp"

namespace whirl::models::guy {

void require_exact(const Statics& s, const char* who) {
  if (s.form != Form::exact) throw std::invalid_argument(fmt::format("{}: needs a static state of the exact form", who));
}

LocalStiffness local_stiffness(const Statics& g, double s) {
  const double H = g.horizontal_tension, V = g.vertical_tension + g.guy.weight() * s, T = std::hypot(H, V), AE = g.guy.axial_stiffness;
  const double ex = H / T, ey = V / T, b = T / (1.0 + T / AE);
  return {AE * ex * ex + b * ey * ey, (AE - b) * ex * ey, AE * ey * ey + b * ex * ex, b};
}

// T^2 = H^2 + (V + w s)^2 vanishes at s = (-V +- iH)/w: the Bernstein ellipse through that point sets the decay.
int degree_of_tension(const Statics& g) {
  const double w = g.guy.weight();
  const std::complex<double> s(-g.vertical_tension / w, g.horizontal_tension / w), z = 2.0 * s / g.unstressed_length - 1.0;
  const std::complex<double> root = std::sqrt(z * z - 1.0);
  const double rho = std::max(std::abs(z + root), std::abs(z - root));
  return static_cast<int>(std::ceil(36.0 / std::log(rho)));  // e^-36 = 2e-16
}

double travel_time(const Statics& g) {
  const GaussRule rule = gauss_legendre(20 + degree_of_tension(g));
  double sum = 0.0;
  for (Eigen::Index i = 0; i < rule.nodes.size(); ++i)
    sum += rule.weights[i] / std::sqrt(local_stiffness(g, 0.5 * g.unstressed_length * (1.0 + rule.nodes[i])).b);
  return 0.5 * g.unstressed_length * sum * std::sqrt(g.guy.mass_per_length);
}

GuyMatrices::GuyMatrices(const Statics& g, double from, double to, int degree) {
  require_exact(g, "guy matrices");
  if (!(from < to) || degree < 2) throw std::invalid_argument(fmt::format("guy matrices: needs from < to and degree >= 2, got {}", degree));
  const double half = 0.5 * (to - from), share = 2.0 * half / g.unstressed_length;
  const GaussRule rule = gauss_legendre(degree + 4 + static_cast<int>(std::ceil((share < 1.0 ? share + 0.2 : 1.0) * 0.6 * degree_of_tension(g))));
  const LegendreBasis basis(degree, rule.nodes);
  const Eigen::Index n = degree + 1, q = rule.nodes.size();
  Eigen::MatrixXd value(q, n), slope(q, n);
  value << basis.value, (0.5 * (1.0 - rule.nodes.array())).matrix();
  slope << basis.slope, Eigen::VectorXd::Constant(q, -0.5);
  Eigen::ArrayXd xx(q), xy(q), yy(q), b(q);
  for (Eigen::Index i = 0; i < q; ++i) {
    const LocalStiffness d = local_stiffness(g, from + half * (1.0 + rule.nodes[i]));
    xx[i] = d.xx, xy[i] = d.xy, yy[i] = d.yy, b[i] = d.b;
  }
  const auto form = [&](const Eigen::MatrixXd& f, const Eigen::ArrayXd& weight) -> Eigen::MatrixXd {
    return f.transpose() * (weight * rule.weights.array()).matrix().asDiagonal() * f;
  };
  in_plane.resize(2 * n, 2 * n);
  in_plane.topLeftCorner(n, n) = form(slope, xx / half);
  in_plane.topRightCorner(n, n) = form(slope, xy / half);
  in_plane.bottomLeftCorner(n, n) = in_plane.topRightCorner(n, n);  // symmetric already
  in_plane.bottomRightCorner(n, n) = form(slope, yy / half);
  out_of_plane = form(slope, b / half);
  mass = form(value, Eigen::ArrayXd::Constant(q, half * g.guy.mass_per_length));
}

}  // namespace whirl::models::guy
