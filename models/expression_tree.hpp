#pragma once
/// Inside of VectorField: the tree of one equation, in an order of its own that repeats: sums and products are flat and sorted by their text, signs
/// are drawn out, equal terms and factors are counted (x + x is 2 x, x*x is x^2, x - x nothing). Last inputs come first: parameters fixed later meet
/// before a variable joins them.

#include <string>
#include <vector>

#include "models/expression.hpp"

namespace whirl::models::detail {

struct Node {
  enum class Kind { input, number, sum, product, power, call };
  Kind kind;
  bool negative = false;  ///< the value is minus what the rest says
  std::string key;
  int input = 0;
  double number = 0.0;   ///< >= 0
  bool counted = false;  ///< a number that no text holds: a count or an exponent of equal parts
  Step::Op op = Step::Op::constant;
  std::vector<Node> parts = {};  ///< power: base, exponent
  bool is_whole() const;
};

/// Of the tokens that `checked_text` writes; `numbers`: what c0, c1, ... stand for.
Node tree_of(const std::string& tokens, const std::vector<double>& numbers);

}  // namespace whirl::models::detail
