#include "continuation/codimension_two.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "continuation/parabola.hpp"
#include "core/newton.hpp"

namespace whirl::continuation {
namespace {

struct Station {  // a point of the walk, or one between two of them
  Sample at;
  double arclength = 0.0;
  std::vector<double> value;  // of each test
};

class Search {
 public:
  Search(SpecialCurve& curve, const Branch& walked, const TwoParameterOptions& options, const CodimensionTwoOptions& limits)
      : curve_(curve),
        walked_(walked),
        options_(options),
        limits_(limits),
        tests_(curve.tests()),
        on_(curve.system(), make_blocks(curve.system(), {}), options.walk.corrector),
        enclosing_(tests_.size()) {}

  std::vector<CodimensionTwo> run(const std::function<void(int)>& each);

 private:
  Station station(int i);
  void measure(const Station& a, const Station& b, Sample& from, Sample& to);
  bool between(const Station& a, const Station& b, double sigma, Station& out);
  void guess(const Station& a, const Station& b, double sigma, Station& out);
  void compare(const Station& last, std::size_t t);
  void enclose(const Station& a, const Station& b, std::size_t t);
  void look_beside_double_root(const Station& a, const Station& b);
  void look_near_vertex(const Station& a, const Station& b, const Station& c, std::size_t t);
  bool is_rounding(double f, double g) const { return std::max(std::abs(f), std::abs(g)) < limits_.noise; }
  bool is_genuine(const Sample& at, std::size_t t, const Station& a, const Station& b) const;
  void add(const std::string& type, const Sample& at, double arclength);
  void settle_contacts();
  void add_extrema();
  bool is_extremum(const SpecialPoint& turn) const;
  bool is_known(const CodimensionTwo& point) const;
  bool symmetric(const Vector& u) const;

