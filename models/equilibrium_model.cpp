#include "models/equilibrium_model.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace whirl::models {
namespace {

std::vector<std::string> inputs_of(const EquilibriumModel& m) {
  std::vector<std::string> names = m.variables;
  for (const auto& p : m.parameters) names.push_back(p.name);
  return names;
}

std::ptrdiff_t index_in(const std::vector<std::string>& names, std::string_view name) {
  const auto it = std::find(names.begin(), names.end(), name);
  return it == names.end() ? -1 : it - names.begin();
}

// Where the model starts: (initial, free parameters at their own values).
std::vector<double> start_of(const EquilibriumModel& m, const std::vector<std::string>& lenses) {
  std::vector<double> u = m.initial;
  for (const auto& name : lenses) u.push_back(m.parameter(name));
  return u;
}

/// f and the conserved c in one field: slopes of all of them along one variable.
std::vector<double> slopes(const VectorField& all, const std::vector<double>& u, std::size_t variable) {
  using D = Dual<double, 1>;
  std::vector<D> in(u.begin(), u.end()), out(static_cast<std::size_t>(all.equations()));
  in[variable].d[0] = 1.0;
  all.evaluate<D>(in, out);
  std::vector<double> slope;
  for (const D& y : out) slope.push_back(y.d[0]);
  return slope;
}

// Each c_k is drawn to its value as fast as the field itself moves at the start: |f_x| (largest row sum), by |grad c_k|^2.
VectorField hold_conserved(const EquilibriumModel& m, const VectorField& all, const std::vector<std::string>& lenses) {
  const std::size_t n = m.variables.size(), held = m.conserved.size();
  const std::vector<double> u = start_of(m, lenses);
  std::vector<double> now(n + held), squares(held, 0.0), row_sums(n, 0.0);
  all.evaluate<double>(u, now);
  for (std::size_t j = 0; j < n; ++j) {
    const auto slope = slopes(all, u, j);
    for (std::size_t i = 0; i < n; ++i) row_sums[i] += std::abs(slope[i]);
    for (std::size_t k = 0; k < held; ++k) squares[k] += slope[n + k] * slope[n + k];
  }
  const double fastest = *std::max_element(row_sums.begin(), row_sums.end()), speed = std::isfinite(fastest) && fastest > 0.0 ? fastest : 1.0;
  std::vector<double> rates;
  for (std::size_t k = 0; k < held; ++k) {
    if (!std::isfinite(now[n + k]) || !(squares[k] > 0.0) || !std::isfinite(squares[k]))
      throw std::invalid_argument(fmt::format("the conserved expression {} is not finite at initial, or no variable moves it there", k + 1));
    rates.push_back(speed / squares[k]);
  }
  return all.held(m.size(), {now.begin() + static_cast<std::ptrdiff_t>(n), now.end()}, rates);
}

// d/dt c = grad c . f = 0 to rounding, relative to its parts.
void check_conserved(const EquilibriumModel& m, const std::vector<std::string>& lenses) {
  constexpr int points = 20;
  constexpr double rounding = 1e-9;
  if (m.conserved.empty()) return;
  std::vector<std::string> texts = m.rhs;
  texts.insert(texts.end(), m.conserved.begin(), m.conserved.end());
  const VectorField all = bound(m, texts, lenses);
  const std::size_t n = m.variables.size();
  for (const Vector& point : sample_points(m, lenses, points)) {
    const std::vector<double> u(point.begin(), point.end());
    std::vector<double> f(texts.size()), sum(m.conserved.size(), 0.0), parts(m.conserved.size(), 0.0);
    all.evaluate<double>(u, f);
    for (std::size_t j = 0; j < n; ++j) {
      const auto slope = slopes(all, u, j);
      for (std::size_t k = 0; k < sum.size(); ++k) {
        sum[k] += slope[n + k] * f[j];
        parts[k] += std::abs(slope[n + k] * f[j]);
      }
    }
    for (std::size_t k = 0; k < sum.size(); ++k)
      if (std::isfinite(parts[k]) && std::abs(sum[k]) > rounding * parts[k])
        throw std::invalid_argument(fmt::format("the equations do not conserve expression {}: it changes with time", k + 1));
  }
}

}  // namespace

// Text in all names, then everything that is neither variable nor lens fixed at its number.
VectorField bound(const EquilibriumModel& m, const std::vector<std::string>& expressions, const std::vector<std::string>& lenses) {
  m.validate();
  if (lenses.size() > 3) throw std::invalid_argument("at most three free parameters");
  const int n = m.size();
  std::vector<VectorField::Source> sources;
  for (int i = 0; i < n; ++i) sources.emplace_back(i);
  for (const auto& p : m.parameters) sources.emplace_back(p.value);
  for (std::size_t k = 0; k < lenses.size(); ++k) {
    (void)m.parameter(lenses[k]);
    const auto at = static_cast<std::size_t>(n + index_in(m.parameter_names(), lenses[k]));
    if (std::holds_alternative<int>(sources[at])) throw std::invalid_argument(fmt::format("the parameter {} is free twice", lenses[k]));
    sources[at] = n + static_cast<int>(k);
  }
  return VectorField(expressions, inputs_of(m)).rebound(sources, n + static_cast<int>(lenses.size()));
}

namespace {

VectorField field_of(const EquilibriumModel& m, const std::vector<std::string>& lenses) {
  if (m.conserved.empty()) return bound(m, m.rhs, lenses);
  std::vector<std::string> texts = m.rhs;
  texts.insert(texts.end(), m.conserved.begin(), m.conserved.end());
  return hold_conserved(m, bound(m, texts, lenses), lenses);
}

}  // namespace

