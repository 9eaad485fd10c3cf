#pragma once
/// The largest displacement of a motion along the cable, between the points of the mesh too: the scale of modes.
///
/// Where a sampled value tops its neighbours the core system gives slope and curvature of |U|^2 + |V|^2 (or W^2) there, without differences: two
/// steps of Newton's method. Humps that are less than 0.8 of the highest sample are passed over.
///
///     double scale = largest_displacement<double>(mesh, field, nodal, kappa, L1, L2);

#include "models/catenary/field.hpp"

namespace whirl::models::catenary {

/// A function to be made largest with its first two derivatives.
struct Hump {
  double value, slope, curvature;
};

/// Square root of the largest value; `samples` are those at the mesh points, `at(x)` gives a Hump.
template <class At>
double largest_of_humps(const Mesh& mesh, const Vector& samples, At&& at) {
  double top = samples.maxCoeff();
  const double enough = 0.64 * top;
  for (Eigen::Index i = 1; i + 1 < samples.size(); ++i) {
    if (samples[i] < enough || samples[i] < samples[i - 1] || samples[i] < samples[i + 1]) continue;
    double x = mesh.x[i];
    for (int step = 0; step < 3; ++step) {
      const Hump h = at(x);
      top = std::max(top, h.value);
      const double move = -h.slope / h.curvature;
      if (!(h.curvature < 0.0 && x + move > mesh.x[i - 1] && x + move < mesh.x[i + 1])) break;
      x += move;
      const double above = 0.5 * h.slope * move;  // what the next step finds, to the third power of the move
      if (above < 1e-6 * h.value) {
        top = std::max(top, h.value + above);
        break;
      }
    }
  }
  return std::sqrt(top);
}

template <class S>
double largest_displacement(const Mesh& mesh, const Field<S>& f, const InPlaneGalerkin::Nodal<S>& nodal, double kappa, S L1, S L2) {
  const auto product = [](S a, S b) { return std::real(std::conj(std::complex<double>(a)) * std::complex<double>(b)); };
  return largest_of_humps(mesh, nodal.U.cwiseAbs2() + nodal.V.cwiseAbs2(), [&](double x) -> Hump {
    const double c = std::cosh(x), s = std::sinh(x);
    const auto [U, V, N, T] = f.template first_at<4>(x);
    const S U_x = V / c + kappa * c * T, V_x = N - U / c, T_x = L1 * c * U + N / c;
    const S U_xx = V_x / c - V * (s / (c * c)) + kappa * (s * T + c * T_x), V_xx = L2 * c * V - T / c - U_x / c + U * (s / (c * c));
    return {product(U, U) + product(V, V), 2.0 * (product(U, U_x) + product(V, V_x)),
            2.0 * (product(U_x, U_x) + product(V_x, V_x) + product(U, U_xx) + product(V, V_xx))};
  });
}

/// Out of plane: W_xx = L3 c W.
inline double largest_lateral(const Mesh& mesh, const Field<double>& f, const Vector& W, double L3) {
  return largest_of_humps(mesh, W.cwiseAbs2(), [&](double x) -> Hump {
    const auto [w, slope] = f.first_at<2>(x);
    return {w * w, 2.0 * w * slope, 2.0 * (slope * slope + L3 * std::cosh(x) * w * w)};
  });
}

/// -1 where a motion leaves the lower end downwards, else 1.
inline double sign_at_lower_end(const Vector& values) {
  Eigen::Index i = 0;
  const double small = 1e-3 * values.cwiseAbs().maxCoeff();
  while (i + 1 < values.size() && std::abs(values[i]) < small) ++i;
  return values[i] < 0.0 ? -1.0 : 1.0;
}

}  // namespace whirl::models::catenary
