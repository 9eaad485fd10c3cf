#include "studies/forced_system.hpp"

#include <fmt/format.h>

#include "studies/cable_model_keys.hpp"
#include "studies/common_keys.hpp"
#include "studies/modal_model_input.hpp"

namespace whirl::studies {

using namespace models;

ModalSystem<double> ForcedSystem::at(In p) const {
  ModalSystem<double> s;
  system.at(std::span<const double>(p.data(), static_cast<std::size_t>(p.size())), s);
  return s;
}

namespace {

ForcedSystem of_modal_model(const Configuration& c, const std::vector<std::string>& lenses) {
  const ModalModel model = modal_model_of(c);
  ForcedSystem s{modal_system_of(c, lenses), mirrors(model, lenses), {}, "-", {}};
  for (int i = 0; i < model.size(); ++i) s.coordinates.push_back(fmt::format("q{}", i + 1));
  for (const auto& lens : lenses) s.lens_units.push_back(model.lens_unit(lens));
  return s;
}

}  // namespace

void add_forced_system_keys(Schema& schema) {
  add_stay_keys(schema, true);
  add_model_keys(schema);
  schema.add_free(modal_model_section());
  schema.add_alternative({.sections = {"cable", "model", "damping", "support_motion"}, .free_sections = {"modal_model"}});
}

ForcedSystem forced_system_of(const Configuration& c, const std::vector<std::string>& lenses) {
  if (c.has("modal_model")) return of_modal_model(c, lenses);
  std::vector<Lens> chosen;
  std::vector<std::string> units;
  for (const auto& name : lenses) try {
      chosen.emplace_back(name);
      units.emplace_back(chosen.back().unit());
    } catch (const std::invalid_argument& e) {
      const std::string guess = nearest(name, Lens::names());
      throw InputError(fmt::format("{}: parameter '{}': {}", c.source(), name,
                                   guess.empty() ? e.what() : fmt::format("no such parameter, did you mean {}?", guess)));
    }
  const CableModel model = cable_model_of(c);
  const auto tension = [model, chosen](In p) -> ForcedSystem::Tension {
    CableModel here = model;
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i].set(here.stay, p[static_cast<Eigen::Index>(i)]);
    return CableTension(here);
  };
  if (is_plain_stay(c))
    return {stay_system(stay_of(c), chosen, terms_of(c), coefficients_of(c)), {{{-1, 1}, "WH"}}, {"q1", "q2"}, "m", units, tension};
  return {cable_system(model, chosen), cable_reflections(model), coordinate_names(c), "m", units, tension};
}

std::array<int, 2> leading_coordinates(const ForcedSystem& s) {
  const int n = static_cast<int>(s.coordinates.size());
  for (const auto& r : s.reflections) {
    const auto out = std::find(r.signs.begin(), r.signs.end(), -1), in = std::find(r.signs.begin(), r.signs.end(), 1);
    if (out != r.signs.end() && in != r.signs.end()) return {static_cast<int>(out - r.signs.begin()), static_cast<int>(in - r.signs.begin())};
  }
  return {0, std::min(1, n - 1)};
}

std::string mirrored_coordinates(const ForcedSystem& s) {
  std::string names;
  for (std::size_t i = 0; !s.reflections.empty() && i < s.coordinates.size(); ++i)
    if (s.reflections[0].signs[i] < 0) names += (names.empty() ? "" : ", ") + s.coordinates[i];
  return names;
}

Vector off_symmetry(const ForcedSystem& s, Vector y, double amount) {
  if (s.reflections.empty()) y[0] += amount;
  for (const auto& r : s.reflections)
    if (const auto odd = std::find(r.signs.begin(), r.signs.end(), -1); odd != r.signs.end()) y[odd - r.signs.begin()] += amount;
  return y;
}

void check_forced_lens(const Configuration& c, const std::string& key, const std::string& lens, const std::string& range_key, double lower,
                       double upper) {
  if (c.has("modal_model")) {
    check_modal_lens(c, modal_model_of(c), key, lens);
    if (lens == "omega" && !(lower > 0.0)) throw c.error(range_key, "must lie above 0 rad/s");
    return;
  }
  try {
    const Lens stay_lens(lens);
    const auto outside = [&](double x) { return !(x > stay_lens.lower() && x < stay_lens.upper()) && !(x == stay_lens.lower() && lens != "omega"); };
    if (outside(lower) || outside(upper))
      throw c.error(range_key,
                    fmt::format("must lie in ({:g}, {:g}) [{}], the range of {}", stay_lens.lower(), stay_lens.upper(), stay_lens.unit(), lens));
    if (!stay_lens.affects_cable()) return;
    for (const double p : {lower, upper}) {  // the model must hold over the whole range
      auto record = stay_of(c);
      stay_lens.set(record, p);
      (void)models::check(record.cable);
    }
  } catch (const std::invalid_argument& e) {
    const std::string guess = nearest(lens, Lens::names());
    const bool unknown = std::string_view(e.what()).starts_with("no parameter");
    throw c.error(key, unknown && !guess.empty() ? fmt::format("no such parameter, did you mean {}?", guess) : e.what());
  }
}

double forced_lens_value(const Configuration& c, const std::string& lens) {
  return c.has("modal_model") ? modal_model_of(c).lens_value(lens) : Lens(lens).get(stay_of(c));
}

std::vector<std::string> check_forced_system(const Configuration& c) {
  if (!c.has("modal_model")) {
    (void)cable_model_of(c);
    auto warnings = check_cable(c);
    if (is_multi_mode(c))
      std::erase_if(warnings, [](const auto& w) { return w.find("differ by more than 20 %") != std::string::npos; });  // of two modes
    return warnings;
  }
  (void)modal_model_of(c);
  return {};
}

void write_forced_system(ResultFile& file, RunContext& context, const Configuration& c) {
  if (!c.has("modal_model")) write_cable_numbers(file, context, stay_of(c).cable);
}

}  // namespace whirl::studies
