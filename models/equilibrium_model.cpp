#include "models/equilibrium_model.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
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

// Text in all names, then everything that is neither variable nor lens fixed at its number.
VectorField field_of(const EquilibriumModel& m, const std::vector<std::string>& lenses) {
  m.validate();
  if (lenses.size() > 2) throw std::invalid_argument("at most two free parameters");
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
  return VectorField(m.rhs, inputs_of(m)).rebound(sources, n + static_cast<int>(lenses.size()));
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

}  // namespace whirl::models
