#include "models/guy/lumped.hpp"

#include <fmt/format.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace whirl::models::guy {
namespace {

void require_count(int n) {
  if (n < 1) throw std::invalid_argument(fmt::format("lumped guy: number of masses must be >= 1, got {}", n));
}

void require_first_order(const Statics& s) {
  if (s.form != Form::first_order) throw std::invalid_argument("lumped guy: needs a static state of the first-order form");
}

// Gradient of the energy: how far the chain reaches beyond the far end, and its slope with V.
struct Reach {
  double x, y, y_slope;
};

Reach reach(const Guy& g, const std::vector<double>& l, const std::vector<double>& w, double AE, double H, double V) {
  Reach r{-g.horizontal_span, -g.rise, 0.0};
  for (std::size_t i = 0; i < l.size(); ++i) {
    const double T = std::hypot(H, V), c = H / T;
    r.x += l[i] * (c + H / AE);
    r.y += l[i] * (V / T + V / AE);
    r.y_slope += l[i] * (c * c / T + 1.0 / AE);
    if (i < w.size()) V += w[i];
  }
  return r;
}

// The V at which the chain ends at the right height: the height grows with V, its slope known; Newton's method inside a bracket.
double balanced_vertical(const Guy& g, const std::vector<double>& l, const std::vector<double>& w, double AE, double H, double load) {
  double lo = -load - H, hi = H, step = load + H;
  while (reach(g, l, w, AE, H, lo).y > 0.0) lo -= (step *= 2.0);
  while (reach(g, l, w, AE, H, hi).y < 0.0) hi += (step *= 2.0);
  double V = 0.5 * (lo + hi);
  for (int i = 0; i < 200; ++i) {
    const Reach r = reach(g, l, w, AE, H, V);
    (r.y > 0.0 ? hi : lo) = V;
    double next = V - r.y / r.y_slope;
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    const double moved = std::abs(next - V);
    V = next;
    if (moved <= 1e-16 * (std::abs(V) + H)) break;
  }
  return V;
}

Polygon polygon(const std::vector<double>& l, const std::vector<double>& w, double AE, double H, double V) {
  Polygon p{.horizontal_tension = H, .x = {0.0}, .y = {0.0}, .weight = w};
  for (std::size_t i = 0; i < l.size(); ++i) {
    const double T = std::hypot(H, V), length = l[i] * (1.0 + T / AE);
    p.slope.push_back(V / H);
    p.tension.push_back(T);
    p.length.push_back(length);
    p.x.push_back(p.x.back() + length * H / T);
    p.y.push_back(p.y.back() + length * V / T);
    if (i < w.size()) V += w[i];
  }
  return p;
}

}  // namespace

// Mass i where the tangents at the arcs' ends i - 1 and i meet; (6.15) with y_{i-1} for the misprinted y_{i+1}.
Polygon funicular_polygon(const Statics& s, int n) {
  require_count(n);
  require_first_order(s);
  std::vector<CurvePoint> cut;
  for (int i = 0; i <= n; ++i) cut.push_back(curve_at(s, s.length * i / n));
  Polygon p{.horizontal_tension = s.horizontal_tension, .x = {0.0}, .y = {0.0}};
  for (std::size_t i = 0; i < cut.size(); ++i) {
    p.slope.push_back(cut[i].slope);
    p.tension.push_back(cut[i].tension);
    if (i == 0) continue;
    const CurvePoint &a = cut[i - 1], &b = cut[i];
    // from the point a: the tangents' heights differ by (y_b - y_a) - t_b (x_b - x_a) there, and their slopes by t_b - t_a
    const double along = (b.slope * (b.x - a.x) - (b.y - a.y)) / (b.slope - a.slope);
    p.x.push_back(a.x + along);
    p.y.push_back(a.y + a.slope * along);
    p.weight.push_back(s.guy.weight() * s.length / n);
  }
  p.x.push_back(s.guy.horizontal_span);
  p.y.push_back(s.guy.rise);
  for (std::size_t i = 1; i < p.x.size(); ++i) p.length.push_back(std::hypot(p.x[i] - p.x[i - 1], p.y[i] - p.y[i - 1]));
  return p;
}

Polygon hung_masses(const Guy& g, const std::vector<double>& l, const std::vector<double>& w, double AE) {
  g.validate();
  require_count(static_cast<int>(w.size()));
  if (l.size() != w.size() + 1)
    throw std::invalid_argument(fmt::format("lumped guy: {} masses need {} segments, got {}", w.size(), w.size() + 1, l.size()));
  for (const auto& values : {l, w})
    for (const double v : values)
      if (!(v > 0.0) || !std::isfinite(v)) throw std::invalid_argument(fmt::format("lumped guy: weights and segments must be > 0, got {:g}", v));
  const double total = std::accumulate(l.begin(), l.end(), 0.0), load = std::accumulate(w.begin(), w.end(), 0.0);
  if (!(AE > 0.0) || (std::isinf(AE) && !(total > g.chord() * (1.0 + 1e-12))))
    throw std::invalid_argument(fmt::format("lumped guy: a line of {:.8g} m cannot reach over a chord of {:.8g} m", total, g.chord()));
  // With V balanced, the energy is convex in H alone: its slope, the horizontal reach, grows with H.
  const auto f = [&](double x) {
    const double H = std::exp(x);
    return reach(g, l, w, AE, H, balanced_vertical(g, l, w, AE, H, load)).x / g.horizontal_span;
  };
  double lo = std::log(load * g.chord_cosine()), hi = lo, f_lo = f(lo), f_hi = f_lo;
  while (f_hi < 0.0 && hi < lo + 80.0) f_hi = f(hi += 1.0);
  while (f_lo > 0.0 && lo > hi - 80.0) f_lo = f(lo -= 1.0);
  if (f_lo <= 0.0 && f_hi >= 0.0) {
    std::uintmax_t steps = 200;
    const auto root =
        lo == hi ? std::pair{lo, hi} : boost::math::tools::toms748_solve(f, lo, hi, f_lo, f_hi, boost::math::tools::eps_tolerance<double>(52), steps);
    const double H = std::exp(0.5 * (root.first + root.second));
    return polygon(l, w, AE, H, balanced_vertical(g, l, w, AE, H, load));
  }
  throw std::runtime_error("lumped guy: no equilibrium with all lines taut was found");
}

Polygon equal_hung_masses(const Statics& s, int n) {
  require_count(n);
  require_first_order(s);
  return hung_masses(s.guy, std::vector<double>(n + 1, s.length / (n + 1)), std::vector<double>(n, s.guy.weight() * s.length / (n + 1)));
}

}  // namespace whirl::models::guy
