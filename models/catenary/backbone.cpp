#include "models/catenary/backbone.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "core/symmetric_pencil.hpp"

namespace whirl::models::catenary {
namespace {

Field<double> displacements(const InPlaneGalerkin& g, double kappa, const Vector& q) {
  const auto at = g.nodal<double>(kappa, q, Eigen::Vector4d::Zero());
  Field<double> f{g.mesh().coordinate, Matrix(at.U.size(), 2)};
  f.coefficients.col(0) = g.mesh().project(at.U);
  f.coefficients.col(1) = g.mesh().project(at.V);
  return f;
}

}  // namespace

Backbone lateral_backbone(const CoreCable& c, int mode) {
  if (!(c.kappa > 0.0)) throw std::invalid_argument("a backbone needs a flexibility kappa > 0; 1e-7 stands for an inextensible cable");
  if (mode < 1) throw std::invalid_argument(fmt::format("modes are numbered from 1, got {}", mode));
  const Mode swing = out_of_plane_modes(c, {.count = mode, .verify = false}).modes[static_cast<std::size_t>(mode) - 1];
  // G has twice the waves of the mode, and so has what it drives.
  const InPlaneGalerkin g(c.x1, c.x2, functions_for(c, 2 * mode + 8) + 8);
  const Mesh& mesh = g.mesh();
  const Vector slope = swing.field.at(mesh.x, Quantity::W_slope), G = 0.5 * slope.cwiseAbs2().cwiseQuotient(mesh.c);
  const Vector stiff = (mesh.c.cwiseInverse() / c.kappa).array() - 1.0;  // (EA - T0)/H per dx
  const Vector weighted = mesh.weight.cwiseProduct(stiff).cwiseProduct(G);
  const Vector f = std::sqrt(c.kappa) * (g.R().transpose() * weighted);  // U_x - V/c = s R
  const double E = 0.5 * weighted.dot(G), w2 = swing.omega * swing.omega;
  const Matrix K = g.stiffness(c.kappa), M = g.mass(c.kappa);
  const Vector steady = K.partialPivLu().solve(-0.5 * f), twice = (K - 4.0 * w2 * M).partialPivLu().solve(-0.5 * f);
  Backbone b;
  b.omega = swing.omega;
  b.curvature = (3.0 * E + 2.0 * f.dot(steady) + f.dot(twice)) / (2.0 * w2 * swing.modal_mass);
  b.steady = displacements(g, c.kappa, steady);
  b.twice = displacements(g, c.kappa, twice);
  b.direct = 3.0 * E / (2.0 * w2 * swing.modal_mass);
  b.detuning = 1.0;
  for (const double omega : lowest_modes(K, M, 2 * mode + 6, false).omega)
    b.detuning = std::min(b.detuning, std::abs(omega / (2.0 * swing.omega) - 1.0));
  return b;
}

}  // namespace whirl::models::catenary
