#include "studies/second_parameter.hpp"

#include <fmt/format.h>

namespace whirl::studies {

using continuation::EventType;

void add_second_keys(Schema& s, const SecondKeys& keys) {
  s.add({.name = "second.parameter", .description = keys.what, .default_value = keys.parameter});
  if (keys.required)
    s.add({.name = "second.range",
           .description = "its lower and upper end",
           .default_value = std::vector<double>{},
           .required = true,
           .min_items = 2,
           .max_items = 2,
           .example = Value{std::vector<double>{0.05, 0.8}}});
  else
    s.add({.name = "second.range",
           .description = "its lower and upper end; without it no chart",
           .default_value = std::vector<double>{},
           .optional = true,
           .max_items = 2});
  s.add({.name = "second.user_values",
         .description = "values of the second parameter at which points of every curve are listed (UZ)",
         .default_value = std::vector<double>{}});
  s.add({.name = "second.curves", .description = "which special points to follow", .default_value = keys.curves, .choices = keys.curves});
}

LensAccess lens_of(const EquilibriumSource& source) {
  return {[&source](const std::string& lens) { return source.value(lens); },
          [&source](const std::string& key, const std::string& lens, const std::string& range_key, double lower, double upper) {
            source.check_lens(key, lens, range_key, lower, upper);
          }};
}

SecondParameter read_second(const Configuration& c, const std::string& first, const continuation::WalkOptions& walk, const LensAccess& lens) {
  SecondParameter s;
  s.name = c.text("second.parameter");
  const auto& range = c.numbers("second.range");
  if (range.size() != 2 || !(range[0] < range[1])) throw c.error("second.range", "must hold two increasing values");
  if (s.name == first) throw c.error("second.parameter", "must differ from continuation.parameter");
  lens.check("second.parameter", s.name, "second.range", range[0], range[1]);
  s.value = lens.value(s.name);
  if (s.value < range[0] || s.value > range[1])
    throw c.error("second.range", fmt::format("must contain the value {:g} that {} has in this file", s.value, s.name));
  s.follow.walk = walk;
  s.follow.walk.user_values = c.numbers("second.user_values");
  for (const double x : s.follow.walk.user_values)
    if (x < range[0] || x > range[1]) throw c.error("second.user_values", fmt::format("must lie in second.range, got {:g}", x));
  s.follow.range1[0] = walk.lower;
  s.follow.range1[1] = walk.upper;
  s.follow.range2[0] = range[0];
  s.follow.range2[1] = range[1];
  for (const auto& name : c.texts("second.curves"))
    for (const EventType type :
         {EventType::fold, EventType::branch_point, EventType::hopf, EventType::peak, EventType::period_doubling, EventType::torus})
      if (name == to_string(type)) s.curves.push_back(type);
  return s;
}

}  // namespace whirl::studies
