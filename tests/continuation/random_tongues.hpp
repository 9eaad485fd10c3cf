// Parametrically excited systems whose tongues of instability are known without balance, collocation or walker: periods are integrated step by step
// (Runge-Kutta-Fehlberg), planar motions found by Newton on the period map, and the edges of the tongues by
//
//     det(M + I) = 0   period doublings        det(M - I) = 0   branch points        prod_{i<j} (1 - mu_i mu_j) = 0   torus points
//
// per block of coordinates that the planar motion leaves uncoupled. Each touches zero as a parabola where two multipliers meet: on a grid of
// frequencies the roots are bracketed, the minima followed to their bottom.
#pragma once

#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/roots.hpp>
#include <random>

#include "continuation/walker.hpp"
#include "models/multimode/cable_model.hpp"
#include "models/stroboscope.hpp"

namespace whirl::tongues {

using namespace models;
using continuation::EventType;

struct Edge {
  EventType type;
  double omega;
};

struct Case {
  std::string family;
  std::shared_ptr<ParametricSystem> system;
  std::vector<CoordinateReflection> reflections;
  std::vector<std::vector<int>> blocks;
  double resonance, window;  // frequencies looked at: resonance (1 -+ window)
  int harmonics;
};

class Reference {
 public:
  explicit Reference(const Case& c) : case_(c), state_(Vector::Zero(2 * static_cast<Eigen::Index>(coordinates(c)))) {}

  // Every edge in [lower, upper], in order; `ok` false where the planar motion was lost.
  std::vector<Edge> edges(double lower, double upper, int points, bool& ok) {
    std::vector<Edge> found;
    ok = true;
    for (std::size_t b = 0; b < case_.blocks.size() && ok; ++b)
      for (const EventType type : {EventType::period_doubling, EventType::branch_point, EventType::torus}) {
        if (type == EventType::torus && case_.blocks[b].size() < 2) continue;
        scan(b, type, lower, upper, points, found, ok);
      }
    std::sort(found.begin(), found.end(), [](const Edge& p, const Edge& q) { return p.omega < q.omega; });
    return found;
  }

  double function(std::size_t block, EventType type, double omega, bool& ok) {
    const Matrix& m = monodromy(omega, ok);
    if (!ok) return std::nan("");
    const auto& which = case_.blocks[block];
    const auto n = static_cast<Eigen::Index>(which.size()), all = m.rows() / 2;
    Matrix a(2 * n, 2 * n);
    for (Eigen::Index i = 0; i < 2 * n; ++i)
      for (Eigen::Index j = 0; j < 2 * n; ++j)
        a(i, j) = m(which[static_cast<std::size_t>(i % n)] + (i < n ? 0 : all), which[static_cast<std::size_t>(j % n)] + (j < n ? 0 : all));
    const Matrix one = Matrix::Identity(2 * n, 2 * n);
    if (type == EventType::period_doubling) return (a + one).determinant();
    if (type == EventType::branch_point) return (a - one).determinant();
    const Eigen::VectorXcd mu = a.eigenvalues();
    std::complex<double> product = 1.0;
    for (Eigen::Index i = 0; i < mu.size(); ++i)
      for (Eigen::Index j = i + 1; j < mu.size(); ++j) product *= 1.0 - mu[i] * mu[j];
    return product.real();
  }

 private:
  static std::size_t coordinates(const Case& c) {
    std::size_t n = 0;
    for (const auto& b : c.blocks) n += b.size();
    return n;
  }

  // Of the planar motion next to the last one found.
  const Matrix& monodromy(double omega, bool& ok) {
    if (const auto known = known_.find(omega); known != known_.end()) return known->second;
    ModalSystem<double> system;
    case_.system->at(std::span<const double>(&omega, 1), system);
    Stroboscope strobe(system, {.relative_tolerance = 1e-13, .absolute_tolerance = 1e-15});
    Matrix& m = known_[omega];
    ok = false;
    for (int i = 0; i < 8 && !ok; ++i) {
      Vector end = state_;
      m.resize(state_.size(), state_.size());
      if (!strobe.map(end, m)) return m;
      const Vector defect = end - state_;
      ok = defect.norm() <= 1e-11 * state_.norm();
      if (!ok) state_ -= (m - Matrix::Identity(m.rows(), m.cols())).partialPivLu().solve(defect);
    }
    return m;
  }

