#include "models/superharmonic.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace whirl::models {

void SuperharmonicOptions::validate() const {
  if (order < 2 || order > 50) throw std::invalid_argument(fmt::format("superharmonic order must be in 2..50, got {}", order));
}

SuperharmonicModel::SuperharmonicModel(const StayParameters<double>& stay, const SuperharmonicOptions& options, std::vector<Lens> lenses)
    : stay_(stay), options_(options), lenses_(std::move(lenses)), model_(stay_model(stay.cable, options.coefficients)) {
  options_.validate();
  for (const auto& lens : lenses_) {
    cable_moves_ = cable_moves_ || lens.affects_cable();
    StayParameters<double> probe{};
    lens.set(probe, 1.0);
    moves_.push_back({probe.damping_out_of_plane == 1.0, probe.damping_in_plane == 1.0, probe.support_amplitude == 1.0, probe.omega == 1.0});
  }
  cable_ = cable_numbers(stay.cable, model_);
}

SuperharmonicFlow::SuperharmonicFlow(const StayParameters<double>& stay, const SuperharmonicOptions& options, std::vector<Lens> lenses)
    : DualProblem(SuperharmonicModel(stay, options, lenses), 4, static_cast<int>(lenses.size()), true) {
  std::vector<std::string> names;
  for (const auto& lens : lenses) names.push_back(lens.name());
  name_parameters(names);
  add_reflection({Eigen::Vector4d(-1.0, -1.0, 1.0, 1.0), "WH"});
}

void SuperharmonicFlow::do_residual(In u, Out r) const {
  const auto c = model().coefficients<double>({u.data() + 4, static_cast<std::size_t>(parameters())});
  slow_flow<double, double>(c, u[0], u[1], u[2], u[3], {r.data(), 4});
}

template <int K, class R>
void SuperharmonicFlow::evaluate(const R* u, R* r, R* j) const {
  using P = Dual<R, K>;
  std::array<P, K> p;
  for (int i = 0; i < K; ++i) {
    p[std::size_t(i)] = P(u[4 + i]);
    p[std::size_t(i)].d[std::size_t(i)] = R(1.0);
  }
  const auto cp = model().coefficients<P>(p);
  const R &u1 = u[0], &v1 = u[1], &u2 = u[2], &v2 = u[3], scale = R(1.0) / cp.nw2.v;
  // 2 n w r is linear in the coefficients: d(2 n w r) = that of their slopes.
  const auto part = [&](auto pick) {
    return SlowFlowCoefficients<R>{R(1.0),           pick(cp.detuning1), pick(cp.detuning2), pick(cp.damping1), pick(cp.damping2),
                                   pick(cp.g1),      pick(cp.g2),        pick(cp.g3),        pick(cp.g4),       pick(cp.load_re),
                                   pick(cp.load_im), pick(cp.Z0_re),     pick(cp.Z0_im)};
  };
  slow_flow<R, R>(part([](const P& x) { return x.v; }), u1, v1, u2, v2, {r, 4});
  for (int row = 0; row < 4; ++row) r[row] = r[row] * scale;
  for (int i = 0; i < K; ++i) {
    R* column = j + 4 * (4 + i);
    const auto at = static_cast<std::size_t>(i);
    if (model().cable_moves()) {
      slow_flow<R, R>(part([at](const P& x) { return x.d[at]; }), u1, v1, u2, v2, {column, 4});
    } else {  // the cubic terms stay
      column[0] = -(u1 * cp.damping1.d[at]) - cp.detuning1.d[at] * v1;
      column[1] = -(v1 * cp.damping1.d[at]) + cp.detuning1.d[at] * u1;
      column[2] = -(u2 * cp.damping2.d[at]) - cp.detuning2.d[at] * v2 - cp.load_im.d[at];
      column[3] = -(v2 * cp.damping2.d[at]) + cp.detuning2.d[at] * u2 + cp.load_re.d[at];
    }
    for (int row = 0; row < 4; ++row) column[row] = (column[row] - r[row] * cp.nw2.d[at]) * scale;
  }
  const R &g1 = cp.g1.v, &g2 = cp.g2.v, &g3 = cp.g3.v, &g4 = cp.g4.v, &d1 = cp.damping1.v, &d2 = cp.damping2.v;
  const R a = u1 * u1 + v1 * v1, b = u2 * u2 + v2 * v2;
  const R s1 = u1 * u1 - v1 * v1, t1 = 2.0 * u1 * v1, s2 = u2 * u2 - v2 * v2, t2 = 2.0 * u2 * v2;
  const R m1 = cp.detuning1.v + g1 * a + 2.0 * g2 * b, m2 = cp.detuning2.v + g4 * b + 2.0 * g3 * a;
  // d/d(u1, v1) of the first pair; d/d(u2, v2) of the second likewise with the roles exchanged
  j[0] = scale * (-d1 - 2.0 * g1 * u1 * v1 - g2 * t2);
  j[4] = scale * (-m1 - 2.0 * g1 * v1 * v1 + g2 * s2);
  j[1] = scale * (m1 + 2.0 * g1 * u1 * u1 + g2 * s2);
  j[5] = scale * (-d1 + 2.0 * g1 * u1 * v1 + g2 * t2);
  j[8] = scale * (-4.0 * g2 * u2 * v1 - 2.0 * g2 * (v2 * u1 - u2 * v1));
  j[12] = scale * (-4.0 * g2 * v2 * v1 - 2.0 * g2 * (u2 * u1 + v2 * v1));
  j[9] = scale * (4.0 * g2 * u2 * u1 + 2.0 * g2 * (u2 * u1 + v2 * v1));
  j[13] = scale * (4.0 * g2 * v2 * u1 + 2.0 * g2 * (u2 * v1 - v2 * u1));
  j[10] = scale * (-d2 - 2.0 * g4 * u2 * v2 - g3 * t1);
  j[14] = scale * (-m2 - 2.0 * g4 * v2 * v2 + g3 * s1);
  j[11] = scale * (m2 + 2.0 * g4 * u2 * u2 + g3 * s1);
  j[15] = scale * (-d2 + 2.0 * g4 * u2 * v2 + g3 * t1);
  j[2] = scale * (-4.0 * g3 * u1 * v2 - 2.0 * g3 * (v1 * u2 - u1 * v2));
  j[6] = scale * (-4.0 * g3 * v1 * v2 - 2.0 * g3 * (u1 * u2 + v1 * v2));
  j[3] = scale * (4.0 * g3 * u1 * u2 + 2.0 * g3 * (u1 * u2 + v1 * v2));
  j[7] = scale * (4.0 * g3 * v1 * u2 + 2.0 * g3 * (u1 * v2 - v1 * u2));
}

