#include "core/complex_bessel.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace whirl {
namespace {

using C = std::complex<double>;
using std::numbers::egamma;
using std::numbers::pi;

CylinderFunctions by_recurrence(C x) {
  std::array<C, 84> j{};  // of |x| < 25: J_80 < 1e-40
  const int top = 80;
  j[top] = 1e-200;
  for (int n = top; n > 0; --n) j[n - 1] = 2.0 * n / x * j[n] - j[n + 1];
  const C turn = x.imag() >= 0.0 ? C(0.0, -1.0) : C(0.0, 1.0);  // the larger of e^{ix}, e^{-ix}
  C sum = j[0], power = 1.0;
  for (int n = 1; n <= top; ++n) {
    power *= turn;
    sum += 2.0 * power * j[n];
  }
  const C scale = std::exp(turn * x) / sum, log = std::log(0.5 * x) + egamma;
  for (C& value : j) value *= scale;
  C y0 = log * j[0], y1 = log * j[1] - j[0] / x;
  for (int k = 1; 2 * k <= top; ++k) {
    const double sign = (k % 2 == 0 ? 1.0 : -1.0) / k;
    y0 -= 2.0 * sign * j[2 * k];
    y1 += sign * (j[2 * k - 1] - j[2 * k + 1]);
  }
  return {j[0], j[1], 2.0 / pi * y0, 2.0 / pi * y1};
}

// H1, H2 = sqrt(2/(pi x)) (P +- iQ) e^{+-i chi}, chi = x - (2 nu + 1) pi/4.
void by_expansion(C x, int nu, C& first, C& second) {
  C p = 0.0, q = 0.0, term = 1.0;
  double size = 1.0;
  for (int k = 0; k < 60; ++k) {
    const int turn = k % 4;
    (turn % 2 == 0 ? p : q) += turn < 2 ? term : -term;
    const double odd = 2.0 * k + 1.0;
    term *= (4.0 * nu * nu - odd * odd) / (8.0 * (k + 1.0)) / x;
    const double now = std::abs(term);
    if (now < 1e-17 || now > size) break;
    size = now;
  }
  const C i(0.0, 1.0), scale = std::sqrt(2.0 / (pi * x)), turn = std::polar(1.0, -(2.0 * nu + 1.0) * pi / 4.0);
  first = scale * (p + i * q) * turn;
  second = scale * (p - i * q) / turn;
}

void require_right_half(C x) {
  if (!(x.real() > 0.0)) throw std::invalid_argument(fmt::format("cylinder functions: real part must be > 0, got {:g}", x.real()));
}

}  // namespace

CylinderFunctions cylinder_functions(C x) {
  require_right_half(x);
  if (std::abs(x) < 25.0) return by_recurrence(x);
  const ScaledHankel h = scaled_hankel(x);
  const C up = std::exp(C(0.0, 1.0) * x), down = 1.0 / up, i2(0.0, 2.0);
  return {0.5 * (h.first_0 * up + h.second_0 * down), 0.5 * (h.first_1 * up + h.second_1 * down), (h.first_0 * up - h.second_0 * down) / i2,
          (h.first_1 * up - h.second_1 * down) / i2};
}

ScaledHankel scaled_hankel(C x) {
  require_right_half(x);
  ScaledHankel h;
  if (std::abs(x) < 25.0) {
    const CylinderFunctions f = by_recurrence(x);
    const C i(0.0, 1.0), up = std::exp(i * x), down = 1.0 / up;
    return {(f.j0 + i * f.y0) * down, (f.j0 - i * f.y0) * up, (f.j1 + i * f.y1) * down, (f.j1 - i * f.y1) * up};
  }
  by_expansion(x, 0, h.first_0, h.second_0);
  by_expansion(x, 1, h.first_1, h.second_1);
  return h;
}

}  // namespace whirl
