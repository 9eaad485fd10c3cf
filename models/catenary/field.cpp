#include "models/catenary/field.hpp"

#include <cmath>

namespace whirl::models::catenary {

Mirror::Mirror(const Mesh& mesh) {
  const auto n = mesh.t.size();
  const Vector a = mesh.project<double>(mesh.c.cwiseSqrt());
  const auto travel = [&](In t) -> Vector { return legendre_integrals(legendre_values(t, static_cast<int>(n) + 1), static_cast<int>(n)) * a; };
  const double half = 0.5 * travel(Vector::Ones(1))[0];
  // The points of the mesh carried over to tau, then back to t by Newton; d tau/dt is sqrt(c) in units of m.
  const Vector tau = half * (1.0 + mesh.t.array());
  Vector t = mesh.t, c;
  for (int step = 0; step < 50; ++step) {
    c = (mesh.x_m + mesh.m * t.array()).cosh();
    const Vector change = (travel(t) - tau).cwiseQuotient(c.cwiseSqrt());
    t = (t - change).cwiseMax(-1.0).cwiseMin(1.0);
    if (change.cwiseAbs().maxCoeff() < 1e-13) break;
  }
  c = (mesh.x_m + mesh.m * t.array()).cosh();
  weight_ = mesh.weight;
  amplitude_ = c.array().sqrt().sqrt();
  legendre_ = legendre_values(t, static_cast<int>(n));
}

}  // namespace whirl::models::catenary