template <int K>
void SuperharmonicFlow::field_and_jacobian(In u, double* r, MatrixOut j) const {
  double own[4 * (4 + K)];
  evaluate<K, double>(u.data(), r, own);
  for (int c = 0; c < 4 + K; ++c)
    for (int row = 0; row < 4; ++row) j(row, c) = own[row + 4 * c];
}

// The slope of the Jacobian along v.
template <int K>
void SuperharmonicFlow::second_along(In u, In v, MatrixOut h) const {
  using Line = Dual<double, 1>;
  Line at[4 + K], r[4], j[4 * (4 + K)];
  for (int i = 0; i < 4 + K; ++i) {
    at[i] = Line(u[i]);
    at[i].d[0] = v[i];
  }
  evaluate<K, Line>(at, r, j);
  for (int c = 0; c < 4 + K; ++c)
    for (int row = 0; row < 4; ++row) h(row, c) = j[row + 4 * c].d[0];
}

namespace {

// Calls f with the number of lenses as a constant.
template <class F>
void with_lenses(int count, F&& f) {
  switch (count) {
    case 0:
      return f(std::integral_constant<int, 0>());
    case 1:
      return f(std::integral_constant<int, 1>());
    case 2:
      return f(std::integral_constant<int, 2>());
    default:
      throw std::logic_error("at most two lenses");
  }
}

}  // namespace

void SuperharmonicFlow::do_linearise(In u, Out r, MatrixOut j) const {
  with_lenses(parameters(), [&](auto K) { field_and_jacobian<K()>(u, r.data(), j); });
}

void SuperharmonicFlow::do_second(In u, In v, MatrixOut h) const {
  with_lenses(parameters(), [&](auto K) { second_along<K()>(u, v, h); });
}

void SuperharmonicFlow::do_jacobian(In u, MatrixOut j) const {
  Eigen::Vector4d r;
  do_linearise(u, r, j);
}

Superharmonic SuperharmonicFlow::observe(In u) const {
  const auto c = model().coefficients<double>({u.data() + 4, static_cast<std::size_t>(parameters())});
  const double B0 = std::hypot(c.Z0_re, c.Z0_im);
  return {std::hypot(u[0], u[1]), std::hypot(u[2], u[3]), std::atan2(u[1], u[0]), std::atan2(u[3], u[2]), B0, std::atan2(c.Z0_im, c.Z0_re)};
}

Vector SuperharmonicFlow::motion(In u, double t) const {
  const auto c = model().coefficients<double>({u.data() + 4, static_cast<std::size_t>(parameters())});
  const double nw = 0.5 * c.nw2, w = nw / model().order(), C = std::cos(nw * t), s = std::sin(nw * t), C0 = std::cos(w * t), s0 = std::sin(w * t);
  Vector q(4);
  q << u[0] * C - u[1] * s, u[2] * C - u[3] * s + c.Z0_re * C0 - c.Z0_im * s0,  //
      -nw * (u[0] * s + u[1] * C), -nw * (u[2] * s + u[3] * C) - w * (c.Z0_re * s0 + c.Z0_im * C0);
  return q;
}

}  // namespace whirl::models
