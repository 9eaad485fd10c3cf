#include "models/catenary/geometry.hpp"

#include <fmt/format.h>

#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <stdexcept>

namespace whirl::models::catenary {
namespace {

template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> text, Args&&... args) {
  throw std::invalid_argument(fmt::format(text, std::forward<Args>(args)...));
}

// Root of an increasing f in (lower, upper); the upper end is moved out until it brackets.
template <class F>
double root(F&& f, double lower, double upper) {
  double fl = f(lower), fu = f(upper);
  for (int i = 0; i < 60 && fu < 0.0; ++i) fu = f(upper *= 2.0);
  if (fl >= 0.0) return lower;
  if (fu == 0.0) return upper;
  std::uintmax_t steps = 200;
  const auto r = boost::math::tools::toms748_solve(f, lower, upper, fl, fu, boost::math::tools::eps_tolerance<double>(52), steps);
  return 0.5 * (r.first + r.second);
}

// log(sinh m / m) without overflow, and without cancellation for small m.
double log_sinhc(double m) {
  if (m > 0.7) return m - std::log(2.0 * m) + std::log1p(-std::exp(-2.0 * m));
  const double q = m * m;
  double sum = 0.0, term = 1.0;
  for (int k = 1; k < 12; ++k) sum += term *= q / (2.0 * k * (2.0 * k + 1.0));
  return std::log1p(sum);
}

// m with sinh m / m = exp(ratio_log); sinh m / m > 1 + m^2/6 bounds it from above, and sinh m / m < exp(m^2/6) from below.
double half_width_from_log(double ratio_log) {
  return root([&](double m) { return log_sinhc(m) - ratio_log; }, std::sqrt(6.0 * ratio_log) * (1.0 - 1e-15),
              std::sqrt(6.0 * ratio_log) * (1.0 + ratio_log) + 1e-300);
}

// a and m are known, and with them two of the others.
Geometry complete(double a, double m, double x_m) {
  const double s = std::sinh(m), versine = 2.0 * std::sinh(0.5 * m) * std::sinh(0.5 * m);
  return {2.0 * a * m, 2.0 * a * s * std::sinh(x_m), 2.0 * a * s * std::cosh(x_m), a * std::cosh(x_m) * versine, a, m, x_m, x_m - m, x_m + m};
}

Geometry from_height(double a, double m, double h) { return complete(a, m, std::asinh(h / (2.0 * a * std::sinh(m)))); }

// A level cable stands at the limit of what two lengths and a tension can be, and its height goes with the root of the distance from that limit:
// what is level but for rounding of the computer, or below the limit by rounding of printed numbers, is level.
constexpr double computer_rounding = 1e-13, printed_rounding = 1e-9;

// x_m from cosh x_m, which must reach 1.
Geometry from_cosh(double a, double m, double cosh_xm, const char* what, double given, double least) {
  if (cosh_xm < 1.0 - printed_rounding) refuse("{} {:g} m is out of reach: with the other two given it is at least {:g} m", what, given, least);
  return complete(a, m, cosh_xm < 1.0 + computer_rounding ? 0.0 : std::acosh(cosh_xm));
}

double tension_length(const GeometryInput& in) { return *in.horizontal_tension / in.weight_per_length; }

void check_sign(const std::optional<double>& value, const char* name, bool zero_too) {
  if (value && !(std::isfinite(*value) && (*value > 0.0 || (zero_too && *value == 0.0))))
    refuse("the {} must be {} 0, got {:g}", name, zero_too ? ">=" : ">", *value);
}

void check_input(const GeometryInput& in) {
  check_sign(in.span, "span", false);
  check_sign(in.height, "height difference", true);
  check_sign(in.length, "length", false);
  check_sign(in.sag, "sag", false);
  check_sign(in.horizontal_tension, "horizontal tension", false);
  check_sign(in.upper_tension, "tension at the upper end", false);
  const int given = in.span.has_value() + in.height.has_value() + in.length.has_value() + in.sag.has_value() + in.horizontal_tension.has_value() +
                    in.upper_tension.has_value();
  if (given != 3) refuse("a catenary needs exactly three of span, height difference, length, sag and tension, got {}", given);
  if ((in.horizontal_tension || in.upper_tension) && !(in.weight_per_length > 0.0 && std::isfinite(in.weight_per_length)))
    refuse("a tension needs a weight per length > 0, got {:g}", in.weight_per_length);
  if (in.upper_tension && in.horizontal_tension) refuse("of the two tensions only one can be given");
  if (in.length && in.span && *in.span >= *in.length) refuse("the span {:g} m is not shorter than the cable, {:g} m", *in.span, *in.length);
  if (in.length && in.height && *in.height >= *in.length)
    refuse("the height difference {:g} m is beyond reach of the cable, {:g} m", *in.height, *in.length);
  if (in.length && in.sag && *in.sag >= 0.5 * *in.length) refuse("the sag {:g} m exceeds half the length, {:g} m", *in.sag, 0.5 * *in.length);
}

// Smallest half width at which the upper end's tension, as a function of m at given b and h, stops falling.
Geometry from_upper_tension(const GeometryInput& in) {
  const double b = *in.span, h = *in.height, wanted = *in.upper_tension / in.weight_per_length;
  const auto tension = [&](double m) {
    const Geometry g = from_height(0.5 * b / m, m, h);
    return g.a * std::cosh(g.x2);
  };
  const auto least = boost::math::tools::brent_find_minima([&](double lm) { return tension(std::exp(lm)); }, std::log(1e-6), std::log(largest_x), 50);
  if (wanted < least.second * (1.0 - printed_rounding))
    refuse("the tension at the upper end, {:g} N, is out of reach: it is at least {:g} N", *in.upper_tension, least.second * in.weight_per_length);
  const double m = root([&](double x) { return wanted - tension(x); }, std::exp(least.first) * 1e-9, std::exp(least.first));
  return from_height(0.5 * b / m, m, h);
}

Geometry solve(const GeometryInput& in);

// The level cable of the other two, if it has the tension.
std::optional<Geometry> level_with_tension(GeometryInput with, double wanted) {
  with.height = 0.0;
  try {
    const Geometry g = solve(with);
    if (std::abs(g.a * std::cosh(g.x2) - wanted) <= printed_rounding * wanted) return g;
  } catch (const std::invalid_argument&) {
  }
  return std::nullopt;
}

// The level cable of the tension and one of span, length and sag, if the other agrees: a last resort where printed digits leave no cable at all.
std::optional<Geometry> level_by_one(const GeometryInput& in) {
  constexpr std::optional<double> GeometryInput::*lengths[] = {&GeometryInput::span, &GeometryInput::length, &GeometryInput::sag};
  constexpr double Geometry::*found[] = {&Geometry::span, &Geometry::length, &Geometry::sag};
  for (const int kept : {0, 1, 2}) {
    if (!(in.*lengths[kept])) continue;
    GeometryInput level{.height = 0.0, .upper_tension = in.upper_tension, .weight_per_length = in.weight_per_length};
    level.*lengths[kept] = in.*lengths[kept];
    try {
      const Geometry g = solve(level);
      bool agrees = true;
      for (const int k : {0, 1, 2})
        if (in.*lengths[k]) agrees = agrees && std::abs(g.*found[k] - *(in.*lengths[k])) <= printed_rounding * *(in.*lengths[k]);
      if (agrees) return g;
    } catch (const std::invalid_argument&) {
    }
  }
  return std::nullopt;
}

// Any two of the others beside the tension at the upper end: the largest horizontal tension that gives it.
Geometry from_upper_tension_and(const GeometryInput& in) {
  const double wanted = *in.upper_tension / in.weight_per_length;
  GeometryInput with = in;
  with.upper_tension.reset();
  if (!in.height)
    if (const auto level = level_with_tension(with, wanted)) return *level;
  const auto at = [&](double a) {
    with.horizontal_tension = a * in.weight_per_length;
    return solve(with);
  };
  const auto excess = [&](double a) {
    try {
      const Geometry g = at(a);
      return g.a * std::cosh(g.x2) - wanted;
    } catch (const std::invalid_argument&) {
      return std::nan("");  // no such cable
    }
  };
  // Where cables begin or cease to exist between two tensions, the last that does.
  const auto edge = [&](double is, double is_not) {
    for (int i = 0; i < 60; ++i) (std::isnan(excess(0.5 * (is + is_not))) ? is_not : is) = 0.5 * (is + is_not);
    return is;
  };
  double above = wanted, f_above = excess(above);
  for (double a = 0.98 * wanted; a > 1e-6 * wanted; a *= 0.98) {
    const double f = excess(a);
    double lower = a, f_lower = f;
    if (std::isnan(f_above) && !std::isnan(f)) f_above = excess(above = edge(a, above));
    else if (!std::isnan(f_above) && std::isnan(f)) f_lower = excess(lower = edge(above, a));
    if (f_above == 0.0) return at(above);
    if (f_lower * f_above < 0.0) {
      std::uintmax_t steps = 200;
      const auto r = boost::math::tools::toms748_solve(excess, lower, above, f_lower, f_above, boost::math::tools::eps_tolerance<double>(52), steps);
      return at(0.5 * (r.first + r.second));
    }
    above = a;
    f_above = f;
  }
  if (!in.height)
    if (const auto level = level_by_one(in)) return *level;
  refuse("no cable with the other two has the tension {:g} N at its upper end", *in.upper_tension);
}

Geometry solve(const GeometryInput& in) {
  const double b = in.span.value_or(0.0), h = in.height.value_or(0.0), l = in.length.value_or(0.0), f = in.sag.value_or(0.0);
  if (in.upper_tension) return in.span && in.height ? from_upper_tension(in) : from_upper_tension_and(in);
  if (in.span && in.height && in.length) {
    const double chord = std::hypot(b, h);
    if (chord >= l) refuse("the height difference {:g} m is beyond reach: the chord, {:g} m, is not shorter than the cable, {:g} m", h, chord, l);
    const double m = half_width_from_log(0.5 * std::log1p((l - chord) * (l + chord) / (b * b)));
    return from_height(0.5 * b / m, m, h);
  }
  if (in.length && in.sag) {
    const double m = 2.0 * std::atanh(2.0 * f / l);
    if (in.height) {
      const double a = 0.5 * std::sqrt((l - h) * (l + h)) / std::sinh(m);
      return from_height(a, m, h);
    }
    const double a = in.span ? 0.5 * b / m : tension_length(in);
    return from_cosh(a, m, l / (2.0 * a * std::sinh(m)), "the length", l, 2.0 * a * std::sinh(m));
  }
  if (in.span && in.horizontal_tension) {
    const double a = tension_length(in), m = 0.5 * b / a;
    if (in.height) return from_height(a, m, h);
    if (in.length) return from_cosh(a, m, l / (2.0 * a * std::sinh(m)), "the length", l, 2.0 * a * std::sinh(m));
    const double least = 2.0 * a * std::sinh(0.5 * m) * std::sinh(0.5 * m);
    return from_cosh(a, m, f / least, "the sag", f, least);
  }
  if (in.height && in.length && in.horizontal_tension) {
    const double a = tension_length(in);
    return from_height(a, std::asinh(0.5 * std::sqrt((l - h) * (l + h)) / a), h);
  }
  // f^2 = (a (cosh m - 1))^2 + ((h/2) tanh(m/2))^2 grows with m, at given a and at given span 2 a m.
  const auto sag = [&](double m, double a) { return std::hypot(2.0 * a * std::sinh(0.5 * m) * std::sinh(0.5 * m), 0.5 * h * std::tanh(0.5 * m)); };
  if (in.span) {
    const double m = root([&](double x) { return sag(x, 0.5 * b / x) - f; }, 1e-12, 1.0);
    return from_height(0.5 * b / m, m, h);
  }
  const double a = tension_length(in), m = root([&](double x) { return sag(x, a) - f; }, 1e-12, 1.0);
  return from_height(a, m, h);
}

}  // namespace

