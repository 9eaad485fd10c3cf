#include "models/parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <stdexcept>

namespace whirl::models {
namespace {

// Short names beside the dotted keys.
const std::map<std::string_view, std::vector<std::string_view>> short_names = {
    {"support_amplitude", {"support_motion.amplitude"}},
    {"damping", {"damping.out_of_plane", "damping.in_plane"}},
    {"chord_length", {"cable.chord_length"}},
    {"axial_stiffness", {"cable.axial_stiffness"}},
    {"chord_tension", {"cable.chord_tension"}},
    {"mass_per_length", {"cable.mass_per_length"}},
    {"inclination_deg", {"cable.inclination_deg"}},
};

}  // namespace

std::vector<std::string> Lens::names() {
  std::vector<std::string> all;
  StayParameters<double> record{};
  fields(record, [&](const Field& f, double&) { all.emplace_back(f.name); });
  for (const auto& [name, keys] : short_names) all.emplace_back(name);
  return all;
}

Lens::Lens(std::string_view name) : name_(name) {
  const auto found = short_names.find(name);
  const std::vector<std::string_view> keys = found == short_names.end() ? std::vector<std::string_view>{name} : found->second;
  StayParameters<double> record{};
  int i = 0;
  fields(record, [&](const Field& f, double&) {
    for (const auto key : keys)
      if (key == f.name) {
        indices_.push_back(i);
        unit_ = f.unit;
        affects_cable_ = affects_cable_ || f.affects_cable;
        lower_ = f.lower;
        upper_ = f.upper;
      }
    ++i;
  });
  if (indices_.empty()) throw std::invalid_argument(fmt::format("no parameter '{}'; accepted: {}", name, fmt::join(names(), ", ")));
}

double Lens::get(const StayParameters<double>& record) const {
  double value = 0.0;
  int i = 0;
  fields(record, [&](const Field&, const double& entry) {
    if (i++ == indices_.front()) value = entry;
  });
  return value;
}

}  // namespace whirl::models
