#include "models/catenary/mesh.hpp"

namespace whirl::models::catenary {
namespace {

// Functions reach degree n + 4 and are multiplied by cosh x, entire, and by powers of 1/c and 1/J, whose poles stand at +-i pi/(2 alpha).
int mesh_points(double alpha, int n) { return n + 20 + static_cast<int>(10.0 * alpha); }

void require(bool right, const char* what) {
  if (!right) throw std::invalid_argument(what);
}

}  // namespace

Coordinate::Coordinate(double x1, double x2) : x1_(x1), x2_(x2) {
  require(x1 < x2 && std::isfinite(x1) && std::isfinite(x2), "the ends of a cable must satisfy x1 < x2");
  const double a = std::asinh(x1 / scale), b = std::asinh(x2 / scale);
  alpha_ = 0.5 * (b - a);
  beta_ = std::abs(x1 + x2) < 1e-14 * (x2 - x1) ? 0.0 : 0.5 * (a + b);
}

Mesh::Mesh(double x1_, double x2_, int n) : coordinate(x1_, x2_), x1(x1_), x2(x2_), m(0.5 * (x2_ - x1_)) {
  require(n >= 2, "a discretisation has at least two functions");
  const double alpha = coordinate.alpha();
  const GaussRule rule = gauss_legendre(mesh_points(alpha, n));
  t = rule.nodes;
  gauss = rule.weights;
  const Eigen::ArrayXd sigma = coordinate.beta() + alpha * t.array(), sinh = sigma.sinh();
  x = (Coordinate::scale * sinh).cwiseMax(x1).cwiseMin(x2);
  J_t = Coordinate::scale * alpha * alpha * sinh;
  J = Coordinate::scale * alpha * (1.0 + sinh.square()).sqrt();
  weight = J.cwiseProduct(gauss);
  c = x.array().cosh();
  legendre = legendre_values(t, static_cast<int>(t.size()));
}

}  // namespace whirl::models::catenary
