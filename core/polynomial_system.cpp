#include "core/polynomial_system.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <functional>
#include <random>
#include <stdexcept>

namespace whirl {
namespace {

using Complex = std::complex<double>;
using CVector = Eigen::VectorXcd;
using CMatrix = Eigen::MatrixXcd;

// Without the check for infinities that the language asks of complex products.
Complex times(Complex a, Complex b) { return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()}; }

// A square system with its Jacobian, evaluated without allocation.
class System {
 public:
  virtual ~System() = default;
  virtual void evaluate(const CVector& x, CVector& f, CMatrix& j) const = 0;
};

// Sums of products of unknowns: each monomial as the list of its factors.
class Sums : public System {
 public:
  explicit Sums(const PolynomialSystem& s) {
    for (int e = 0; e < s.unknowns(); ++e) {
      double largest = 0.0;
      for (const auto& m : s.equations[static_cast<std::size_t>(e)]) largest = std::max(largest, std::abs(m.coefficient));
      for (const auto& m : s.equations[static_cast<std::size_t>(e)]) {
        if (m.coefficient == 0.0) continue;
        Product p{e, m.coefficient / largest, {}};
        for (std::size_t v = 0; v < m.powers.size(); ++v)
          p.factors.insert(p.factors.end(), static_cast<std::size_t>(m.powers[v]), static_cast<int>(v));
        longest_ = std::max(longest_, p.factors.size());
        products_.push_back(std::move(p));
      }
    }
    before_.resize(longest_ + 1);
  }
  void evaluate(const CVector& x, CVector& f, CMatrix& j) const override {
    f.setZero();
    j.setZero();
    for (const auto& p : products_) {
      before_[0] = p.coefficient;
      for (std::size_t i = 0; i < p.factors.size(); ++i) before_[i + 1] = times(before_[i], x[p.factors[i]]);
      f[p.equation] += before_[p.factors.size()];
      Complex behind = 1.0;
      for (std::size_t i = p.factors.size(); i-- > 0;) {
        j(p.equation, p.factors[i]) += times(before_[i], behind);
        behind = times(behind, x[p.factors[i]]);
      }
    }
  }

 private:
  struct Product {
    int equation;
    Complex coefficient;
    std::vector<int> factors;
  };
  std::vector<Product> products_;
  std::size_t longest_ = 0;
  mutable std::vector<Complex> before_;
};

// Each equation a product of affine forms, each of the unknowns of one group.
class Products : public System {
 public:
  struct Form {
    int group;
    CVector slope;  // zero outside its group
    Complex constant;
  };
  std::vector<std::vector<Form>> equations;

  void evaluate(const CVector& x, CVector& f, CMatrix& j) const override {
    j.setZero();
    for (std::size_t e = 0; e < equations.size(); ++e) {
      const auto& forms = equations[e];
      const auto value = [&](const Form& form) { return (form.slope.transpose() * x).value() + form.constant; };
      Complex all = 1.0;
      for (std::size_t i = 0; i < forms.size(); ++i) {
        all *= value(forms[i]);
        Complex others = 1.0;
        for (std::size_t k = 0; k < forms.size(); ++k)
          if (k != i) others *= value(forms[k]);
        j.row(static_cast<Eigen::Index>(e)) += others * forms[i].slope.transpose();
      }
      f[static_cast<Eigen::Index>(e)] = all;
    }
  }
};

Complex random_unit(std::mt19937& random) { return std::polar(1.0, std::uniform_real_distribution<double>(0.0, 6.283185307179586)(random)); }

enum class End { root, infinity, failed };

// Follows one path of (1 - t) gamma g + t f.
class Tracker {
 public:
  Tracker(const System& g, const System& f, Complex gamma, const HomotopyOptions& o, int n)
      : g_(g), f_(f), gamma_(gamma), o_(o), vg_(n), vf_(n), h_(n), dx_(n), jg_(n, n), jf_(n, n), lu_(n) {}

