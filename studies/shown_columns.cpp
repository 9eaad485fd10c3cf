#include "studies/shown_columns.hpp"

#include <algorithm>
#include <iterator>

namespace whirl::studies {

std::vector<std::size_t> shown_columns(const std::vector<PointColumn>& columns) {
  constexpr std::size_t most = 5;
  const bool chosen = std::any_of(columns.begin(), columns.end(), [](const auto& c) { return c.shown; });
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < columns.size() && shown.size() < most; ++i) {
    const PointColumn& c = columns[i];
    if (c.shown || (!chosen && c.unit != "rad" && c.name.starts_with("q"))) shown.push_back(i);
  }
  return shown;
}

void append_unshown(std::vector<PointColumn>& columns, std::vector<PointColumn> further) {
  for (const std::size_t i : shown_columns(columns)) columns[i].shown = true;
  std::move(further.begin(), further.end(), std::back_inserter(columns));
}

}  // namespace whirl::studies
