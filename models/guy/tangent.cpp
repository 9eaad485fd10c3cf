#include "models/guy/tangent.hpp"

#include <cmath>
#include <stdexcept>

#include <boost/math/special_functions/sinhc.hpp>

#include "core/quadrature.hpp"
#include "models/guy/catenary_functions.hpp"

namespace whirl::models::guy {
namespace {

void require_exact(const Statics& s) {
  if (s.form != Form::exact) throw std::invalid_argument("guy tangent: needs a state of the exact form");
}

struct Compliance {
  double cc = 0.0, cn = 0.0, nn = 0.0;  // along the chord, across it
};

Compliance compliance(const Statics& s) {
  const Guy& g = s.guy;
  const double c = g.chord_cosine(), d = g.chord_sine(), w = g.weight(), H = s.horizontal_tension, AE = g.axial_stiffness;
  const double s0 = s.vertical_tension / H, s1 = s0 + w * s.unstressed_length / H;
  const double u0 = std::asinh(s0), range = asinh_difference(s1, s0, w * s.unstressed_length / H);
  const int pieces = 1 + static_cast<int>(range);  // the poles at +- i pi/2 stay a piece and a half away
  Compliance sum;
  for (int i = 0; i < pieces; ++i) {
    const auto term = [&](double Compliance::*part) {
      return integrate<double, 20>([&](double fraction) {
        const double u = u0 + range * (i + fraction) / pieces, ex = 1.0 / std::cosh(u), ey = std::tanh(u);
        const double along = ex * c + ey * d, across = ey * c - ex * d, stretch = H * std::cosh(u) / AE;  // ds = (H/w) cosh u du
        if (part == &Compliance::cc) return across * across + stretch;
        if (part == &Compliance::nn) return along * along + stretch;
        return -along * across;
      });
    };
    for (const auto part : {&Compliance::cc, &Compliance::cn, &Compliance::nn}) sum.*part += term(part) * range / (pieces * w);
  }
  return sum;
}

}  // namespace

Tangent tangent(const Statics& s) {
  require_exact(s);
  const Compliance f = compliance(s);
  const double det = f.cc * f.nn - f.cn * f.cn, kcc = f.nn / det, knn = f.cc / det, kcn = -f.cn / det;
  const double c = s.guy.chord_cosine(), d = s.guy.chord_sine();  // chord (c, d), normal (-d, c)
  return {c * c * kcc - 2.0 * c * d * kcn + d * d * knn, c * d * (kcc - knn) + (c * c - d * d) * kcn, d * d * kcc + 2.0 * c * d * kcn + c * c * knn,
          s.horizontal_tension / s.guy.horizontal_span};
}

double horizontal_modulus(const Statics& s) {
  if (s.form == Form::exact) return tangent(s).xx;
  const Guy& g = s.guy;
  const double H = s.horizontal_tension, AE = g.axial_stiffness, l = g.horizontal_span, r = s.r();
  const double flat = std::sqrt((s.length - g.rise) * (s.length + g.rise)) / s.length;
  const double shc = boost::math::sinhc_pi(r), tilt = g.rise / (l * shc), tilt2 = tilt * tilt;  // (h/l)(r/sinh r)
  const double ch = std::cosh(r), sh = std::sinh(r);
  return (H / AE * (ch * ch - tilt2) - flat * ch) /
         (l / AE * (sh * sh - boost::math::sinhc_pi(2.0 * r) - tilt2) - flat * l / H * cosh_minus_sinhc(r));
}

double tension_per_unstressed_length(const Statics& s) {
  const Tangent k = tangent(s);
  const double H = s.horizontal_tension, W = s.guy.weight() * s.unstressed_length, T = s.upper_tension;
  // At fixed H, V a longer guy reaches farther along its upper tangent by 1 + T/AE per unit length.
  const double far = 1.0 + T / s.guy.axial_stiffness, ex = H / T, ey = (s.vertical_tension + W) / T;
  return -far * (k.xx * ex + k.xy * ey);
}

}  // namespace whirl::models::guy