  End track(CVector& x, double refinement) {
    const double largest_guess = o_.largest_guess * refinement;
    double t = 0.0, step = o_.first_step * refinement, before = 0.0;
    CVector slope = CVector::Zero(x.size()), last = x, last_slope = slope, guess;
    linearise(x, t);
    slope = tangent();
    for (int i = 0; i < o_.max_steps; ++i) {
      if (t >= 1.0) return polish(x);
      const double next = std::min(1.0, t + step);
      guess = t > before ? hermite(last, last_slope, before, x, slope, t, next) : CVector(x + (next - t) * slope);
      if (correct(guess, next, largest_guess)) {
        last = x;
        last_slope = slope;
        before = t;
        x = guess;
        t = next;
        linearise(x, t);
        slope = tangent();
        if (first_correction_ < 0.1 * largest_guess) step = std::min(2.0 * step, o_.longest_step * refinement);
      } else {
        step *= 0.4;
        if (step < o_.shortest_step) break;
      }
      if (!(x.norm() < o_.infinity)) return End::infinity;
    }
    return t > 1.0 - 1e-6 && polish(x) == End::root ? End::root : End::failed;
  }

 private:
  void linearise(const CVector& x, double t) {
    g_.evaluate(x, vg_, jg_);
    f_.evaluate(x, vf_, jf_);
    h_ = (1.0 - t) * gamma_ * vg_ + t * vf_;
    jg_ = (1.0 - t) * gamma_ * jg_ + t * jf_;
    lu_.compute(jg_);
  }
  CVector tangent() { return lu_.solve(gamma_ * vg_ - vf_); }
  bool correct(CVector& x, double t, double largest_guess) {
    double size = 0.0;
    for (int k = 0; k < o_.max_corrections; ++k) {
      linearise(x, t);
      dx_ = lu_.solve(h_);
      const double now = dx_.norm() / (1.0 + x.norm());
      if (k == 0) first_correction_ = now;
      if (!std::isfinite(now) || now > largest_guess || (k > 0 && now > 0.5 * size)) return false;
      size = now;
      x -= dx_;
      if (size < 1e-7) return true;  // the next step is beyond the square of it
    }
    return false;
  }
  // Newton on f alone; it must not go far.
  End polish(CVector& x) {
    CVector y = x;
    for (int k = 0; k < 12; ++k) {
      f_.evaluate(y, vf_, jf_);
      lu_.compute(jf_);
      dx_ = lu_.solve(vf_);
      if (!dx_.allFinite()) return End::failed;
      y -= dx_;
      if ((y - x).norm() > 1e-2 * (1.0 + x.norm())) return End::failed;
      if (dx_.norm() < o_.tolerance * (1.0 + y.norm())) {
        x = y;
        return End::root;
      }
    }
    return End::failed;
  }
  // The cubic through both points with both slopes, at t.
  static CVector hermite(const CVector& a, const CVector& da, double ta, const CVector& b, const CVector& db, double tb, double t) {
    const double h = tb - ta, s = (t - ta) / h;
    return (1.0 + 2.0 * s) * (1.0 - s) * (1.0 - s) * a + s * (1.0 - s) * (1.0 - s) * h * da + s * s * (3.0 - 2.0 * s) * b +
           s * s * (s - 1.0) * h * db;
  }

