#pragma once
/// Systems written as text, walked at default options: what a study file of kind `continuation` does, without the program.

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "continuation/network.hpp"
#include "models/equilibrium_model.hpp"

namespace whirl::continuation::text_model {

using models::EquilibriumFlow;
using models::EquilibriumModel;

struct System {
  std::vector<std::string> variables, rhs;
  std::map<std::string, double> parameters;
  std::vector<std::vector<std::string>> mirrors = {};

  EquilibriumFlow flow(const std::vector<std::string>& lenses) const {
    EquilibriumModel m;
    m.variables = variables;
    m.rhs = rhs;
    m.initial.assign(variables.size(), 0.1);
    for (const auto& [name, value] : parameters) m.parameters.push_back({name, value});
    for (const auto& names : mirrors) m.mirrors.push_back({names, "PF"});
    return EquilibriumFlow(m, lenses);
  }
};

/// All branches from the given starts (x, p) in one parameter.
inline std::vector<Branch> branches(const System& system, const std::string& lens, double lower, double upper,
                                    const std::vector<std::vector<double>>& starts, int max_points = 4000) {
  const EquilibriumFlow f = system.flow({lens});
  NetworkOptions o;
  o.walk.lower = lower;
  o.walk.upper = upper;
  o.walk.max_points = max_points;
  Network net(f, o);
  for (const auto& start : starts) {
    (void)net.add_seed(Eigen::Map<const Vector>(start.data(), static_cast<Eigen::Index>(start.size())), "start");
    net.switch_branches();
  }
  return net.branches();
}

inline std::vector<SpecialPoint> of_type(const std::vector<Branch>& all, EventType type) {
  std::vector<SpecialPoint> found;
  for (const auto& b : all)
    for (const auto& s : b.special)
      if (s.type == type) found.push_back(s);
  return found;
}

/// Parameter values of the points of a type, in increasing order.
inline std::vector<double> values(const std::vector<Branch>& all, EventType type) {
  std::vector<double> found;
  for (const auto& s : of_type(all, type)) found.push_back(s.u[s.u.size() - 1]);
  std::sort(found.begin(), found.end());
  return found;
}

/// No walk gave up and nothing is unexplained.
inline bool sound(const std::vector<Branch>& all) {
  return of_type(all, EventType::unresolved).empty() && std::none_of(all.begin(), all.end(), [](const Branch& b) {
           const auto early = [](StopReason r) { return r == StopReason::min_step || r == StopReason::max_points; };
           return early(b.start_reason) || early(b.stop_reason);
         });
}

}  // namespace whirl::continuation::text_model