std::vector<std::string> EquilibriumModel::parameter_names() const {
  std::vector<std::string> names;
  for (const auto& p : parameters) names.push_back(p.name);
  return names;
}

double EquilibriumModel::parameter(std::string_view name) const {
  for (const auto& p : parameters)
    if (p.name == name) return p.value;
  throw std::invalid_argument(fmt::format("no parameter '{}'; the model has {}", name, fmt::join(parameter_names(), ", ")));
}

void EquilibriumModel::validate() const {
  if (variables.empty()) throw std::invalid_argument("at least one variable");
  if (rhs.size() != variables.size()) throw std::invalid_argument(fmt::format("{} equations for {} variables", rhs.size(), variables.size()));
  if (initial.size() != variables.size())
    throw std::invalid_argument(fmt::format("{} initial values for {} variables", initial.size(), variables.size()));
  for (const auto& a : amplitudes) {
    if (a.variables.empty()) throw std::invalid_argument(fmt::format("the amplitude {} has no variables", a.name));
    if (index_in(variables, a.name) >= 0) throw std::invalid_argument(fmt::format("an amplitude has the name of the variable {}", a.name));
    for (const auto& name : a.variables)
      if (index_in(variables, name) < 0)
        throw std::invalid_argument(
            fmt::format("an amplitude of '{}', which is no variable; the variables are {}", name, fmt::join(variables, ", ")));
  }
  for (const auto& name : angles)
    if (index_in(variables, name) < 0)
      throw std::invalid_argument(fmt::format("an angle '{}', which is no variable; the variables are {}", name, fmt::join(variables, ", ")));
  for (const auto& mirror : mirrors) {
    if (mirror.variables.empty()) throw std::invalid_argument("a reflection without variables");
    for (const auto& name : mirror.variables)
      if (index_in(variables, name) < 0)
        throw std::invalid_argument(
            fmt::format("a reflection of '{}', which is no variable; the variables are {}", name, fmt::join(variables, ", ")));
  }
}

EquilibriumField::EquilibriumField(const EquilibriumModel& model, const std::vector<std::string>& lenses)
    : model_(model), field_(field_of(model, lenses)) {}

EquilibriumFlow::EquilibriumFlow(const EquilibriumModel& m, const std::vector<std::string>& lenses)
    : DualProblem(EquilibriumField(m, lenses), m.size(), static_cast<int>(lenses.size()), true) {
  name_parameters(lenses);
  check_conserved(m, lenses);
  for (const auto& mirror : m.mirrors) {
    Vector signs = Vector::Ones(size());
    for (const auto& name : mirror.variables) signs[index_in(m.variables, name)] = -1.0;
    check_mirror(mirror, signs);
    add_reflection({signs, mirror.subtype});
  }
}

void EquilibriumFlow::check_mirror(const Mirror& mirror, const Vector& signs) const {
  constexpr int wanted = 20, tries = 2000;
  std::mt19937 random(1);  // the same points every time
  std::uniform_real_distribution<double> between(-1.0, 1.0);
  const int n = size(), width = n + parameters();
  Vector u(width), mirrored(width), r(n), s(n);
  int tested = 0;
  for (int i = 0; i < tries && tested < wanted; ++i) {
    for (int k = 0; k < n; ++k) {
      const double around = std::max(1.0, std::abs(model().model().initial[static_cast<std::size_t>(k)]));
      u[k] = around * between(random);
    }
    for (int k = n; k < width; ++k) {
      const double value = model().model().parameter(parameter_names()[static_cast<std::size_t>(k - n)]);
      u[k] = value + 0.5 * std::max(1.0, std::abs(value)) * between(random);
    }
    mirrored = u;
    mirrored.head(n).array() *= signs.array();
    residual(u, r);
    residual(mirrored, s);
    if (!r.allFinite() || !s.allFinite()) continue;  // outside the domain of a logarithm, say
    ++tested;
    // rounding in f of size 1 stays below 1e-14; a term that breaks the symmetry by less than 1e-9 of f counts as none
    if ((s - signs.cwiseProduct(r)).norm() > 1e-9 * (r.norm() + s.norm()))
      throw std::invalid_argument(fmt::format("changing the sign of {} changes the equations: no symmetry", fmt::join(mirror.variables, ", ")));
  }
  if (tested == 0)
    throw std::invalid_argument(fmt::format("the sign change of {} could not be tested: f is not finite", fmt::join(mirror.variables, ", ")));
}

std::vector<Vector> sample_points(const EquilibriumModel& m, const std::vector<std::string>& lenses, int count) {
  constexpr int tries_each = 50;
  constexpr double scales[] = {1.0, 3.0, 10.0};  // a field may be linear near the start
  std::mt19937 random(2);                        // the same points every time
  std::uniform_real_distribution<double> between(-1.0, 1.0);
  const VectorField f = bound(m, m.rhs, lenses);
  std::vector<Vector> all;
  for (int i = 0; i < count * tries_each && static_cast<int>(all.size()) < count; ++i) {
    std::vector<double> u, r(m.variables.size());
    for (const double x : m.initial) {
      const double part = between(random);
      u.push_back(scales[i / 2 % 3] * std::max(1.0, std::abs(x)) * (i % 2 == 0 ? part : std::abs(part)));
    }
    for (const auto& name : lenses) {
      const double value = m.parameter(name);
      u.push_back(value + 0.5 * std::max(1.0, std::abs(value)) * between(random));
    }
    f.evaluate<double>(u, r);
    if (std::all_of(r.begin(), r.end(), [](double x) { return std::isfinite(x); }))
      all.push_back(Eigen::Map<const Vector>(u.data(), static_cast<Eigen::Index>(u.size())));
  }
  return all;
}

}  // namespace whirl::models
