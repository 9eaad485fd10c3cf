#include "studies/forced_system.hpp"

#include <fmt/format.h>

#include "studies/cable_model_keys.hpp"
#include "studies/common_keys.hpp"

namespace whirl::studies {

using namespace models;

ModalSystem<double> ForcedSystem::at(In p) const {
  ModalSystem<double> s;
  system.at(std::span<const double>(p.data(), static_cast<std::size_t>(p.size())), s);
  return s;
}

void add_forced_system_keys(Schema& schema) {
  add_stay_keys(schema, true);
  add_model_keys(schema);
}

ForcedSystem forced_system_of(const Configuration& c, const std::vector<std::string>& lenses) {
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
  if (is_plain_stay(c)) return {stay_system(stay_of(c), chosen, terms_of(c), coefficients_of(c)), {{{-1, 1}, "WH"}}, {"q1", "q2"}, "m", units};
  const CableModel model = cable_model_of(c);
  return {cable_system(model, chosen), cable_reflections(model), coordinate_names(c), "m", units};
}

std::vector<std::string> check_forced_system(const Configuration& c) {
  (void)cable_model_of(c);
  return check_cable(c);
}

void write_forced_system(ResultFile& file, const Configuration& c) { write_cable_numbers(file, stay_of(c).cable); }

}  // namespace whirl::studies
