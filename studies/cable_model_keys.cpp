#include "studies/cable_model_keys.hpp"

#include <cmath>
#include <map>

#include "studies/common_keys.hpp"

namespace whirl::studies {

using namespace models;

namespace {

Key count_key(const char* name, const char* description) {
  return {.name = name,
          .description = description,
          .default_value = std::int64_t{3},
          .lower = 0,
          .upper = 40,
          .closed_lower = true,
          .closed_upper = true};
}

Key list_key(const char* name, const char* description) {
  return {.name = name,
          .description = description,
          .default_value = std::vector<double>{},
          .lower = 1,
          .upper = 400,
          .closed_lower = true,
          .closed_upper = true,
          .max_items = 40};
}

std::vector<int> half_waves(const Configuration& c, const std::string& list, const std::string& count) {
  std::vector<int> waves;
  for (const double k : c.numbers(list)) {
    if (k != std::floor(k)) throw c.error(list, "must hold whole numbers of half waves");
    waves.push_back(static_cast<int>(k));
  }
  return waves.empty() ? lowest_half_waves(static_cast<int>(c.integer(count))) : waves;
}

}  // namespace

void add_model_keys(Schema& s) {
  s.add({.name = "model.kind",
         .description = "one mode out of plane and one in plane, or any number of each",
         .default_value = std::string("two-mode"),
         .choices = {"two-mode", "multi-mode"}});
  s.add(count_key("model.out_of_plane_modes", "multi-mode: how many out-of-plane modes, from the lowest"));
  s.add(count_key("model.in_plane_modes", "multi-mode: how many in-plane modes, symmetric and antisymmetric, from the lowest"));
  s.add(list_key("model.out_of_plane", "multi-mode: chosen out-of-plane modes by their number of half waves, in place of the count"));
  s.add(list_key("model.in_plane", "multi-mode: chosen in-plane modes by half waves (odd: symmetric, even: antisymmetric), in place of the count"));
  s.add({.name = "model.longitudinal",
         .description = "tension uneven along the chord (transverse modes alone), or evened out at once (quasi-static longitudinal motion)",
         .default_value = std::string("galerkin"),
         .choices = {"galerkin", "quasi-static"}});
  s.add({.name = "model.shapes",
         .description = "mode shapes: those of the linear theory, or the taut string's sines",
         .default_value = std::string("linear-modes"),
         .choices = {"linear-modes", "sines"}});
}

bool is_multi_mode(const Configuration& c) { return c.text("model.kind") == "multi-mode"; }

bool is_plain_stay(const Configuration& c) {
  return !is_multi_mode(c) && c.text("model.longitudinal") == "galerkin" && c.text("model.shapes") == "linear-modes" &&
         c.text("support_motion.end") == "upper" && c.text("support_motion.direction") == "horizontal";
}

CableModel cable_model_of(const Configuration& c) {
  static const std::map<std::string, Direction> directions = {{"horizontal", Direction::horizontal},
                                                              {"vertical", Direction::vertical},
                                                              {"chord", Direction::chord},
                                                              {"normal", Direction::normal},
                                                              {"out-of-plane", Direction::out_of_plane}};
  if (coefficients_of(c) != Coefficients::exact && !is_plain_stay(c))
    throw c.error("cable.coefficients", "the printed coefficients are those of the two-mode stay, upper end moved horizontally: use \"exact\"");
  CableModel m{.stay = stay_of(c)};
  if (is_multi_mode(c)) {
    m.out_of_plane = half_waves(c, "model.out_of_plane", "model.out_of_plane_modes");
    m.in_plane = half_waves(c, "model.in_plane", "model.in_plane_modes");
  }
  m.longitudinal = c.text("model.longitudinal") == "galerkin" ? Longitudinal::galerkin : Longitudinal::quasi_static;
  m.shapes = c.text("model.shapes") == "sines" ? Shapes::sines : Shapes::linear_modes;
  m.terms = terms_of(c);
  m.end = c.text("support_motion.end") == "upper" ? End::upper : End::lower;
  m.direction = directions.at(c.text("support_motion.direction"));
  (void)check_cable(c);
  try {
    m.validate();
  } catch (const std::invalid_argument& e) {
    throw c.error("model.kind", e.what());
  }
  return m;
}

std::vector<std::string> coordinate_names(const Configuration& c) {
  return is_multi_mode(c) ? cable_model_of(c).coordinates() : std::vector<std::string>{"q1", "q2"};
}

}  // namespace whirl::studies