double Geometry::sag_parameter() const { return m / std::sinh(m); }

double Geometry::depth_below_upper() const { return a * (std::cosh(x2) - (x1 < 0.0 && x2 > 0.0 ? 1.0 : std::cosh(x1))); }

double Geometry::effective_length() const {
  const auto antiderivative = [](double x) { return std::sinh(x) + std::sinh(x) * std::sinh(x) * std::sinh(x) / 3.0; };
  return antiderivative(x2) - antiderivative(x1);
}

Geometry geometry(const GeometryInput& input) {
  check_input(input);
  const Geometry g = solve(input);
  if (!(g.m >= 1e-6)) refuse("the cable is too taut for a catenary: b/2a = {:g}, at least 1e-06", g.m);
  if (!(std::max(std::abs(g.x1), g.x2) <= largest_x))
    refuse("the cable hangs too deep or too steep: its slope at an end is {:g}, at most {:.3g}", std::sinh(std::max(std::abs(g.x1), g.x2)),
           std::sinh(largest_x));
  return g;
}

Geometry unit_geometry(double m, double height_over_span) {
  if (!(m > 0.0)) refuse("b/2a must be > 0, got {:g}", m);
  return geometry({.span = 2.0 * m, .height = 2.0 * m * height_over_span, .horizontal_tension = 1.0, .weight_per_length = 1.0});
}

double half_width_of(double sag_parameter) {
  if (!(sag_parameter > 0.0 && sag_parameter < 1.0)) refuse("the sag parameter b/sqrt(l^2 - h^2) must lie in (0, 1), got {:g}", sag_parameter);
  return half_width_from_log(-std::log(sag_parameter));
}

double half_width_reaching(double xi, double height_over_span) {
  const double x2 = std::acosh(1.0 + xi);
  const auto past = [&](double m) { return std::asinh(height_over_span * m / std::sinh(m)) + m - x2; };
  if (!(past(1e-9) < 0.0)) refuse("no cable of h/b = {:g} has its upper end at xi = {:g}: the chord alone is steeper", height_over_span, xi);
  return root(past, 1e-9, x2);
}

double xi_of(double x) { return std::copysign(2.0 * std::sinh(0.5 * x) * std::sinh(0.5 * x), x); }

}  // namespace whirl::models::catenary