  void scan(std::size_t block, EventType type, double lower, double upper, int points, std::vector<Edge>& found, bool& ok) {
    const auto f = [&](double omega) { return function(block, type, omega, ok); };
    const auto root = [&](double a, double b) {
      std::uintmax_t most = 60;
      const auto bracket = boost::math::tools::toms748_solve(f, a, b, boost::math::tools::eps_tolerance<double>(48), most);
      found.push_back({type, 0.5 * (bracket.first + bracket.second)});
    };
    std::vector<double> at, value;
    for (int i = 0; i <= points && ok; ++i) {
      at.push_back(lower + (upper - lower) * i / points);
      value.push_back(f(at.back()));
    }
    for (std::size_t i = 0; i + 1 < value.size() && ok; ++i)
      if (value[i] * value[i + 1] < 0.0) root(at[i], at[i + 1]);
    for (std::size_t i = 0; i + 1 < value.size() && ok; ++i) {  // minima, those next to the ends of the range as well
      const double left = i == 0 ? value[i] : value[i - 1], sign = value[i] > 0.0 ? 1.0 : -1.0;
      if (!(left * value[i] > 0.0 && value[i] * value[i + 1] > 0.0 && std::abs(value[i]) <= std::abs(left)) && i > 0) continue;
      if (!(value[i] * value[i + 1] > 0.0)) continue;
      if (i > 0 && std::abs(value[i]) > std::abs(value[i + 1]) && i + 2 < value.size()) continue;
      const double from = i == 0 ? at[0] : at[i - 1], to = at[i + 1];
      const auto [bottom, least] = boost::math::tools::brent_find_minima([&](double w) { return sign * f(w); }, from, to, 30);
      if (!ok || !(least < 0.0)) continue;
      root(from, bottom);
      root(bottom, to);
    }
  }

  const Case& case_;
  Vector state_;
  std::map<double, Matrix> known_;
};

inline double log_uniform(std::mt19937& random, double from, double to) {
  return from * std::exp(std::uniform_real_distribution<double>(0.0, std::log(to / from))(random));
}

// q'' + 2 zeta q' + (1 + e cos(omega t)) q + q^3 = 0 about q = 0 near 2/n.
inline Case mathieu_duffing(std::mt19937& random) {
  const double zeta = log_uniform(random, 1e-4, 1e-2);
  const int order = std::uniform_int_distribution<int>(1, 2)(random);
  const double least = order == 1 ? 4.0 * zeta : std::sqrt(16.0 * zeta);  // below it no tongue of this order, roughly
  const double e = std::min(0.6, least * log_uniform(random, 0.5, 30.0));
  ModalSystem<double> s;
  s.omega = 2.0 / order;
  s.damping = {2.0 * zeta};
  s.stiffness = {1.0};
  s.add_term(0, e, {0}, 1);
  s.add_term(0, 1.0, {0, 0, 0});
  return {"Mathieu-Duffing", std::make_shared<ParametricSystem>(ParametricSystem::over_omega(s)), {}, {{0}}, 2.0 / order, 0.2, 6};
}

// Moved along its chord by 0.5 to `strongest` times what makes the first mode unstable.
inline CableModel random_stay(std::mt19937& random, double strongest) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  CableModel m;
  const double tension = 4e6 + 4e6 * unit(random);
  m.stay.cable = {150.0 + 150.0 * unit(random), 1.0e9 + 1.5e9 * unit(random), tension, 60.0 + 50.0 * unit(random), 15.0 + 30.0 * unit(random), 9.81};
  m.stay.damping_out_of_plane = log_uniform(random, 1e-4, 1e-2);
  m.stay.damping_in_plane = m.stay.damping_out_of_plane * (unit(random) < 0.5 ? 1.0 : log_uniform(random, 0.5, 2.0));
  // Motion along the chord is what excites parametrically: e1 = U/L changes the tension by AE U/L; 2 zeta = half of that over T.
  const double least = 4.0 * m.stay.damping_out_of_plane * tension * m.stay.cable.chord_length / m.stay.cable.axial_stiffness;
  m.direction = Direction::chord;
  m.stay.support_amplitude = std::min(0.05, least * log_uniform(random, 0.5, strongest));
  m.stay.omega = 1.0;
  m.longitudinal = unit(random) < 0.5 ? Longitudinal::galerkin : Longitudinal::quasi_static;
  return m;
}

