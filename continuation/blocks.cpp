#include "continuation/blocks.hpp"

#include <map>

namespace whirl::continuation {

Indices odd_coordinates(const Problem& f, int r) {
  Indices odd;
  const auto& signs = f.reflections()[static_cast<std::size_t>(r)].signs;
  for (int i = 0; i < f.size(); ++i)
    if (signs[i] < 0.0) odd.push_back(i);
  return odd;
}

std::vector<int> active_reflections(const Problem& f, In x, double tolerance) {
  const double limit = tolerance * x.lpNorm<Eigen::Infinity>();
  std::vector<int> active;
  for (int r = 0; r < static_cast<int>(f.reflections().size()); ++r) {
    bool fixed = true;
    for (int i : odd_coordinates(f, r)) fixed = fixed && std::abs(x[i]) <= limit;
    if (fixed) active.push_back(r);
  }
  return active;
}

Blocks make_blocks(const Problem& f, const std::vector<int>& active) {
  Blocks blocks;
  blocks.active = active;
  std::map<std::vector<bool>, Indices> by_signs;  // false (sign +) sorts first: block 0 is the first
  for (int i = 0; i < f.size(); ++i) {
    std::vector<bool> odd;
    for (int r : active) odd.push_back(f.reflections()[static_cast<std::size_t>(r)].signs[i] < 0.0);
    by_signs[odd].push_back(i);
  }
  const std::vector<bool> even(active.size(), false);
  if (!by_signs.contains(even)) by_signs[even] = {};
  for (const auto& [odd, indices] : by_signs) {
    blocks.indices.push_back(indices);
    std::string subtype;
    for (std::size_t k = 0; k < active.size() && subtype.empty(); ++k)
      if (odd[k]) subtype = f.reflections()[static_cast<std::size_t>(active[k])].subtype;
    blocks.subtype.push_back(subtype);
  }
  return blocks;
}

}  // namespace whirl::continuation
