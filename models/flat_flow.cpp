#include "models/flat_flow.hpp"

#include <algorithm>
#include <map>

namespace whirl::models {

FlatFlow::FlatFlow(const ModalSystem<double>& system)
    : n_(system.size()),
      harmonics_(system.max_harmonic),
      omega_(system.omega),
      damping_(system.damping),
      stiffness_(system.stiffness),
      constant_(system.stiffness.size(), 0.0) {
  const int first_product = n_ + harmonics_;
  std::map<std::pair<int, int>, int> known;
  const auto times = [&](int a, int b) {
    const auto key = std::minmax(a, b);
    const auto [at, fresh] = known.try_emplace(key, first_product + static_cast<int>(products_.size()));
    if (fresh) products_.push_back({key.first, key.second});
    return at->second;
  };
  const auto cosine = [&](int h) { return n_ + h - 1; };
  std::map<std::pair<int, int>, double> sums;
  for (const auto& term : system.terms) {
    std::vector<int> factors(term.factor.begin(), term.factor.begin() + term.degree);
    std::sort(factors.begin(), factors.end());
    if (term.cos_harmonic != 0) factors.push_back(cosine(term.cos_harmonic));
    if (factors.empty()) {
      constant_[static_cast<std::size_t>(term.equation)] -= term.coefficient;
      continue;
    }
    int node = factors.front();
    for (std::size_t i = 1; i < factors.size(); ++i) node = times(node, factors[i]);
    sums[{term.equation, node}] += term.coefficient;
  }
  for (const auto& force : system.forces) {
    if (force.harmonic == 0) constant_[static_cast<std::size_t>(force.equation)] += force.amplitude;
    else sums[{force.equation, cosine(force.harmonic)}] -= force.amplitude;
  }
  for (const auto& [key, coefficient] : sums) sums_.push_back({key.first, key.second, coefficient});
  value_.resize(static_cast<std::size_t>(first_product) + products_.size());
  slope_.assign(value_.size() * most_lanes, 0.0);
  sum_.assign(static_cast<std::size_t>(n_) * most_lanes, 0.0);
}

void FlatFlow::evaluate(double t, const double* y, double* dydt) const {
  double* value = value_.data();
  for (int i = 0; i < n_; ++i) value[i] = y[i];
  if (harmonics_ > 0) {
    double* c = value + n_;
    c[0] = std::cos(omega_ * t);
    if (harmonics_ > 1) c[1] = 2.0 * c[0] * c[0] - 1.0;
    for (int h = 2; h < harmonics_; ++h) c[h] = 2.0 * c[0] * c[h - 1] - c[h - 2];
  }
  double* next = value + n_ + harmonics_;
  for (const Product& p : products_) *next++ = value[p.first] * value[p.second];
  for (int i = 0; i < n_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    dydt[i] = y[n_ + i];
    dydt[n_ + i] = constant_[k] - damping_[k] * y[n_ + i] - stiffness_[k] * y[i];
  }
  for (const Sum& s : sums_) dydt[n_ + s.equation] -= s.coefficient * value[s.node];
}

void FlatFlow::operator()(double t, const double* y, double* dydt) const { evaluate(t, y, dydt); }

// Tangents in groups of `lanes`, side by side in every slope: one pass over the lists serves the whole group.
template <int lanes>
void FlatFlow::tangent_group(const double* y, double* dydt) const {
  const double* value = value_.data();
  double* slope = slope_.data();
  const int n = n_, size = 2 * n_;
  std::fill_n(slope + n * lanes, harmonics_ * lanes, 0.0);  // of the cosines
  for (int i = 0; i < n; ++i)
    for (int l = 0; l < lanes; ++l) slope[i * lanes + l] = y[l * size + i];
  double* next = slope + (n + harmonics_) * lanes;
  for (const Product& p : products_) {
    const double a = value[p.first], b = value[p.second], *s = slope + p.first * lanes, *t = slope + p.second * lanes;
    for (int l = 0; l < lanes; ++l) next[l] = s[l] * b + a * t[l];
    next += lanes;
  }
  double* force = sum_.data();
  std::fill_n(force, n * lanes, 0.0);
  for (const Sum& s : sums_) {
    const double* t = slope + s.node * lanes;
    double* f = force + s.equation * lanes;
    for (int l = 0; l < lanes; ++l) f[l] += s.coefficient * t[l];
  }
  for (int l = 0; l < lanes; ++l)
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double* v = y + l * size;
      dydt[l * size + i] = v[n + i];
      dydt[l * size + n + i] = -damping_[k] * v[n + i] - stiffness_[k] * v[i] - force[i * lanes + l];
    }
}

void FlatFlow::with_tangents(double t, const double* y, double* dydt, int tangents) const {
  evaluate(t, y, dydt);
  int m = 1;
  for (; m + most_lanes <= tangents + 1; m += most_lanes) tangent_group<most_lanes>(y + m * size(), dydt + m * size());
  for (; m + 2 <= tangents + 1; m += 2) tangent_group<2>(y + m * size(), dydt + m * size());
  for (; m <= tangents; ++m) tangent_group<1>(y + m * size(), dydt + m * size());
}

}  // namespace whirl::models
