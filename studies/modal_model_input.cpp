#include "studies/modal_model_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "studies/section_reader.hpp"

namespace whirl::studies {

using models::ModalModel;

namespace {

constexpr std::int64_t most_coordinates = 50, most_harmonics = 1000;

std::vector<double> one_each(const SectionReader& m, const std::string& key, int n, bool positive) {
  const auto values = m.numbers(key);
  if (static_cast<int>(values.size()) != n) throw m.error(key, fmt::format("must be an array of {} numbers, one for each coordinate", n));
  for (const double x : values)
    if (positive && !(x > 0.0)) throw m.error(key, "each value must be > 0 [rad/s]");
  return values;
}

void read_linear_part(const SectionReader& m, ModalModel& model) {
  if (m.has("frequency") == m.has("stiffness"))
    throw m.error("needs either frequency, an array of numbers > 0 [rad/s], or stiffness, rows of numbers [1/s^2]");
  if (m.has("frequency")) {
    model.frequency = m.numbers("frequency");
    (void)one_each(m, "frequency", static_cast<int>(model.frequency.size()), true);
  } else {
    model.stiffness = m.rows("stiffness");
    for (const auto& row : model.stiffness)
      if (row.size() != model.stiffness.size()) throw m.error("stiffness", "must be square: as many rows as numbers in each row");
  }
  const int n = model.size();
  if (n < 1 || n > most_coordinates)
    throw m.error(m.has("frequency") ? "frequency" : "stiffness", fmt::format("must have 1 to {} coordinates", most_coordinates));
  if (m.has("damping") && m.has("damping_ratio")) throw m.error("damping_ratio", "is not taken beside damping");
  if (m.has("damping")) model.damping = one_each(m, "damping", n, false);
  if (m.has("damping_ratio")) {
    if (model.frequency.empty()) throw m.error("damping_ratio", "needs frequency; give damping [1/s] beside stiffness");
    model.damping_ratio = one_each(m, "damping_ratio", n, false);
  }
}

ModalModel::Term term_of(const SectionReader& t, int n) {
  constexpr int most = models::Term<double>::max_degree;
  ModalModel::Term term{static_cast<int>(t.integer("equation", 1, n)) - 1, t.number("coefficient"), t.integers("powers")};
  if (static_cast<int>(term.powers.size()) != n) throw t.error("powers", fmt::format("must be an array of {} integers, one for each coordinate", n));
  for (const int k : term.powers)
    if (k < 0 || k > most) throw t.error("powers", fmt::format("each value must be in 0..{}", most));
  if (std::accumulate(term.powers.begin(), term.powers.end(), 0) > most) throw t.error("powers", fmt::format("must sum to at most {}", most));
  term.cos_harmonic = static_cast<int>(t.integer("cos_harmonic", 0, most_harmonics, 0));
  term.name = t.text("name", "");
  t.no_others();
  return term;
}

// A key that is the name of terms and forces is their number: what `--set modal_model.NAME=...` writes.
void read_named_numbers(const SectionReader& m, ModalModel& model) {
  for (const std::string& key : m.others()) {
    std::vector<double*> named;
    for (auto& t : model.terms)
      if (t.name == key) named.push_back(&t.coefficient);
    for (auto& f : model.forces)
      if (f.name == key) named.push_back(&f.amplitude);
    if (named.empty()) continue;
    const double value = m.number(key);
    if (!std::all_of(named.begin(), named.end(), [&](const double* x) { return *x == *named.front(); }))
      throw m.error(key, "stands for numbers that differ: set them one by one, such as term[1].coefficient");
    for (double* x : named) *x = value;
  }
}

ModalModel::Force force_of(const SectionReader& f, int n) {
  ModalModel::Force force{static_cast<int>(f.integer("equation", 1, n)) - 1, f.number("amplitude")};
  force.harmonic = static_cast<int>(f.integer("harmonic", 0, most_harmonics, 1));
  force.name = f.text("name", "");
  f.no_others();
  return force;
}

}  // namespace

FreeSection modal_model_section(bool required) {
  return {.name = "modal_model",
          .description = "a forced modal system: q_i'' + damping_i q_i' + frequency_i^2 q_i + terms = forces",
          .example = R"([modal_model]
frequency = [1.0, 2.0]            # rad/s; or stiffness = [[1.0, 0.0], [0.0, 4.0]] in 1/s^2
damping = [0.005, 0.01]           # coefficient c of c q'; or damping_ratio = [...]
mirror_subtype = "PF"             # name of branch points that break a sign symmetry, which are found by themselves
[[modal_model.term]]              # left-hand side: + coefficient * q1^powers[0] * q2^powers[1] ...
equation = 1
coefficient = 1.0
powers = [1, 1]
cos_harmonic = 0                  # k > 0 multiplies by cos(k omega t)
name = "beta"                     # optional: a parameter that moves every term and force of this name; --set modal_model.beta=2.0 sets it
[[modal_model.force]]             # right-hand side: amplitude * cos(harmonic * omega t)
equation = 1
amplitude = 0.01
harmonic = 1)",
          .required = required};
}

ModalModel modal_model_of(const Configuration& c) {
  const SectionReader m(c, "modal_model");
  ModalModel model;
  read_linear_part(m, model);
  for (const auto& t : m.tables("term")) model.terms.push_back(term_of(t, model.size()));
  for (const auto& f : m.tables("force")) model.forces.push_back(force_of(f, model.size()));
  model.mirror_subtype = m.text("mirror_subtype", "PF");
  read_named_numbers(m, model);
  m.no_others();
  if (c.schema().find("omega") && c.has("omega")) model.omega = c.number("omega");
  try {
    model.validate();
  } catch (const std::invalid_argument& e) {
    throw m.error(e.what());
  }
  return model;
}

void check_modal_lens(const Configuration& c, const ModalModel& model, const std::string& key, const std::string& lens) {
  try {
    (void)model.lens_value(lens);
  } catch (const std::invalid_argument& e) {
    const std::string prefix = "modal_model.", guess = nearest(lens.starts_with(prefix) ? lens.substr(prefix.size()) : lens, model.lens_names());
    const bool unknown = std::string_view(e.what()).starts_with("no parameter");
    throw c.error(key, unknown && !guess.empty() ? fmt::format("no such parameter, did you mean {}?", guess) : e.what());
  }
}

models::ParametricSystem modal_system_of(const Configuration& c, const std::vector<std::string>& lenses) {
  const ModalModel model = modal_model_of(c);
  try {
    return models::modal_system(model, lenses);
  } catch (const std::invalid_argument& e) {
    throw InputError(fmt::format("{}: modal_model: {}", c.place("modal_model"), e.what()));
  }
}

}  // namespace whirl::studies