  const System &g_, &f_;
  Complex gamma_;
  const HomotopyOptions& o_;
  CVector vg_, vf_, h_, dx_;
  CMatrix jg_, jf_;
  Eigen::PartialPivLU<CMatrix> lu_;
  double first_correction_ = 0.0;
};

bool same(const CVector& a, const CVector& b, double limit) { return (a - b).norm() < limit * (1.0 + a.norm()); }

// All paths from the roots of g. Two that end in one regular root have met on the way: both are followed again with shorter steps.
PolynomialRoots follow(const System& g, const System& f, const std::vector<CVector>& starts, Complex gamma, const HomotopyOptions& o) {
  constexpr double refined = 0.05;
  PolynomialRoots roots;
  roots.paths = static_cast<int>(starts.size());
  if (starts.empty()) return roots;
  Tracker tracker(g, f, gamma, o, static_cast<int>(starts.front().size()));
  std::vector<CVector> ends = starts;
  std::vector<End> how(starts.size());
  for (std::size_t i = 0; i < starts.size(); ++i) how[i] = tracker.track(ends[i], 1.0);
  std::vector<bool> again(starts.size(), false);
  for (std::size_t i = 0; i < starts.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (how[i] == End::root && how[k] == End::root && same(ends[i], ends[k], o.same)) again[i] = again[k] = true;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (again[i]) how[i] = tracker.track(ends[i] = starts[i], refined);
    if (how[i] == End::infinity) ++roots.at_infinity;
    if (how[i] == End::failed) ++roots.failed;
  }
  for (std::size_t i = 0; i < starts.size(); ++i)
    if (how[i] == End::root && std::none_of(roots.finite.begin(), roots.finite.end(), [&](const auto& r) { return same(ends[i], r, o.same); }))
      roots.finite.push_back(ends[i]);
  return roots;
}

int groups_of(const std::vector<int>& group) { return 1 + *std::max_element(group.begin(), group.end()); }

// degree(e, k): of equation e in the unknowns of group k.
Eigen::MatrixXi degrees(const PolynomialSystem& s, const std::vector<int>& group) {
  Eigen::MatrixXi d = Eigen::MatrixXi::Zero(s.unknowns(), groups_of(group));
  for (int e = 0; e < s.unknowns(); ++e)
    for (const auto& m : s.equations[static_cast<std::size_t>(e)]) {
      Eigen::VectorXi own = Eigen::VectorXi::Zero(d.cols());
      for (std::size_t v = 0; v < m.powers.size(); ++v) own[group[v]] += m.powers[v];
      d.row(e) = d.row(e).cwiseMax(own.transpose());
    }
  return d;
}

// Every way to give each equation one of its forms so that each group has as many as unknowns: calls f(choice), (group, form) an equation.
void choices(const Eigen::MatrixXi& degree, Eigen::VectorXi left, std::vector<std::pair<int, int>>& choice,
             const std::function<void(const std::vector<std::pair<int, int>>&)>& f) {
  const auto e = static_cast<Eigen::Index>(choice.size());
  if (e == degree.rows()) return f(choice);
  for (int k = 0; k < degree.cols(); ++k) {
    if (left[k] == 0) continue;
    --left[k];
    for (int form = 0; form < degree(e, k); ++form) {
      choice.emplace_back(k, form);
      choices(degree, left, choice, f);
      choice.pop_back();
    }
    ++left[k];
  }
}

Eigen::VectorXi members(const std::vector<int>& group) {
  Eigen::VectorXi count = Eigen::VectorXi::Zero(groups_of(group));
  for (const int g : group) ++count[g];
  return count;
}

void check_shape(const PolynomialSystem& s, const std::vector<int>& group) {
  if (s.unknowns() < 1 || static_cast<int>(group.size()) != s.unknowns()) throw std::invalid_argument("a square system and a group for each unknown");
  for (const auto& equation : s.equations)
    for (const auto& m : equation)
      if (static_cast<int>(m.powers.size()) != s.unknowns()) throw std::invalid_argument("a monomial needs a power for each unknown");
  if (*std::min_element(group.begin(), group.end()) < 0) throw std::invalid_argument("groups are counted from 0");
}

}  // namespace

void HomotopyOptions::validate() const {
  if (!(tolerance > 0.0 && first_step > 0.0 && longest_step > 0.0 && shortest_step > 0.0 && largest_guess > 0.0 && infinity > 1.0))
    throw std::invalid_argument("homotopy: tolerances and steps must be > 0, infinity > 1");
  if (max_corrections < 1 || max_steps < 1 || max_paths < 1) throw std::invalid_argument("homotopy: counts must be >= 1");
}