  SpecialCurve& curve_;
  const Branch& walked_;
  const TwoParameterOptions& options_;
  const CodimensionTwoOptions& limits_;
  std::vector<CurveTest> tests_;
  Curve on_;
  std::vector<std::optional<Station>> enclosing_;              // per test the last point at which it was not zero
  std::vector<double> largest_odd_;                            // on the curve, for each reflection
  double farthest_from_branch_points_ = 0.0;                   // of a fold curve
  double largest_state_ = 0.0;                                 // on the curve
  double largest_unknown_ = 0.0;                               // the same with what the system adds to the state
  std::vector<std::pair<CodimensionTwo, double>> candidates_;  // of a fold curve, with the distance from branch points
  std::vector<CodimensionTwo> found_;
};

Station Search::station(int i) {
  Station s;
  s.at.u = walked_.u(i);
  s.at.tangent = walked_.tangent(i);
  s.at.residual = walked_.residual(i);
  s.arclength = walked_.arclength(i);
  for (const auto& test : tests_) s.value.push_back(test.value(s.at.u));
  return s;
}

// Both ends of a step in the metric of the curve: that of the step alone would vanish where the state does.
void Search::measure(const Station& a, const Station& b, Sample& from, Sample& to) {
  on_.set_scales(largest_unknown_ > 0.0 ? largest_unknown_ : 1.0, options_.range2[1] - options_.range2[0]);
  from = a.at;
  to = b.at;
  from.tangent /= on_.length(from.tangent);
  to.tangent /= on_.length(to.tangent);
}

// A point of the curve between two others, without test values.
bool Search::between(const Station& a, const Station& b, double sigma, Station& out) {
  Sample from, to;
  measure(a, b, from, to);
  if (!on_.between(from, to, sigma, out.at)) return false;
  // Where curves cross Newton may come down on the other one.
  const double chord = on_.length(to.u - from.u);
  if (on_.length(out.at.u - (1.0 - sigma) * from.u - sigma * to.u) > chord) return false;
  out.arclength = a.arclength + sigma * (b.arclength - a.arclength);
  return true;
}

// The same on the cubic through both ends, not corrected.
void Search::guess(const Station& a, const Station& b, double sigma, Station& out) {
  Sample from, to;
  measure(a, b, from, to);
  on_.guess(from, to, sigma, out.at);
  out.at.residual = std::max(from.residual, to.residual);
  out.arclength = a.arclength + sigma * (b.arclength - a.arclength);
}

std::vector<CodimensionTwo> Search::run(const std::function<void(int)>& each) {
  const Problem& f = curve_.problem();
  for (int r = 0; r < static_cast<int>(f.reflections().size()); ++r) {
    double largest = 0.0;
    for (int i = 0; i < walked_.points(); ++i)
      for (const int k : odd_coordinates(f, r)) largest = std::max(largest, std::abs(curve_.base(walked_.u(i))[k]));
    largest_odd_.push_back(largest);
  }
  for (int i = 0; i < walked_.points(); ++i) {
    largest_state_ = std::max(largest_state_, curve_.base(walked_.u(i)).head(f.size()).norm());
    largest_unknown_ = std::max(largest_unknown_, walked_.u(i).head(curve_.system().size()).norm());
  }
  Station before, last, now;
  for (int i = 0; i < walked_.points(); ++i) {
    curve_.update_borders(walked_.u(i));
    each(i);
    now = station(i);
    if (curve_.point().type == EventType::fold)
      farthest_from_branch_points_ = std::max(farthest_from_branch_points_, curve_.apart_from_branch_points(now.at.u));
    for (std::size_t t = 0; t < tests_.size(); ++t) {
      compare(now, t);
      if (i > 1) look_near_vertex(before, last, now, t);
    }
    if (i > 0 && curve_.kappa(last.at.u) * curve_.kappa(now.at.u) < 0.0) look_beside_double_root(last, now);
    before = std::move(last);
    last = std::move(now);
  }
  settle_contacts();
  add_extrema();
  for (const auto& s : walked_.special)
    if (s.type == EventType::user_value) add("UZ", {.u = s.u, .tangent = s.tangent, .signature = {}, .residual = s.residual}, s.arclength);
  std::sort(found_.begin(), found_.end(), [](const auto& p, const auto& q) { return p.arclength < q.arclength; });
  return std::move(found_);
}

// A change of sign since the test was last told from zero.
void Search::compare(const Station& now, std::size_t t) {
  const double g = now.value[t];
  auto& last = enclosing_[t];
  if (!std::isfinite(g)) {
    last.reset();
    return;
  }
  if (g == 0.0 || (last && std::abs(g) < limits_.zero * std::abs(last->value[t]))) return;
  if (last && last->value[t] * g < 0.0) enclose(*last, now, t);
  last = now;
}

// Secant and bisection. Where the curve crosses another of its kind just there it has no point to compute: beside it, and from where the bracket is
// narrow on the cubic through its ends.
void Search::enclose(const Station& a, const Station& b, std::size_t t) {
  constexpr double narrow = 1e-3, beside = 0.08;  // of the step; of the bracket
  if (is_rounding(a.value[t], b.value[t])) return;
  double lo = 0.0, hi = 1.0, f = a.value[t], g = b.value[t];
  Station m, left = a, right = b;
  bool crossing = false;  // left and right are as near as points of the curve can be had
  double from = 0.0, to = 1.0;
  for (int k = 0; k < 80 && hi - lo > 1e-14; ++k) {
    double sigma = k % 3 == 2 ? 0.5 * (lo + hi) : std::clamp(lo + (hi - lo) * f / (f - g), lo + 0.01 * (hi - lo), hi - 0.01 * (hi - lo));
    bool met = !crossing && between(a, b, sigma, m);
    for (int side = 0; !crossing && !met && side < 2 && hi - lo > narrow; ++side) {
      const double next = sigma + (side == 0 ? beside : -beside) * (hi - lo);
      met = next > lo && next < hi && between(a, b, next, m);
      if (met) sigma = next;
    }
    if (!met) {
      if (!crossing) {
        from = lo;
        to = hi;
      }
      crossing = true;
      guess(left, right, (sigma - from) / (to - from), m);
    }
    const double h = tests_[t].value(m.at.u);
    if (!std::isfinite(h)) return;
    if (h == 0.0) break;
    const bool early = (h > 0.0) == (f > 0.0);
    (early ? lo : hi) = sigma;
    (early ? f : g) = h;
    if (!crossing) (early ? left : right) = m;
  }
  if (is_genuine(m.at, t, a, b)) add(tests_[t].type, m.at, m.arclength);
}

// A pole changes sign as well; at a zero the function is small next to what it was at the ends.
bool Search::is_genuine(const Sample& at, std::size_t t, const Station& a, const Station& b) const {
  const std::string& type = tests_[t].type;
  if (std::abs(tests_[t].value(at.u)) > limits_.pole * std::max(std::abs(a.value[t]), std::abs(b.value[t]))) return false;
  if (type == "ZH" || type == "HH") return curve_.is_crossing(at.u, type);
  // At a Bogdanov-Takens point the first Lyapunov coefficient ends.
  const double kappa = curve_.kappa(at.u);
  return type != "GH" || kappa > 1e-6 * std::max(std::abs(curve_.kappa(a.at.u)), std::abs(curve_.kappa(b.at.u)));
}

// Between a and b the squared frequency passes zero: from the Hopf side towards that point.
void Search::look_beside_double_root(const Station& a, const Station& b) {
  const double ka = curve_.kappa(a.at.u), kb = curve_.kappa(b.at.u);
  Station from = ka > 0.0 ? a : b;
  double root = ka / (ka - kb), hopf_end = ka > 0.0 ? 0.0 : 1.0;
  Station m;
  for (int k = 0; k < 4; ++k) {  // the squared frequency is nearly linear along the curve
    if (!between(a, b, root, m)) return;
    const double km = curve_.kappa(m.at.u);
    root = (km > 0.0) == (ka > 0.0) ? root + (1.0 - root) * km / (km - kb) : root * ka / (ka - km);
  }
  double part = 1.0;
  for (int k = 0; k < limits_.closest_to_double; ++k) {
    part *= 0.25;
    if (!between(a, b, root + part * (hopf_end - root), m) || !(curve_.kappa(m.at.u) > 0.0)) return;
    m.value.clear();
    for (const auto& test : tests_) m.value.push_back(test.value(m.at.u));
    for (std::size_t t = 0; t < tests_.size(); ++t)
      if (tests_[t].type != "BT" && std::isfinite(from.value[t]) && from.value[t] * m.value[t] < 0.0) enclose(from, m, t);
    from = m;
  }
}

// Three values of one sign whose parabola comes near zero: its vertex is looked at, then that of the parabola through the nearest three.
void Search::look_near_vertex(const Station& a, const Station& b, const Station& c, std::size_t t) {
  const double f = a.value[t], g = b.value[t], h = c.value[t];
  if (!(f * g > 0.0 && g * h > 0.0) || is_rounding(f, h)) return;
  struct Knot {
    double s, value;
  } l{a.arclength, f}, m{b.arclength, g}, r{c.arclength, h};
  for (int round = 0; round < limits_.vertex_rounds; ++round) {
    const Parabola parabola(l.s, l.value, m.s, m.value, r.s, r.value);
    if (!parabola.turns_near_zero(l.s, r.s)) return;
    const double s = parabola.turn();
    const bool early = s < b.arclength;
    const Station &from = early ? a : b, &to = early ? b : c;
    Station at;
    if (!between(from, to, (s - from.arclength) / (to.arclength - from.arclength), at)) return;
    const double value = tests_[t].value(at.at.u);
    if (!std::isfinite(value)) return;
    at.value.assign(tests_.size(), std::nan(""));
    at.value[t] = value;
    if (value * g < 0.0) {
      enclose(from, at, t);
      enclose(at, to, t);
      return;
    }
    if (std::abs(value) < limits_.touch * std::max(std::abs(f), std::abs(h))) {
      if (is_genuine(at.at, t, a, c)) add(tests_[t].type, at.at, at.arclength);
      return;
    }
    if (std::abs(value) >= std::abs(m.value)) return;
    (s < m.s ? r : l) = m;
    m = {s, value};
  }
}

// Where the curve meets its mirror image its state is symmetric: the degenerate point of the branch-point curve.
bool Search::symmetric(const Vector& u) const {
  const Problem& f = curve_.problem();
  const auto& active = curve_.blocks().active;
  for (int r = 0; r < static_cast<int>(f.reflections().size()); ++r) {
    if (std::find(active.begin(), active.end(), r) != active.end()) continue;
    double odd = 0.0;
    for (const int i : odd_coordinates(f, r)) odd = std::max(odd, std::abs(u[i]));
    if (odd < 1e-2 * largest_odd_[static_cast<std::size_t>(r)]) return true;
  }
  return false;
}

bool Search::is_known(const CodimensionTwo& point) const {
  const int n = curve_.problem().size();
  const double w1 = options_.range1[1] - options_.range1[0], w2 = options_.range2[1] - options_.range2[0];
  return std::any_of(found_.begin(), found_.end(), [&](const CodimensionTwo& known) {
    return known.type == point.type && std::abs(known.u[n] - point.u[n]) < 1e-6 * w1 && std::abs(known.u[n + 1] - point.u[n + 1]) < 1e-6 * w2 &&
           (known.u - point.u).head(n).norm() <= limits_.same * largest_state_;
  });
}

void Search::add(const std::string& type, const Sample& at, double arclength) {
  CodimensionTwo s;
  s.type = type;
  if (type == "FT") s.subtype = to_string(EventType::fold);  // what is met
  s.u = curve_.base(at.u);
  s.residual = at.residual;
  s.arclength = arclength;
  if (type != "UZ" && symmetric(s.u)) return;
  if (curve_.point().type == EventType::fold && (type == "CP" || type == "BT"))
    candidates_.emplace_back(std::move(s), curve_.apart_from_branch_points(at.u));
  else if (!is_known(s)) found_.push_back(std::move(s));
}

// On folds the quadratic coefficient also vanishes where w'r_p does, both parameters: there the curve touches one of branch points and is no cusp.
void Search::settle_contacts() {
  for (auto& [point, apart] : candidates_) {
    CodimensionTwo contact;
    const bool touches =
        apart < limits_.contact * farthest_from_branch_points_ && degenerate_branch_point_near(curve_.problem(), point.u, options_, contact);
    if (touches && point.type == "CP") {
      contact.arclength = point.arclength;
      point = contact;
    } else if (touches) {
      point.u = contact.u;
      point.residual = contact.residual;
    }
    if (!is_known(point)) found_.push_back(point);
  }
}

// Folds of the curve in the second parameter, found by the walker itself: thresholds.
void Search::add_extrema() {
  for (const auto& s : walked_.special) {
    if (s.type != EventType::fold || curve_.kappa(s.u) <= 0.0 || !is_extremum(s)) continue;  // kappa < 0: of neutral saddles
    add(s.u[s.u.size() - 1] <= s.bracket[0] ? "MIN" : "MAX", {.u = s.u, .tangent = s.tangent, .signature = {}, .residual = s.residual}, s.arclength);
  }
}

// Does the second parameter go away from its value there on both sides, to the neighbouring points or turns? A curve along which it stays put turns
// by rounding all the way, and two turns at one place are none.
bool Search::is_extremum(const SpecialPoint& turn) const {
  constexpr double same_place = 1e-6;  // of the curve's length
  const auto last = turn.u.size() - 1;
  const double value = turn.u[last], least = limits_.flat * std::max(options_.range2[1] - options_.range2[0], std::abs(value));
  const double near = same_place * (walked_.arclength(walked_.points() - 1) - walked_.arclength(0));
  double before = std::nan(""), behind = std::nan(""), nearest_before = -std::numeric_limits<double>::infinity(), nearest_behind = -nearest_before;
  const auto look = [&](double s, double p) {
    if (std::abs(s - turn.arclength) < near && std::abs(p - value) <= least) return;
    if (s < turn.arclength && s > nearest_before) {
      nearest_before = s;
      before = p - value;
    }
    if (s > turn.arclength && s < nearest_behind) {
      nearest_behind = s;
      behind = p - value;
    }
  };
  for (int i = 0; i < walked_.points(); ++i) look(walked_.arclength(i), walked_.parameter(i));
  for (const auto& other : walked_.special)
    if (other.type == EventType::fold) look(other.arclength, other.u[last]);
  return before * behind > 0.0 && std::min(std::abs(before), std::abs(behind)) > least;
}

// What vanishes at the degenerate point along a curve of branch points.
double degeneracy(SpecialCurve& curve, In y, const std::string& type) {
  curve.update_borders(y);
  for (const auto& test : curve.tests())
    if (test.type == type) return test.value(y);
  return std::nan("");
}

}  // namespace

std::vector<CodimensionTwo> codimension_two_points(SpecialCurve& curve, const Branch& walked, const TwoParameterOptions& options,
                                                   const std::function<void(int)>& each, const CodimensionTwoOptions& limits) {
  return Search(curve, walked, options, limits).run(each);
}

bool degenerate_branch_point_near(const Problem& f, In u, const TwoParameterOptions& options, CodimensionTwo& out) {
  const int n = f.size();
  constexpr double part = 1e-3, zero = 1e-7;  // of the second parameter's range, off the point; of a quadratic coefficient: a pitchfork
  const double step = part * (options.range2[1] - options.range2[0]);
  for (const char* subtype : {"TC", "PF"}) {
    SpecialPoint point;
    point.type = EventType::branch_point;
    point.subtype = subtype;
    point.u = u.head(n + 1);
    SpecialCurve curve(f, point, u[n + 1], options);
    const auto at = [&](double p2, Vector& y, double& value) {
      y[y.size() - 1] = p2;
      const NewtonResult r = newton(curve.system(), y, {.tolerance = 1e-13, .max_iterations = 20});
      y = r.x;
      value = degeneracy(curve, y, std::string(subtype) == "TC" ? "FT" : "DP");
      out.residual = r.residual;
      return r.settled() && !curve.dissolved(y) && std::isfinite(value);
    };
    Vector y = curve.start();
    double p = u[n + 1] + step, q = u[n + 1] - step, f0 = 0.0, f1 = 0.0;
    if (!at(p, y, f0) || !at(q, y, f1)) return false;
    if (std::string(subtype) == "TC" && std::max(std::abs(f0), std::abs(f1)) < zero) continue;
    for (int k = 0; k < 30 && std::abs(p - q) > 1e-14 * (std::abs(p) + step) && f0 != f1; ++k) {
      const double next = q - f1 * (q - p) / (f1 - f0);
      p = q;
      f0 = f1;
      q = next;
      if (!(std::abs(q - u[n + 1]) < 10.0 * step) || !at(q, y, f1)) return false;
      if (f1 == 0.0) break;
    }
    out.type = std::string(subtype) == "TC" ? "FT" : "DP";
    out.subtype = std::string(subtype) == "TC" ? "TC" : "";
    out.u = curve.base(y);
    return true;
  }
  return false;
}

}  // namespace whirl::continuation
