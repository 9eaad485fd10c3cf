#pragma once
/// Symmetry blocks of the Jacobian.
///
/// Reflections that leave a state in place split r_x into blocks of coordinates with the same signs under all of them. Block 0
/// (all signs +) holds the motion itself and its folds; a singular block k > 0 is where a symmetry breaks. Without reflections
/// there is one block, everything.

#include <vector>

#include "core/problem.hpp"

namespace whirl::continuation {

using Indices = std::vector<int>;

struct Blocks {
  std::vector<int> active;           ///< reflections of the problem in force
  std::vector<Indices> indices;      ///< coordinates of each block; block 0 first, possibly the only one
  std::vector<std::string> subtype;  ///< of a branch point in each block; "" for block 0
};

/// The reflections that map x onto itself, exactly up to `tolerance` relative to |x|.
std::vector<int> active_reflections(const Problem& f, In x, double tolerance = 0.0);
Blocks make_blocks(const Problem& f, const std::vector<int>& active);

/// Coordinates on which reflection `r` changes sign.
Indices odd_coordinates(const Problem& f, int r);

}  // namespace whirl::continuation
