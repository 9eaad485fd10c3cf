#include "studies/numbers.hpp"

#include <fmt/format.h>

namespace whirl::studies {

void write_numbers(ResultFile& file, const std::string& group, const Numbers& numbers) {
  for (const Number& n : numbers) file.scalar(group, n.name, n.value, n.unit, n.description);
}

Json numbers_json(const Numbers& numbers) {
  Json all = Json::object();
  for (const Number& n : numbers) all.put(n.name, n.value);
  return all;
}

std::string numbers_text(const Numbers& numbers) {
  std::string text;
  for (const Number& n : numbers) text += fmt::format("{:<28} {:>18.12g} {:<6} {}\n", n.name, n.value, n.unit, n.description);
  return text;
}

}  // namespace whirl::studies
