#include "models/closed_forms.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <complex>
#include <optional>

#include "core/dual.hpp"
#include "core/polynomial.hpp"

namespace whirl::models {
namespace {

using Complex = std::complex<double>;

// A Laurent polynomial in t, coefficients of t^-4 .. t^4.
struct Laurent {
  std::array<double, 9> c{};
  static Laurent of(double minus, double constant, double plus) {
    Laurent r;
    r.c[3] = minus;
    r.c[4] = constant;
    r.c[5] = plus;
    return r;
  }
  Laurent operator+(const Laurent& o) const {
    Laurent r;
    for (std::size_t i = 0; i < 9; ++i) r.c[i] = c[i] + o.c[i];
    return r;
  }
  Laurent operator*(double f) const {
    Laurent r;
    for (std::size_t i = 0; i < 9; ++i) r.c[i] = c[i] * f;
    return r;
  }
  Laurent operator*(const Laurent& o) const {
    Laurent r;
    for (int i = -4; i <= 4; ++i)
      for (int j = std::max(-4, -4 - i); j <= std::min(4, 4 - i); ++j) r.c[std::size_t(i + j + 4)] += c[std::size_t(i + 4)] * o.c[std::size_t(j + 4)];
    return r;
  }
};

// Z2 from its balance Z2 [ D + i d ] = -E, the bracket being what multiplies Z2 at given A^2, Phi.
Complex in_plane_amplitude(const SlowFlowCoefficients<double>& c, double D, double d) { return -Complex(c.load_re, c.load_im) / Complex(D, d); }

constexpr double nearly_real = 1e-3;  // imaginary part of a root worth a try, relative: double roots lose half their digits and more

// Newton on the slow flow in x = size z; nothing if its steps do not come to rest within reach of the start.
std::optional<Eigen::Vector4d> polished(const SlowFlowCoefficients<double>& c, const Eigen::Vector4d& start) {
  constexpr int most_steps = 40;
  constexpr double settled = 1e-14, rounding = 1e-9, reach = 0.3;
  using D = Dual<double, 4>;
  const double size = start.norm();
  if (!(size > 0.0) || !std::isfinite(size)) return std::nullopt;
  Eigen::Vector4d x = start;
  double previous = reach * size;
  for (int i = 0; i < most_steps; ++i) {
    std::array<D, 4> r;
    slow_flow<D, double>(c, seed<D>(x[0], 0), seed<D>(x[1], 1), seed<D>(x[2], 2), seed<D>(x[3], 3), r);
    Eigen::Vector4d f;
    Eigen::Matrix4d j;
    for (int row = 0; row < 4; ++row) {
      f[row] = r[std::size_t(row)].v;
      for (int column = 0; column < 4; ++column) j(row, column) = r[std::size_t(row)].d[std::size_t(column)];
    }
    const Eigen::Vector4d step = j.partialPivLu().solve(f);
    const double length = step.norm();
    if (!std::isfinite(length) || (x - step - start).norm() > reach * size) return std::nullopt;
    x -= step;
    // Steps that no longer shrink are rounding, if they are small enough for it.
    if (length <= settled * size || (length < rounding * size && length > 0.5 * previous)) return x;
    previous = length;
  }
  return std::nullopt;
}

// Unless it is there already.
void add_state(const SlowFlowCoefficients<double>& c, const Eigen::Vector4d& start, std::vector<Eigen::Vector4d>& states) {
  constexpr double same = 1e-9;
  const auto x = polished(c, start);
  const auto is_x = [&x](const Eigen::Vector4d& s) {
    const Eigen::Vector4d mirror(-s[0], -s[1], s[2], s[3]);
    return std::min((s - *x).norm(), (mirror - *x).norm()) < same * x->norm();
  };
  if (x && std::none_of(states.begin(), states.end(), is_x)) states.push_back(*x);
}

void add_coupled(const SlowFlowCoefficients<double>& c, double y, double ycos, double k, std::vector<Eigen::Vector4d>& states) {
  const double A2 = -(c.detuning1 + c.g2 * (2.0 * y + ycos)) / c.g1;
  if (!(A2 > 0.0) || !(y > 0.0)) return;
  const double sin2 = k / y, cos2 = ycos / y;
  const Complex Z2 = in_plane_amplitude(c, c.detuning2 + c.g4 * y + c.g3 * (2.0 + cos2) * A2, c.damping2 + c.g3 * A2 * sin2);
  const double Psi1 = std::arg(Z2) + 0.5 * std::atan2(sin2, cos2);
  const Complex Z1 = std::polar(std::sqrt(A2), Psi1);
  add_state(c, {Z1.real(), Z1.imag(), Z2.real(), Z2.imag()}, states);
}

}  // namespace

std::vector<Eigen::Vector4d> in_plane_states(const SlowFlowCoefficients<double>& c) {
  const double P2 = c.load_re * c.load_re + c.load_im * c.load_im;
  if (P2 == 0.0) return {Eigen::Vector4d::Zero()};
  std::vector<Eigen::Vector4d> states;
  for (const auto& y : polynomial_roots({-P2, c.damping2 * c.damping2 + c.detuning2 * c.detuning2, 2.0 * c.g4 * c.detuning2, c.g4 * c.g4})) {
    if (std::abs(y.imag()) > nearly_real * std::abs(y) || !(y.real() > 0.0)) continue;
    const Complex Z2 = in_plane_amplitude(c, c.detuning2 + c.g4 * y.real(), c.damping2);
    add_state(c, {0.0, 0.0, Z2.real(), Z2.imag()}, states);
  }
  return states;
}

std::vector<Eigen::Vector4d> coupled_states(const SlowFlowCoefficients<double>& c) {
  const double P2 = c.load_re * c.load_re + c.load_im * c.load_im, k = c.damping1 / c.g2;
  std::vector<Eigen::Vector4d> states;
  if (P2 == 0.0) return states;
  if (k == 0.0) {
    for (const double cos2 : {1.0, -1.0}) {  // A^2 = a0 + a1 y, balance (b0 + b1 y)^2 y + d2^2 y = P^2
      const double h = 2.0 + cos2, a0 = -c.detuning1 / c.g1, a1 = -c.g2 * h / c.g1, b0 = c.detuning2 + c.g3 * h * a0, b1 = c.g4 + c.g3 * h * a1;
      for (const auto& y : polynomial_roots({-P2, c.damping2 * c.damping2 + b0 * b0, 2.0 * b0 * b1, b1 * b1}))
        if (std::abs(y.imag()) <= nearly_real * std::abs(y)) add_coupled(c, y.real(), cos2 * y.real(), 0.0, states);
    }
    return states;
  }
  const Laurent y = Laurent::of(0.5 * k, 0.0, 0.5 * k), ycos = Laurent::of(-0.5 * k, 0.0, 0.5 * k), one = Laurent::of(0.0, 1.0, 0.0);
  const Laurent h = y * 2.0 + ycos, A2 = (one * c.detuning1 + h * c.g2) * (-1.0 / c.g1);
  const Laurent im = y * c.damping2 + A2 * (c.g3 * k), re = y * c.detuning2 + y * y * c.g4 + h * A2 * c.g3;
  const Laurent balance = im * im + re * re + y * (-P2);
  for (const auto& t : polynomial_roots({balance.c.begin(), balance.c.end()})) {
    if (std::abs(t.imag()) > nearly_real * std::abs(t) || !(t.real() > 0.0)) continue;
    const double x = t.real();
    add_coupled(c, 0.5 * k * (x + 1.0 / x), 0.5 * k * (x - 1.0 / x), k, states);
  }
  return states;
}

}  // namespace whirl::models
