#include "studies/equilibrium_model_input.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "models/equilibrium_symmetry.hpp"
#include "studies/branch_output.hpp"
#include "studies/section_reader.hpp"

namespace whirl::studies {

using models::EquilibriumModel;

FreeSection equilibrium_model_section(bool required) {
  return {.name = "equilibrium_model",
          .description = "rest points of x' = f(x, p), f as expressions",
          .example = R"toml([equilibrium_model]
variables = ["x", "y", "z"]
parameters = { sigma = 10.0, rho = 0.5, beta = 2.6666666666666667 }
rhs = ["sigma*(y - x)", "x*(rho - z) - y", "x*y - beta*z"]
initial = [0.0, 0.0, 0.0]         # near a rest point at the lower end of continuation.range
mirrors = [["x", "y"]]            # optional: variables that change sign together without changing the equations
amplitudes = { R = ["x", "y"] }   # optional: roots of sums of squares, as further columns
mirror_subtype = "PF"             # name of branch points that break such a symmetry
# conserved = ["x + y"]           # optional: expressions that the equations conserve, held at their values at initial; sums are found by themselves
# phase = "x"                     # optional: a variable that a translation or rotation of all leaves free, held at its value in initial
# angles = ["x"]                  # optional: variables whose values 2 pi apart are one)toml",
          .required = required};
}

EquilibriumModel equilibrium_model_of(const Configuration& c) {
  const SectionReader m(c, "equilibrium_model");
  EquilibriumModel model;
  model.variables = m.texts("variables");
  for (const auto& [name, value] : m.named_numbers("parameters")) model.parameters.push_back({name, value});
  model.rhs = m.texts("rhs");
  model.initial = m.numbers("initial");
  const std::string subtype = m.text("mirror_subtype", "PF");
  if (m.has("mirrors"))
    for (auto& names : m.text_rows("mirrors")) model.mirrors.push_back({std::move(names), subtype});
  if (m.has("amplitudes"))
    for (auto& [name, variables] : m.named_texts("amplitudes")) model.amplitudes.push_back({name, std::move(variables)});
  if (m.has("conserved")) model.conserved = m.texts("conserved");
  if (m.has("angles")) model.angles = m.texts("angles");
  (void)m.has("phase");  // read with the model to be continued, see isolated_model_of
  m.no_others();
  const std::size_t n = model.variables.size();
  if (n == 0) throw m.error("variables", "must be an array of at least 1 name");
  if (model.rhs.size() != n) throw m.error("rhs", fmt::format("must be an array of {} expressions, one for each variable", n));
  if (model.initial.size() != n) throw m.error("initial", fmt::format("must be an array of {} numbers, one for each variable", n));
  if (model.mirrors.size() > 3) throw m.error("mirrors", "must be at most 3");
  const auto check_name = [&](const std::string& key, const std::string& name) {
    if (is_own_column(name)) throw m.error(key, fmt::format("'{}' is a column of the results: choose another name", name));
  };
  const auto names = model.parameter_names();
  for (const auto& name : model.variables) check_name("variables", name);
  for (const auto& name : names) check_name("parameters", name);
  for (const auto& a : model.amplitudes) {
    check_name("amplitudes", a.name);
    if (std::find(names.begin(), names.end(), a.name) != names.end())
      throw m.error("amplitudes", fmt::format("'{}' is a parameter: choose another name", a.name));
  }
  try {
    model.validate();
  } catch (const std::invalid_argument& e) {
    const std::string_view what = e.what();
    const char* key = what.starts_with("an angle")           ? "angles"
                      : what.find("amplitude") != what.npos  ? "amplitudes"
                      : what.find("reflection") != what.npos ? "mirrors"
                                                             : "variables";
    throw m.error(key, e.what());
  }
  try {
    const models::VectorField tried = models::bound(model, model.rhs, {});
    if (const std::string why = tried.not_finite(model.initial); !why.empty())
      throw m.error("initial", fmt::format("must be a point where every expression of rhs is finite: {}", why));
  } catch (const models::ExpressionError& e) {
    const bool of_parameter =
        std::any_of(names.begin(), names.end(), [&](const std::string& p) { return e.reason.find("'" + p + "'") != e.reason.npos; });
    if (e.equation == 0) throw m.error(of_parameter ? "parameters" : "variables", e.reason);
    throw m.error("rhs", fmt::format("expression {}: {}", e.equation, e.reason));
  } catch (const std::invalid_argument& e) {
    throw m.error("parameters", e.what());
  }
  if (!model.mirrors.empty()) try {
      EquilibriumModel mirrored = model;
      mirrored.conserved.clear();
      (void)models::EquilibriumFlow(mirrored, {});
    } catch (const std::invalid_argument& e) {
      throw m.error("mirrors", e.what());
    }
  if (!model.conserved.empty()) try {
      (void)models::bound(model, model.conserved, {});
    } catch (const models::ExpressionError& e) {
      throw m.error("conserved", fmt::format("expression {}: {}", e.equation, e.reason));
    } catch (const std::invalid_argument& e) {
      throw m.error("conserved", e.what());
    }
  return model;
}

namespace {

// Angles that no key names, and names that are no angles.
void note_turns(const SectionReader& m, const EquilibriumModel& model, const std::vector<std::string>& free, std::vector<std::string>& notes) {
  const auto turns = models::turns(model, free);
  for (const auto& name : model.angles) {
    const auto i = std::find(model.variables.begin(), model.variables.end(), name) - model.variables.begin();
    const bool turning = std::any_of(turns.begin(), turns.end(), [&](const models::Turn& t) { return std::abs(t.k[i]) == 1.0; });
    if (!turning && !models::sample_points(model, free, 1).empty())
      throw m.error("angles", fmt::format("the equations do not repeat when {} goes on by 2 pi, whatever goes on with it", name));
  }
  if (turns.empty() || !model.angles.empty()) return;
  std::vector<std::string> all, first;
  for (const auto& t : turns) {
    all.push_back(models::describe(t, model.variables));
    for (int i = 0; i < model.size(); ++i)
      if (std::abs(t.k[i]) == 1.0) {
        first.push_back(fmt::format("\"{}\"", model.variables[static_cast<std::size_t>(i)]));
        break;
      }
  }
  notes.push_back(fmt::format("the equations repeat every 2 pi in {}: equilibrium_model.angles = [{}] takes each solution once", fmt::join(all, ", "),
                              fmt::join(first, ", ")));
}

}  // namespace

EquilibriumModel isolated_model_of(const Configuration& c, const std::vector<std::string>& lenses, std::vector<std::string>& notes) {
  const SectionReader m(c, "equilibrium_model");
  EquilibriumModel model = equilibrium_model_of(c);
  const auto known = model.parameter_names();
  std::vector<std::string> free;  // names that are none are refused elsewhere
  for (const auto& lens : lenses)
    if (std::find(known.begin(), known.end(), lens) != known.end() && std::find(free.begin(), free.end(), lens) == free.end()) free.push_back(lens);
  if (m.has("phase")) try {
      for (const auto& name : m.text_or_texts("phase")) model = models::pinned(model, name, free);
    } catch (const std::invalid_argument& e) {
      throw m.error("phase", e.what());
    }
  try {
    (void)models::EquilibriumFlow(model, free);
  } catch (const std::invalid_argument& e) {
    throw m.error(std::string_view(e.what()).find("conserve") != std::string_view::npos ? "conserved"
                  : m.has("phase")                                                      ? "phase"
                                                                                        : "mirrors",
                  e.what());
  }
  for (const auto& sum : models::linear_invariants(model, free)) {
    // A sum of angles is none of the torus: its value changes with every turn. What it conserves is for `phase`.
    const auto in_sum = [&](const std::string& angle) { return (" " + sum + " ").find(" " + angle + " ") != std::string::npos; };
    if (std::any_of(model.angles.begin(), model.angles.end(), in_sum)) continue;
    EquilibriumModel with = model;
    with.conserved.push_back(sum);
    double value = 0.0;
    models::bound(with, {sum}, {}).evaluate<double>(with.initial, std::span<double>(&value, 1));
    try {
      (void)models::EquilibriumFlow(with, free);
    } catch (const std::invalid_argument&) {  // a mirror that the total does not have, say
      notes.push_back(fmt::format("the equations conserve {}: no rest point is isolated; remove mirrors that change its value, {:g}", sum, value));
      continue;
    }
    model = std::move(with);
    notes.push_back(
        fmt::format("the equations conserve {0}, so that no rest point is isolated: {0} keeps the value {1:g} that it has at initial", sum, value));
  }
  note_turns(m, model, free, notes);
  return model;
}

void check_equilibrium_lens(const Configuration& c, const EquilibriumModel& model, const std::string& key, const std::string& lens) {
  const auto names = model.parameter_names();
  if (std::find(names.begin(), names.end(), lens) != names.end()) return;
  const std::string guess = nearest(lens, names);
  throw c.error(key, guess.empty() ? fmt::format("no such parameter; the model has {}", fmt::join(names, ", "))
                                   : fmt::format("no such parameter, did you mean {}?", guess));
}

}  // namespace whirl::studies
