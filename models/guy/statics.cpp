#include "models/guy/statics.hpp"

#include <fmt/format.h>

#include <boost/math/special_functions/sinhc.hpp>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <stdexcept>

#include "models/guy/catenary_functions.hpp"
#include "models/guy/transverse_modes.hpp"

namespace whirl::models::guy {
namespace {

constexpr double slackest_r = 30.0;  // w l / 2H: a cable e^30/60 times as long as its span

Statics first_order_state(const Guy& g, double H) {
  Statics s{.guy = g, .form = Form::first_order, .horizontal_tension = H};
  const double l = g.horizontal_span, h = g.rise, r = s.r(), sinhc = boost::math::sinhc_pi(r);
  const double a1 = std::asinh(h / (l * sinhc)) - r;  // [Sarvi1968, eq. (2.4)]
  s.length = std::hypot(h, l * sinhc);
  const double stretch = 0.5 * H * l / g.axial_stiffness * (1.0 + boost::math::sinhc_pi(2.0 * r) + 2.0 * h * h / (l * l) * r / std::tanh(r));
  s.unstressed_length = s.length - stretch;
  s.vertical_tension = H * std::sinh(a1);
  s.lower_tension = H * std::cosh(a1);
  s.upper_tension = H * std::cosh(a1 + 2.0 * r);
  return s;
}

// Newton for (V, L0) at fixed H from the first-order form.
//
//   [ l_V  l_L ] [dV ]   [ l - l(V, L0) ]
//   [ h_V  h_L ] [dL0] = [ h - h(V, L0) ]
Statics exact_state(const Guy& g, double H) {
  Statics s = first_order_state(g, H);
  s.form = Form::exact;
  const double w = g.weight(), AE = g.axial_stiffness;
  double V = s.vertical_tension, L0 = s.unstressed_length, size = 1.0;
  for (int i = 0; i < 60 && size > 1e-15; ++i) {
    const double W = w * L0, s0 = V / H, s1 = (V + W) / H, q0 = std::hypot(1.0, s0), q1 = std::hypot(1.0, s1);
    const double rl = g.horizontal_span - (H * L0 / AE + H / w * asinh_difference(s1, s0, W / H));
    const double rh = g.rise - (L0 / AE * (V + 0.5 * W) + root_difference(s1, s0, W / H) * H / w);
    const double l_V = (1.0 / q1 - 1.0 / q0) / w, l_L = H / AE + 1.0 / q1;
    const double h_V = L0 / AE + (s1 / q1 - s0 / q0) / w, h_L = (V + W) / AE + s1 / q1;
    const double det = l_V * h_L - l_L * h_V;
    double dV = (rl * h_L - rh * l_L) / det, dL = (l_V * rh - h_V * rl) / det;
    const double shorten = std::min(1.0, 0.5 * L0 / std::abs(dL));  // the length stays positive
    V += shorten * dV;
    L0 += shorten * dL;
    const double before = size;
    size = std::max(std::abs(dV) / (std::abs(V) + H), std::abs(dL) / L0);
    if (size < 1e-12 && size >= before) break;  // rounding
  }
  if (!(size < 1e-10) || !std::isfinite(L0)) throw std::runtime_error(fmt::format("guy statics: no equilibrium found at H = {:g} N", H));
  s.vertical_tension = V;
  s.unstressed_length = L0;
  s.lower_tension = std::hypot(H, V);
  s.upper_tension = std::hypot(H, V + w * L0);
  // stretched: L0 + int T/AE ds with ds = H cosh u du / w
  const double s0 = V / H, s1 = s0 + w * L0 / H, du = asinh_difference(s1, s0, w * L0 / H);
  s.length = L0 + H * H / (2.0 * w * AE) * (du + s1 * std::hypot(1.0, s1) - s0 * std::hypot(1.0, s0));
  return s;
}

// Where the curve is parallel to the chord.
double sag_of(const Statics& s) {
  const Guy& g = s.guy;
  const double at = std::clamp((s.horizontal_tension * g.rise / g.horizontal_span - s.vertical_tension) / g.weight(), 0.0,
                               s.form == Form::exact ? s.unstressed_length : s.length);
  const CurvePoint p = curve_at(s, at);
  return (p.x * g.rise - p.y * g.horizontal_span) / g.chord();
}

Statics state_at(const Guy& g, double H, Form form) {
  Statics s = form == Form::exact ? exact_state(g, H) : first_order_state(g, H);
  s.sag = sag_of(s);
  return s;
}

void require_physical(const Statics& s) {
  if (s.upper_tension > largest_strain * s.guy.axial_stiffness || s.lower_tension > largest_strain * s.guy.axial_stiffness)
    throw std::invalid_argument(
        fmt::format("guy: a tension of {:.6g} N strains it by more than {:g} %", std::max(s.upper_tension, s.lower_tension), 100.0 * largest_strain));
}

// log of the least H whose slack weight does not strain the guy beyond the limit by itself.
double slackest(const Guy& g, double top) {
  double low = std::log(0.5 * g.weight() * g.horizontal_span / slackest_r);
  for (; low < top - 0.2; low += 0.1) {
    const Statics s = first_order_state(g, std::exp(low));
    if (std::max(s.upper_tension, s.lower_tension) < largest_strain * g.axial_stiffness) break;
  }
  return low;
}

bool grows_with_tension(Known k) { return k != Known::unstressed_length && k != Known::sag; }

std::invalid_argument out_of_reach(const Guy& g, Known known, double value, double bound, bool too_low) {
  switch (known) {
    case Known::unstressed_length:
      return std::invalid_argument(
          too_low
              ? fmt::format("guy: an unstressed length of {:.8g} m cannot reach over a chord of {:.8g} m (needs {:.8g} m)", value, g.chord(), bound)
              : fmt::format("guy: an unstressed length of {:.6g} m is too long (limit {:.6g} m)", value, bound));
    case Known::lower_tension:
    case Known::upper_tension:
      return std::invalid_argument(
          too_low ? fmt::format("guy: {} = {:.6g} N lies below the least its weight allows, {:.6g} N", to_string(known), value, bound)
                  : fmt::format("guy: {} = {:.6g} N strains it by more than {:g} %", to_string(known), value, 100.0 * largest_strain));
    case Known::horizontal_tension:
    case Known::sag:
    case Known::first_frequency:
      break;
  }
  return std::invalid_argument(
      fmt::format("guy: {} = {:.6g} is out of reach: must be {} {:.6g}", to_string(known), value, too_low ? ">" : "<", bound));
}

}  // namespace

std::string_view to_string(Form form) { return form == Form::exact ? "exact" : "first-order"; }

std::string_view to_string(Known known) {
  switch (known) {
    case Known::horizontal_tension:
      return "horizontal_tension";
    case Known::unstressed_length:
      return "unstressed_length";
    case Known::sag:
      return "sag";
    case Known::lower_tension:
      return "lower_tension";
    case Known::upper_tension:
      return "upper_tension";
    case Known::first_frequency:
      return "first_frequency";
  }
  return "";
}

double Statics::irvine_lambda2() const {
  const double T = mean_tension(), load = guy.weight() * guy.horizontal_span / T;
  return load * load * guy.axial_stiffness / T;
}

double Statics::first_frequency() const { return TransverseModes(*this).frequency(1); }

double value_of(const Statics& s, Known known) {
  switch (known) {
    case Known::horizontal_tension:
      return s.horizontal_tension;
    case Known::unstressed_length:
      return s.unstressed_length;
    case Known::sag:
      return s.sag;
    case Known::lower_tension:
      return s.lower_tension;
    case Known::upper_tension:
      return s.upper_tension;
    case Known::first_frequency:
      return s.first_frequency();
  }
  return 0.0;
}

CurvePoint curve_at(const Statics& s, double arc) {
  const double H = s.horizontal_tension, w = s.guy.weight(), s0 = s.vertical_tension / H, s1 = s0 + w * arc / H;
  CurvePoint p{H / w * asinh_difference(s1, s0, w * arc / H), H / w * root_difference(s1, s0, w * arc / H), H * std::hypot(1.0, s1), s1};
  if (s.form == Form::exact) {
    p.x += H * arc / s.guy.axial_stiffness;
    p.y += arc / s.guy.axial_stiffness * (s.vertical_tension + 0.5 * w * arc);
  }
  return p;
}

Statics at_horizontal_tension(const Guy& guy, double H, Form form) {
  guy.validate();
  if (!(H > 0.0)) throw std::invalid_argument(fmt::format("guy: horizontal_tension must be > 0, got {:g}", H));
  if (0.5 * guy.weight() * guy.horizontal_span > slackest_r * H)
    throw std::invalid_argument(
        fmt::format("guy: horizontal_tension = {:.6g} N is too slack (limit {:.6g} N)", H, 0.5 * guy.weight() * guy.horizontal_span / slackest_r));
  if (H > largest_strain * guy.axial_stiffness)
    throw std::invalid_argument(fmt::format("guy: horizontal_tension = {:.6g} N strains it by more than {:g} %", H, 100.0 * largest_strain));
  Statics s = state_at(guy, H, form);
  require_physical(s);
  return s;
}

Statics solve(const Guy& guy, Known known, double value, Form form) {
  if (known == Known::horizontal_tension) return at_horizontal_tension(guy, value, form);
  guy.validate();
  if (!(value > 0.0) || !std::isfinite(value)) throw std::invalid_argument(fmt::format("guy: {} must be > 0, got {:g}", to_string(known), value));
  const double sign = grows_with_tension(known) ? 1.0 : -1.0;
  const auto excess = [&](double x) { return sign * (value_of(state_at(guy, std::exp(x), form), known) / value - 1.0); };
  const double top = std::log(largest_strain * guy.axial_stiffness * guy.chord_cosine());
  double low = slackest(guy, top);
  const bool tension = known == Known::lower_tension || known == Known::upper_tension;
  if (tension) low = boost::math::tools::brent_find_minima(excess, low, top, 50).first;
  double hi = top, lo = top, f_hi = excess(top), f_lo = f_hi;
  const auto bound = [&](double x) { return value_of(state_at(guy, std::exp(x), form), known); };
  if (f_hi < 0.0) throw out_of_reach(guy, known, value, bound(top), sign < 0.0);
  while (f_lo > 0.0 && lo > low) {  // from the taut side: the first crossing is the taut solution
    hi = lo;
    f_hi = f_lo;
    lo = std::max(low, lo - 0.7);
    f_lo = excess(lo);
  }
  if (f_lo > 0.0) throw out_of_reach(guy, known, value, bound(low), sign > 0.0);
  if (f_lo == 0.0 || f_hi == 0.0) return state_at(guy, std::exp(f_lo == 0.0 ? lo : hi), form);
  std::uintmax_t steps = 200;
  const auto root = boost::math::tools::toms748_solve(excess, lo, hi, f_lo, f_hi, boost::math::tools::eps_tolerance<double>(52), steps);
  return state_at(guy, std::exp(0.5 * (root.first + root.second)), form);
}

}  // namespace whirl::models::guy
