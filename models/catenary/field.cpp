#include "models/catenary/field.hpp"

#include <algorithm>
#include <cmath>

namespace whirl::models::catenary {
namespace {

// The places t where the travel time has gone through the shares 0.5 (1 + mesh.t) of the whole.
Vector even_in_travel_time(const Mesh& mesh) {
  const auto n = static_cast<int>(mesh.t.size());
  const Vector rate = mesh.c.cwiseSqrt().cwiseProduct(mesh.J), a = mesh.project(rate);  // d tau/dt
  const Vector passed = legendre_integrals(mesh.legendre, n - 1) * a.head(n - 1), wanted = a[0] * (1.0 + mesh.t.array());
  Vector t(n);
  for (int i = 0, k = 0; i < n; ++i) {  // between two points of the mesh, then by Newton
    while (k + 1 < n && passed[k] < wanted[i]) ++k;
    const int j = std::max(k, 1);
    const double part = (wanted[i] - passed[j - 1]) / (passed[j] - passed[j - 1]);
    t[i] = mesh.t[j - 1] + part * (mesh.t[j] - mesh.t[j - 1]);
  }
  const Coordinate& map = mesh.coordinate;
  for (int step = 0; step < 10; ++step) {
    t = t.cwiseMax(-1.0).cwiseMin(1.0);
    const Vector at = legendre_integrals(legendre_values(t, n), n - 1) * a.head(n - 1);
    double largest = 0.0;
    for (int i = 0; i < n; ++i) {
      const double x = map.x(t[i]), change = (wanted[i] - at[i]) / (std::sqrt(std::cosh(x)) * map.slope(x));
      t[i] += change;
      largest = std::max(largest, std::abs(change));
    }
    if (largest < 1e-7) break;  // its square counts
  }
  return t.cwiseMax(-1.0).cwiseMin(1.0);
}

}  // namespace

Mirror::Mirror(const Mesh& mesh) {
  const bool level = mesh.coordinate.level();  // parity in t will do
  weight_ = level ? Vector(mesh.weight.cwiseProduct(mesh.c.cwiseSqrt())) : mesh.gauss;
  const Vector t = level ? mesh.t : even_in_travel_time(mesh);
  amplitude_ = t.unaryExpr([&](double s) { return std::sqrt(std::sqrt(std::cosh(mesh.coordinate.x(s)))); });
  legendre_ = legendre_values(t, static_cast<int>(t.size()));
}

}  // namespace whirl::models::catenary
