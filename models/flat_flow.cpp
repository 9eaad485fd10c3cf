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
  slope_.assign(value_.size(), 0.0);
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

void FlatFlow::with_tangents(double t, const double* y, double* dydt, int tangents) const {
  evaluate(t, y, dydt);
  const double* value = value_.data();
  double* slope = slope_.data();  // of the cosines: zero
  for (int m = 1; m <= tangents; ++m) {
    const double* v = y + m * size();
    double* d = dydt + m * size();
    for (int i = 0; i < n_; ++i) slope[i] = v[i];
    double* next = slope + n_ + harmonics_;
    for (const Product& p : products_) *next++ = slope[p.first] * value[p.second] + value[p.first] * slope[p.second];
    for (int i = 0; i < n_; ++i) {
      const auto k = static_cast<std::size_t>(i);
      d[i] = v[n_ + i];
      d[n_ + i] = -damping_[k] * v[n_ + i] - stiffness_[k] * v[i];
    }
    for (const Sum& s : sums_) d[n_ + s.equation] -= s.coefficient * slope[s.node];
  }
}

}  // namespace whirl::models
