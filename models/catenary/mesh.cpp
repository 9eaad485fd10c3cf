#include "models/catenary/mesh.hpp"

#include <complex>
#include <numbers>

namespace whirl::models::catenary {
namespace {

// Functions reach degree n + 4 and are multiplied by powers of cosh x and J, resolved by a few polynomials more.
int mesh_points(int n) { return n + 20; }

void require(bool right, const char* what) {
  if (!right) throw std::invalid_argument(what);
}

}  // namespace

Coordinate::Coordinate(double x1, double x2) : x1_(x1), x2_(x2) {
  require(x1 < x2 && std::isfinite(x1) && std::isfinite(x2), "the ends of a cable must satisfy x1 < x2");
  B_ = std::min(0.5, 0.6 / std::sinh(0.5 * std::max(std::abs(x1), std::abs(x2))));
  alpha_ = 0.5 * (stretched(x2) - stretched(x1));
  beta_ = std::abs(x1 + x2) < 1e-14 * (x2 - x1) ? 0.0 : 0.5 * (stretched(x1) + stretched(x2));
}

double Coordinate::x(double t) const {
  const double wanted = beta_ + alpha_ * t, size = std::abs(wanted);
  double lower = 0.0, upper = std::min(layer * std::sinh(size), 2.0 * std::asinh(size / B_)), s = upper;  // each term alone
  for (int i = 0; i < 60; ++i) {
    const double excess = stretched(s) - size;
    (excess > 0.0 ? upper : lower) = s;
    double next = s - excess * slope(s) / alpha_;
    if (!(next >= lower && next <= upper)) next = 0.5 * (lower + upper);
    const double change = std::abs(next - s);
    s = next;
    if (change < 1e-9 * (1.0 + s)) break;  // its square is below rounding
  }
  return std::min(std::max(std::copysign(s, wanted), x1_), x2_);
}

double Coordinate::growth() const {
  const std::complex<double> z((-beta_) / alpha_, (layer + B_ * std::numbers::sqrt2 / 2.0) / alpha_);  // asinh i = i pi/2, sinh(i pi/4) = i/sqrt 2
  const std::complex<double> root = std::sqrt(z - 1.0) * std::sqrt(z + 1.0);
  return std::abs(z + root);
}

double Coordinate::curvature(double x) const {
  const double J = slope(x), h = std::hypot(x, layer);
  return J * J * J / alpha_ * (x / (h * h * h) - 0.25 * B_ * std::sinh(0.5 * x));
}

Mesh::Mesh(double x1_, double x2_, int n) : coordinate(x1_, x2_), x1(x1_), x2(x2_), m(0.5 * (x2_ - x1_)) {
  require(n >= 2, "a discretisation has at least two functions");
  const GaussRule rule = gauss_legendre(mesh_points(n));
  t = rule.nodes;
  gauss = rule.weights;
  x = t.unaryExpr([this](double s) { return coordinate.x(s); });
  J = x.unaryExpr([this](double s) { return coordinate.slope(s); });
  J_t = x.unaryExpr([this](double s) { return coordinate.curvature(s); });
  weight = J.cwiseProduct(gauss);
  c = x.array().cosh();
  legendre = legendre_values(t, static_cast<int>(t.size()));
}

}  // namespace whirl::models::catenary
