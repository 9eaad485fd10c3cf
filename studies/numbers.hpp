#pragma once
/// Named numbers of a cable, a guy or a motion: one list for the result file, for JSON and for the screen.

#include "studies/json.hpp"
#include "studies/result_file.hpp"

namespace whirl::studies {

struct Number {
  std::string name, unit, description;
  double value;
};
using Numbers = std::vector<Number>;

/// A scalar each in `group`.
void write_numbers(ResultFile& file, const std::string& group, const Numbers& numbers);
/// {"length": 117.6, ...}
Json numbers_json(const Numbers& numbers);
/// A line each: name, value, unit, description.
std::string numbers_text(const Numbers& numbers);

}  // namespace whirl::studies
