#include "models/catenary/cable.hpp"

#include <fmt/format.h>

#include <cmath>

namespace whirl::models::catenary {
namespace {

void require(bool right, const char* what, double got) {
  if (!right) throw std::invalid_argument(fmt::format("{}, got {:g}", what, got));
}

}  // namespace

double horizontal_tension(const HangingCable& c) { return c.mass_per_length * c.gravity * c.shape.a; }
double frequency_unit(const HangingCable& c) { return std::sqrt(c.gravity / c.shape.a); }

CoreCable core_of(const HangingCable& c) {
  require(c.mass_per_length > 0.0 && std::isfinite(c.mass_per_length), "the mass per length must be > 0", c.mass_per_length);
  require(c.gravity > 0.0 && std::isfinite(c.gravity), "gravity must be > 0", c.gravity);
  require(c.axial_stiffness > 0.0, "the axial stiffness must be > 0", c.axial_stiffness);
  for (const double drag : {c.drag_tangential, c.drag_normal, c.drag_lateral})
    require(drag >= 0.0 && std::isfinite(drag), "a drag must be >= 0", drag);
  const double eta = 1.0 / (c.mass_per_length * frequency_unit(c));
  return {c.shape.x1, c.shape.x2, horizontal_tension(c) / c.axial_stiffness, eta * c.drag_tangential, eta * c.drag_normal, eta * c.drag_lateral};
}

double irvine_lambda2(const Geometry& g, double kappa) { return 4.0 * g.m * g.m * 2.0 * g.m / (g.effective_length() * kappa); }

double pendulum_estimate(const Geometry& g) {
  const Mesh mesh(g.x1, g.x2, 24);
  const double y1 = std::cosh(g.x1), slope = (std::cosh(g.x2) - y1) / (g.x2 - g.x1);
  const Vector below = (y1 + slope * (mesh.x.array() - g.x1)).matrix() - mesh.c, w = mesh.weight.cwiseProduct(mesh.c);
  return std::sqrt(w.dot(below) / w.dot(below.cwiseAbs2()));  // z = below / sqrt(1 + slope^2): both inclination factors cancel
}

}  // namespace whirl::models::catenary
