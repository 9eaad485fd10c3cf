#include "continuation/symmetries.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace whirl::continuation {
namespace {

struct Trial {
  Vector u, r;
};

// Points (x, p) at which the flow is defined, with its values there.
std::vector<Trial> trials(const Problem& f, const SymmetryOptions& o) {
  constexpr int wanted = 4, tries = 40;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  std::vector<Trial> all;
  for (int i = 0; i < tries && static_cast<int>(all.size()) < wanted; ++i) {
    Trial t{Vector(f.size() + 1), Vector(f.size())};
    for (int k = 0; k < f.size(); ++k) t.u[k] = o.size * entry(random);
    t.u[f.size()] = 0.5 * (o.lower + o.upper) + 0.5 * (o.upper - o.lower) * entry(random);
    f.residual(t.u, t.r);
    if (t.r.allFinite()) all.push_back(std::move(t));
  }
  if (static_cast<int>(all.size()) < wanted) all.clear();
  return all;
}

// Candidates coordinate by coordinate: what the linear part at zero does not forbid.
class Search {
 public:
  Search(const Problem& f, const SymmetryOptions& o) : f_(f), o_(o), trials_(trials(f, o)), value_(f.size()) {
    const int n = f.size();
    for (const double p : {o.lower, 0.5 * (o.lower + o.upper), o.upper}) {
      Vector u = Vector::Zero(n + 1), r(n);
      u[n] = p;
      Matrix j(n, n + 1);
      f.linearise(u, r, j);
      if (r.allFinite() && j.allFinite()) at_zero_.push_back({r, j.leftCols(n)});
    }
    for (const auto& t : trials_) largest_ = std::max(largest_, t.r.lpNorm<Eigen::Infinity>());
    g_.to.assign(static_cast<std::size_t>(n), -1);
    g_.signs = Vector::Ones(n);
    used_.assign(static_cast<std::size_t>(n), false);
  }

  std::vector<SignedPermutation> run() {
    if (trials_.empty() || (at_zero_.empty() && f_.size() > most_unguided)) return {};
    extend(0);
    if (candidates_ > o_.most_candidates) found_.clear();
    return std::move(found_);
  }

 private:
  static constexpr int most_unguided = 5;  // 5! 2^5 candidates

  void extend(int i) {
    const int n = f_.size();
    if (i == n) {
      if (++candidates_ <= o_.most_candidates && !is_identity() && commutes()) found_.push_back(g_);
      return;
    }
    for (int k = 0; k < n && candidates_ <= o_.most_candidates; ++k) {
      if (used_[static_cast<std::size_t>(k)]) continue;
      used_[static_cast<std::size_t>(k)] = true;
      g_.to[static_cast<std::size_t>(i)] = k;
      for (const double sign : {1.0, -1.0}) {
        g_.signs[i] = sign;
        if (allowed(i)) extend(i + 1);
      }
      used_[static_cast<std::size_t>(k)] = false;
    }
  }

  // r[to i] = s_i r[i] and J[to i][to j] = s_i s_j J[i][j] at zero, for the last coordinate assigned and those before it.
  bool allowed(int i) const {
    const auto to = [this](int k) { return g_.to[static_cast<std::size_t>(k)]; };
    for (const auto& [r, j] : at_zero_) {
      const double limit = o_.tolerance * j.lpNorm<Eigen::Infinity>();
      if (std::abs(r[to(i)] - g_.signs[i] * r[i]) > o_.tolerance * r.lpNorm<Eigen::Infinity>()) return false;
      for (int k = 0; k <= i; ++k) {
        const double sign = g_.signs[i] * g_.signs[k];
        if (std::abs(j(to(i), to(k)) - sign * j(i, k)) > limit || std::abs(j(to(k), to(i)) - sign * j(k, i)) > limit) return false;
      }
    }
    return true;
  }

  bool is_identity() const {
    for (int i = 0; i < f_.size(); ++i)
      if (g_.to[static_cast<std::size_t>(i)] != i || g_.signs[i] < 0.0) return false;
    return true;
  }

  bool commutes() {
    return std::all_of(trials_.begin(), trials_.end(), [this](const Trial& t) {
      f_.residual(g_.apply(t.u), value_);
      return (value_ - g_.apply(t.r)).lpNorm<Eigen::Infinity>() <= o_.tolerance * largest_;
    });
  }

  const Problem& f_;
  const SymmetryOptions& o_;
  std::vector<Trial> trials_;
  std::vector<std::pair<Vector, Matrix>> at_zero_;
  double largest_ = 0.0;
  int candidates_ = 0;
  Vector value_;
  SignedPermutation g_;
  std::vector<bool> used_;
  std::vector<SignedPermutation> found_;
};

}  // namespace

Vector SignedPermutation::apply(In x) const {
  Vector image = x;
  for (std::size_t i = 0; i < to.size(); ++i) image[to[i]] = signs[static_cast<Eigen::Index>(i)] * x[static_cast<Eigen::Index>(i)];
  return image;
}

Branch image(const SignedPermutation& g, const Branch& branch) {
  Branch moved(branch.size(), branch.spectrum_size(), std::max(1, branch.points()));
  for (int i = 0; i < branch.points(); ++i) {
    const Eigen::VectorXcd eigenvalues = branch.eigenvalues(i);
    moved.append(g.apply(branch.u(i)), g.apply(branch.tangent(i)), branch.arclength(i), branch.residual(i), branch.step(i), branch.iterations(i),
                 branch.n_unstable(i), &eigenvalues);
  }
  moved.special = branch.special;
  for (auto& s : moved.special)
    for (Vector* v : {&s.u, &s.tangent, &s.null_vector, &s.null_vector_im})
      if (v->size() > 0) *v = g.apply(*v);
  moved.start_reason = branch.start_reason;
  moved.stop_reason = branch.stop_reason;
  moved.isola = branch.isola;
  moved.mirror_image = branch.mirror_image;
  return moved;
}

std::vector<SignedPermutation> symmetries(const Problem& f, const SymmetryOptions& options) {
  if (!f.is_flow() || f.parameters() != 1 || f.size() > options.most_coordinates) return {};
  return Search(f, options).run();
}

}  // namespace whirl::continuation
