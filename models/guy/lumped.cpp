#include "models/guy/lumped.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <stdexcept>

namespace whirl::models::guy {
namespace {

void require_count(int n) {
  if (n < 1) throw std::invalid_argument(fmt::format("lumped guy: number of masses must be >= 1, got {}", n));
}

void require_first_order(const Statics& s) {
  if (s.form != Form::first_order) throw std::invalid_argument("lumped guy: needs a static state of the first-order form");
}

struct Energy {
  double value = 0.0, g_h = 0.0, g_v = 0.0, hh = 0.0, hv = 0.0, vv = 0.0;
};

Energy energy(const Guy& g, const std::vector<double>& l, const std::vector<double>& w, double AE, double H, double V) {
  Energy e{.value = -H * g.horizontal_span - V * g.rise, .g_h = -g.horizontal_span, .g_v = -g.rise};
  for (std::size_t i = 0; i < l.size(); ++i) {
    const double T = std::hypot(H, V), c = H / T, s = V / T, stretch = 1.0 / T + 1.0 / AE;
    e.value += l[i] * (T + 0.5 * T * T / AE);
    e.g_h += l[i] * H * stretch;
    e.g_v += l[i] * V * stretch;
    e.hh += l[i] * (s * s / T + 1.0 / AE);
    e.hv -= l[i] * c * s / T;
    e.vv += l[i] * (c * c / T + 1.0 / AE);
    if (i < w.size()) V += w[i];
  }
  return e;
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
  double H = load * g.chord_cosine(), V = H * g.rise / g.horizontal_span - 0.5 * load;
  Energy e = energy(g, l, w, AE, H, V);
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 200; ++i) {
    const double det = e.hh * e.vv - e.hv * e.hv;
    const double dH = -(e.vv * e.g_h - e.hv * e.g_v) / det, dV = -(e.hh * e.g_v - e.hv * e.g_h) / det, fall = dH * e.g_h + dV * e.g_v;
    const double step = std::hypot(dH, dV) / std::hypot(H, V), slope = std::hypot(e.g_h, e.g_v);
    if (step < 1e-15 || (step < 1e-8 && step >= before)) return polygon(l, w, AE, H, V);  // rounding
    before = step;
    double t = 1.0;
    Energy next = energy(g, l, w, AE, H + dH, V + dV);
    // Near the end the energy's own rounding hides its fall, the gradient's does not.
    while (!(next.value <= e.value + 1e-4 * t * fall || std::hypot(next.g_h, next.g_v) < 0.9 * slope) && t > 1e-9 && step > 1e-8) {
      t *= 0.5;
      next = energy(g, l, w, AE, H + t * dH, V + t * dV);
    }
    H += t * dH;
    V += t * dV;
    e = next;
  }
  throw std::runtime_error("lumped guy: no equilibrium with all lines taut was found");
}

Polygon equal_hung_masses(const Statics& s, int n) {
  require_count(n);
  require_first_order(s);
  return hung_masses(s.guy, std::vector<double>(n + 1, s.length / (n + 1)), std::vector<double>(n, s.guy.weight() * s.length / (n + 1)));
}

}  // namespace whirl::models::guy
