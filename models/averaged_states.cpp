#include "models/averaged_states.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <stdexcept>

namespace whirl::models {
namespace {

using Complex = std::complex<double>;
using Key = std::uint64_t;  // powers of up to eight unknowns, one byte each
using Polynomial = std::map<Key, Complex>;
using Series = std::map<int, Polynomial>;  // by harmonic of Omega

constexpr std::size_t most_unknowns = 8;

Key unknown(std::size_t v) { return Key{1} << (8 * v); }

void add(Polynomial& to, const Polynomial& p, Complex factor = 1.0) {
  for (const auto& [key, c] : p) to[key] += factor * c;
}

void add_product(Polynomial& to, const Polynomial& a, const Polynomial& b) {
  for (const auto& [ka, ca] : a)
    for (const auto& [kb, cb] : b) to[ka + kb] += ca * cb;
}

Series product(const Series& a, const Series& b) {
  Series out;
  for (const auto& [ha, pa] : a)
    for (const auto& [hb, pb] : b) add_product(out[ha + hb], pa, pb);
  return out;
}

Series times_cosine(const Series& a, int harmonic) {
  if (harmonic == 0) return a;
  Series out;
  for (const auto& [h, p] : a)
    for (const int shift : {-harmonic, harmonic}) add(out[h + shift], p, 0.5);
  return out;
}

Complex value(const Polynomial& p, const Eigen::VectorXcd& x) {
  Complex sum = 0.0;
  for (const auto& [key, c] : p) {
    Complex product = c;
    for (std::size_t v = 0; v < static_cast<std::size_t>(x.size()); ++v)
      for (Key power = key >> (8 * v) & 0xff; power > 0; --power) product *= x[static_cast<Eigen::Index>(v)];
    sum += product;
  }
  return sum;
}

// The averaged equations at one system.
class Expansion {
 public:
  Expansion(const ModalSystem<double>& s, int nu, const std::vector<int>& harmonics, const AveragedStateOptions& o)
      : s_(s), nu_(nu), k_(harmonics), near_(o.near_resonance) {
    for (std::size_t i = 0; i < k_.size(); ++i)
      if (k_[i] > 0) moving_.push_back(i);
    first_order();
    second_.resize(k_.size());
    if (o.second_order) second_order();
  }

  std::size_t moving() const { return moving_.size(); }

  // Rows: of Z of each moving coordinate, then of W.
  std::vector<Polynomial> equations() const {
    std::vector<Polynomial> rows(2 * moving());
    const std::vector<Series> b = terms_to_third_order();
    for (std::size_t m = 0; m < moving(); ++m)
      for (const int side : {0, 1}) {
        const std::size_t i = moving_[m], row = m + (side == 0 ? 0 : moving());
        const int h = side == 0 ? k_[i] : -k_[i];
        Polynomial& p = rows[row];
        p[unknown(row)] += divisor(i, h);
        if (const auto at = b[i].find(h); at != b[i].end()) add(p, at->second, 2.0);
        for (const auto& f : s_.forces)
          if (f.equation == static_cast<int>(i) && f.harmonic * nu_ == k_[i]) p[0] -= f.amplitude;
      }
    return rows;
  }

  Eigen::MatrixXcd amplitudes(const Eigen::VectorXcd& x) const {
    int highest = 0;
    for (std::size_t i = 0; i < k_.size(); ++i)
      for (const auto* q : {&first_[i], &second_[i]})
        if (!q->empty()) highest = std::max(highest, q->rbegin()->first);
    Eigen::MatrixXcd z = Eigen::MatrixXcd::Zero(static_cast<Eigen::Index>(k_.size()), highest + 1);
    for (std::size_t i = 0; i < k_.size(); ++i)
      for (const auto* q : {&first_[i], &second_[i]})
        for (const auto& [h, p] : *q)
          if (h >= 0) z(static_cast<Eigen::Index>(i), h) += (h == 0 ? 1.0 : 2.0) * value(p, x);
    return z;
  }

 private:
  Complex divisor(std::size_t i, int h) const {
    const double speed = s_.omega * h / nu_;
    return {s_.stiffness[i] - speed * speed, s_.damping[i] * speed};
  }
  bool second_order_term(const Term<double>& t) const { return t.degree + (t.cos_harmonic > 0 ? 1 : 0) == 2; }