int multihomogeneous_bezout(const PolynomialSystem& shape, const std::vector<int>& group, int limit) {
  check_shape(shape, group);
  // The coefficient of prod_k a_k^(members of k) in the product over the equations of (sum_k d_k a_k), equation after equation.
  const Eigen::MatrixXi degree = degrees(shape, group);
  std::vector<std::pair<Eigen::VectorXi, double>> terms{{members(group), 1.0}};
  for (Eigen::Index e = 0; e < degree.rows(); ++e) {
    std::vector<std::pair<Eigen::VectorXi, double>> next;
    for (const auto& [left, count] : terms)
      for (int k = 0; k < degree.cols(); ++k) {
        if (left[k] == 0 || degree(e, k) == 0) continue;
        Eigen::VectorXi rest = left;
        --rest[k];
        const auto at = std::find_if(next.begin(), next.end(), [&](const auto& t) { return t.first == rest; });
        if (at == next.end()) next.emplace_back(rest, count * degree(e, k));
        else at->second += count * degree(e, k);
      }
    terms = std::move(next);
  }
  const double paths = terms.empty() ? 0.0 : terms.front().second;
  return paths > limit ? -1 : static_cast<int>(paths);
}

PolynomialSolver::PolynomialSolver(const PolynomialSystem& shape, const std::vector<int>& group, const HomotopyOptions& options)
    : options_(options), random_(shape) {
  options_.validate();
  if (multihomogeneous_bezout(shape, group, options_.max_paths) < 0)
    throw std::invalid_argument(fmt::format("a polynomial system of more than {} paths", options_.max_paths));
  std::mt19937 random(20);
  for (auto& equation : random_.equations)
    for (auto& m : equation) m.coefficient = random_unit(random);
  const Eigen::MatrixXi degree = degrees(shape, group);
  const auto n = static_cast<Eigen::Index>(group.size());
  Products start;
  for (Eigen::Index e = 0; e < n; ++e) {
    start.equations.emplace_back();
    for (int k = 0; k < degree.cols(); ++k)
      for (int form = 0; form < degree(e, k); ++form) {
        CVector slope = CVector::Zero(n);
        for (Eigen::Index v = 0; v < n; ++v)
          if (group[static_cast<std::size_t>(v)] == k) slope[v] = random_unit(random);
        start.equations.back().push_back({k, slope, random_unit(random)});
      }
  }
  std::vector<CVector> starts;
  std::vector<std::pair<int, int>> choice;
  choices(degree, members(group), choice, [&](const auto& chosen) {
    CMatrix a(n, n);
    CVector b(n);
    for (Eigen::Index e = 0; e < n; ++e) {
      const auto [k, form] = chosen[static_cast<std::size_t>(e)];
      int seen = 0;
      for (const auto& f : start.equations[static_cast<std::size_t>(e)])
        if (f.group == k && seen++ == form) {
          a.row(e) = f.slope.transpose();
          b[e] = -f.constant;
        }
    }
    starts.push_back(a.partialPivLu().solve(b));
  });
  generic_ = follow(start, Sums(random_), starts, random_unit(random), options_);
}

PolynomialRoots PolynomialSolver::solve(const PolynomialSystem& f) const {
  if (f.unknowns() != random_.unknowns()) throw std::invalid_argument("another number of unknowns than the solver's shape");
  for (std::size_t e = 0; e < f.equations.size(); ++e) {
    const auto &own = f.equations[e], &shape = random_.equations[e];
    const bool fits = own.size() == shape.size() &&
                      std::equal(own.begin(), own.end(), shape.begin(), [](const auto& a, const auto& b) { return a.powers == b.powers; });
    if (!fits) throw std::invalid_argument(fmt::format("equation {} has other monomials than the solver's shape", e + 1));
  }
  return follow(Sums(random_), Sums(f), generic_.finite, std::polar(1.0, 0.7), options_);
}

}  // namespace whirl
