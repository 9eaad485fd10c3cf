#pragma once
/// The second parameter of a chart: its keys [second], read in one way for every kind that has charts.

#include <functional>

#include "continuation/two_parameter.hpp"
#include "studies/configuration.hpp"
#include "studies/equilibrium_source.hpp"

namespace whirl::studies {

struct SecondKeys {
  std::string what;                 ///< description of second.parameter
  std::string parameter;            ///< its default
  std::vector<std::string> curves;  ///< types that may be followed, all of them by default: "LP", "BP", ...
  bool required = false;            ///< second.range must be given
};
void add_second_keys(Schema& schema, const SecondKeys& keys);

struct SecondParameter {
  std::string name;
  double value = 0.0;  ///< in this file
  continuation::TwoParameterOptions follow;
  std::vector<continuation::EventType> curves;  ///< to keep
};

/// How a kind looks at a lens: its value in this file, and a check that throws InputError at the keys given if it cannot be moved over a range.
struct LensAccess {
  std::function<double(const std::string& lens)> value;
  std::function<void(const std::string& key, const std::string& lens, const std::string& range_key, double lower, double upper)> check;
};

LensAccess lens_of(const EquilibriumSource& source);  ///< which must outlive it

/// `first` and `walk`: parameter and options of the branches. second.range must be there. Throws InputError.
SecondParameter read_second(const Configuration& c, const std::string& first, const continuation::WalkOptions& walk, const LensAccess& lens);

}  // namespace whirl::studies