  void first_order() {
    first_.resize(k_.size());
    for (std::size_t m = 0; m < moving(); ++m) {
      const std::size_t i = moving_[m];
      first_[i][k_[i]][unknown(m)] = 0.5;
      first_[i][-k_[i]][unknown(moving() + m)] = 0.5;
    }
    for (const auto& f : s_.forces) {
      const auto i = static_cast<std::size_t>(f.equation);
      const int h = f.harmonic * nu_;
      if (h == k_[i] && h > 0) continue;
      for (const int side : {h, -h}) first_[i][side][0] += 0.5 * f.amplitude / divisor(i, side);  // a constant force: both sides, the whole
    }
  }

  void second_order() {
    for (const auto& t : s_.terms) {
      if (!second_order_term(t)) continue;
      const auto i = static_cast<std::size_t>(t.equation);
      for (const auto& [h, p] : term(t, first_, first_)) {
        const Complex d = divisor(i, h);
        const double speed = s_.omega * h / nu_;
        if (std::abs(h) == k_[i] || std::abs(d) < near_ * (std::abs(s_.stiffness[i]) + speed * speed)) continue;
        add(second_[i][h], p, -1.0 / d);
      }
    }
  }

  // One term with its first factor from a and the others from b.
  Series term(const Term<double>& t, const std::vector<Series>& a, const std::vector<Series>& b) const {
    Series all = t.degree == 0 ? Series{{0, {{0, 1.0}}}} : a[static_cast<std::size_t>(t.factor[0])];
    for (int f = 1; f < t.degree; ++f) all = product(all, b[static_cast<std::size_t>(t.factor[static_cast<std::size_t>(f)])]);
    all = times_cosine(all, t.cos_harmonic * nu_);
    for (auto& [h, p] : all)
      for (auto& [key, c] : p) c *= t.coefficient;
    return all;
  }

  std::vector<Series> terms_to_third_order() const {
    std::vector<Series> b(k_.size());
    const auto add_term = [&](const Term<double>& t, const std::vector<Series>& first, const std::vector<Series>& others) {
      for (const auto& [h, p] : term(t, first, others)) add(b[static_cast<std::size_t>(t.equation)][h], p);
    };
    for (const auto& t : s_.terms) {
      if (moving() == 0 || k_[static_cast<std::size_t>(t.equation)] == 0) continue;
      add_term(t, first_, first_);
      if (!second_order_term(t)) continue;
      add_term(t, second_, first_);
      if (t.degree == 2) add_term(t, first_, second_);
    }
    return b;
  }