// One or two modes a plane of a random stay near twice its first frequency, or near a sum of two.
inline Case cable(std::mt19937& random, int modes) {
  CableModel m = random_stay(random, modes == 1 ? 10.0 : 40.0);
  m.out_of_plane = m.in_plane = lowest_half_waves(modes);
  const double w1 = std::sqrt(m.stay.cable.chord_tension / m.stay.cable.mass_per_length) * std::numbers::pi / m.stay.cable.chord_length;
  const double multiple = modes == 1 ? 2.0 : std::uniform_int_distribution<int>(2, 4)(random);  // 2 w1, w1 + w2, 2 w2
  m.stay.omega = multiple * w1;
  Case c{modes == 1 ? "two modes" : "2 + 2 modes",
         std::make_shared<ParametricSystem>(cable_system(m, {Lens("omega")})),
         cable_reflections(m),
         {},
         multiple * w1,
         0.06,
         8};
  c.blocks = modes == 1 ? std::vector<std::vector<int>>{{0}, {1}} : std::vector<std::vector<int>>{{0, 1}, {2, 3}};
  return c;
}

// q1'' + 2 zeta w1 q1' + w1^2 q1 + e cos(omega t) q2 = 0 and the like for q2, about rest near w1 + w2: torus points.
inline Case sum_resonance(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double zeta = log_uniform(random, 1e-4, 1e-2), w2 = 1.2 + 0.7 * unit(random), ratio = log_uniform(random, 0.5, 2.0);
  const double least = 4.0 * zeta * w2 * std::sqrt(ratio);
  ModalSystem<double> s;
  s.omega = 1.0 + w2;
  s.damping = {2.0 * zeta, 2.0 * zeta * ratio * w2};
  s.stiffness = {1.0, w2 * w2};
  const double e = std::min(0.5, least * log_uniform(random, 0.5, 30.0));
  s.add_term(0, e, {1}, 1);
  s.add_term(1, e, {0}, 1);
  for (const int i : {0, 1}) s.add_term(i, 1.0, {i, i, i});
  return {"sum of two", std::make_shared<ParametricSystem>(ParametricSystem::over_omega(s)), {}, {{0, 1}}, s.omega, 0.15, 6};
}

// Stretch of frequencies of 1 to `most` times the width of a tongue, which lies anywhere in it; without a tongue one about the resonance.
inline std::pair<double, double> stretch(const Case& c, const std::vector<Edge>& edges, std::mt19937& random, double most) {
  const double lowest = c.resonance * (1.0 - c.window), highest = c.resonance * (1.0 + c.window);
  double from = c.resonance * (1.0 - 0.1 * c.window), to = c.resonance * (1.0 + 0.1 * c.window);
  if (edges.size() >= 2) {
    const std::size_t first = std::uniform_int_distribution<std::size_t>(0, edges.size() - 2)(random);
    from = edges[first].omega;
    to = edges[first + 1].omega;
  }
  const double width = std::max(to - from, 1e-6 * c.resonance), whole = width * (1.0 + log_uniform(random, 0.1, most));
  const double before = std::uniform_real_distribution<double>(0.02, 0.98)(random) * (whole - width);
  return {std::max(lowest, from - before - 0.01 * width), std::min(highest, to + (whole - width - before) + 0.01 * width)};
}

struct Comparison {
  int edges = 0, missed = 0, extra = 0, unresolved = 0, points = 0, undecided = 0;
  bool ok = false;
};

// Default steps along the planar motion, beside the reference.
inline Comparison compare(const Case& c, double lower, double upper, int grid) {
  Comparison out;
  Reference reference(c);
  const auto edges = reference.edges(lower, upper, grid, out.ok);
  if (!out.ok) return out;
  const HarmonicBalance hb(*c.system, {.harmonics = c.harmonics, .nu = 1, .reflections = c.reflections, .floquet = {}});
  const NewtonResult start = newton(hb, hb.linear_response(Vector::Constant(1, lower)));
  if (!start.ok()) return out;
  const continuation::Branch b = continuation::Walker(hb, {.lower = lower, .upper = upper}).walk(start.x);
  out.points = b.points();
  std::vector<bool> matched(b.special.size(), false);
  for (const Edge& e : edges) {
    bool found = false;
    for (std::size_t i = 0; i < b.special.size() && !found; ++i) {
      if (matched[i] || b.special[i].type != e.type || std::abs(b.special[i].u[hb.size()] - e.omega) > 1e-7 * e.omega) continue;
      matched[i] = found = true;
    }
    out.missed += found ? 0 : 1;
  }
  out.edges = static_cast<int>(edges.size());
  for (std::size_t i = 0; i < b.special.size(); ++i) {
    out.extra += matched[i] || b.special[i].type == EventType::unresolved ? 0 : 1;
    out.unresolved += b.special[i].type == EventType::unresolved ? 1 : 0;
  }
  return out;
}

}  // namespace whirl::tongues