  const ModalSystem<double>& s_;
  int nu_;
  const std::vector<int>& k_;
  double near_;
  std::vector<std::size_t> moving_;
  std::vector<Series> first_, second_;
};

// Largest of the sizes at which the monomials of the highest degree balance the others.
double scale_of(const std::vector<Polynomial>& rows) {
  double scale = 0.0;
  for (const auto& row : rows) {
    std::map<int, double> largest;  // by degree
    for (const auto& [key, c] : row) {
      double& at = largest[static_cast<int>((key * 0x0101010101010101ull) >> 56)];
      at = std::max(at, std::abs(c));
    }
    const auto [top, coefficient] = *largest.rbegin();
    for (const auto& [degree, c] : largest)
      if (degree < top && coefficient > 0.0) scale = std::max(scale, std::pow(c / coefficient, 1.0 / (top - degree)));
  }
  return scale > 0.0 && std::isfinite(scale) ? scale : 1.0;
}

PolynomialSystem scaled(const std::vector<Polynomial>& rows, double scale) {
  PolynomialSystem s;
  for (const auto& row : rows) {
    s.equations.emplace_back();
    for (const auto& [key, c] : row) {
      Monomial m{c, std::vector<int>(rows.size())};
      for (std::size_t v = 0; v < rows.size(); ++v) {
        m.powers[v] = static_cast<int>(key >> (8 * v) & 0xff);
        m.coefficient *= std::pow(scale, m.powers[v]);
      }
      s.equations.back().push_back(std::move(m));
    }
  }
  return s;
}

bool same_monomials(const PolynomialSystem& a, const PolynomialSystem& b) {
  return a.unknowns() == b.unknowns() && std::equal(a.equations.begin(), a.equations.end(), b.equations.begin(), [](const auto& x, const auto& y) {
           return x.size() == y.size() &&
                  std::equal(x.begin(), x.end(), y.begin(), [](const auto& m, const auto& n) { return m.powers == n.powers; });
         });
}

}  // namespace

AveragedStates::AveragedStates(int nu, std::vector<int> harmonics, const AveragedStateOptions& options)
    : nu_(nu), harmonics_(std::move(harmonics)), options_(options) {
  const auto moving = std::count_if(harmonics_.begin(), harmonics_.end(), [](int k) { return k > 0; });
  if (nu < 1) throw std::invalid_argument(fmt::format("averaged states need nu >= 1, got {}", nu));
  if (std::any_of(harmonics_.begin(), harmonics_.end(), [](int k) { return k < 0; })) throw std::invalid_argument("harmonics must be >= 0");
  if (moving < 1 || 2 * static_cast<std::size_t>(moving) > most_unknowns)
    throw std::invalid_argument(fmt::format("one to {} coordinates have a harmonic of their own, got {}", most_unknowns / 2, moving));
}

const PolynomialSolver& AveragedStates::solver_for(const PolynomialSystem& polynomials, const std::vector<int>& group) {
  for (const auto& [shape, solver] : solvers_)
    if (same_monomials(shape, polynomials)) return *solver;
  solvers_.emplace_back(polynomials, std::make_unique<PolynomialSolver>(polynomials, group));
  return *solvers_.back().second;
}

std::vector<Eigen::MatrixXcd> AveragedStates::solve(const ModalSystem<double>& system) {
  if (static_cast<int>(harmonics_.size()) != system.size())
    throw std::invalid_argument(fmt::format("{} harmonics for {} coordinates", harmonics_.size(), system.size()));
  const Expansion expansion(system, nu_, harmonics_, options_);
  const auto rows = expansion.equations();
  const double scale = scale_of(rows);
  const PolynomialSystem polynomials = scaled(rows, scale);
  const auto n = static_cast<Eigen::Index>(expansion.moving());
  std::vector<int> group(rows.size(), 1);
  std::fill_n(group.begin(), n, 0);
  roots_ = -1;
  if (multihomogeneous_bezout(polynomials, group, options_.max_paths) < 0) return {};
  const PolynomialRoots all = solver_for(polynomials, group).solve(polynomials);
  roots_ = static_cast<int>(all.finite.size());
  std::vector<Eigen::MatrixXcd> states;
  for (const auto& x : all.finite)
    if ((x.tail(n) - x.head(n).conjugate()).norm() < options_.real * (1.0 + x.norm())) states.push_back(expansion.amplitudes(scale * x));
  return states;
}

std::vector<std::vector<int>> likely_resonances(const ModalSystem<double>& s, int nu, const ResonanceOptions& o) {
  const auto n = static_cast<std::size_t>(s.size());
  const std::size_t most = n == 3 ? 3 : static_cast<std::size_t>(o.most_moving);
  const auto distance = [&](std::size_t i, double order) {  // octaves or so from resonance; beyond reach without end
    const double ratio = s.stiffness[i] > 0.0 ? order * s.omega / std::sqrt(s.stiffness[i]) : 0.0;
    return ratio > o.below && ratio < o.above ? std::abs(std::log(ratio)) : std::numeric_limits<double>::infinity();
  };
  std::vector<std::vector<int>> sets;
  std::vector<int> mixed(n, 0);
  std::vector<double> nearest(n, std::numeric_limits<double>::infinity());
  const auto keep_nearest = [&](std::vector<int>& harmonics, const std::function<double(std::size_t)>& far) {
    std::vector<std::size_t> moving;
    for (std::size_t i = 0; i < n; ++i)
      if (harmonics[i] > 0) moving.push_back(i);
    std::sort(moving.begin(), moving.end(), [&](std::size_t a, std::size_t b) { return far(a) < far(b); });
    for (std::size_t m = most; m < moving.size(); ++m) harmonics[moving[m]] = 0;
    if (!moving.empty() && std::find(sets.begin(), sets.end(), harmonics) == sets.end()) sets.push_back(harmonics);
  };
  for (const double order : o.orders) {
    const int k = static_cast<int>(std::lround(order * nu));
    if (k < 1 || std::abs(k - order * nu) > 1e-9) continue;
    std::vector<int> harmonics(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      if (std::isinf(distance(i, order))) continue;
      harmonics[i] = k;
      if (distance(i, order) >= nearest[i]) continue;
      nearest[i] = distance(i, order);
      mixed[i] = k;
    }
    keep_nearest(harmonics, [&](std::size_t i) { return distance(i, order); });
  }
  keep_nearest(mixed, [&](std::size_t i) { return nearest[i]; });
  return sets;
}

}  // namespace whirl::models
