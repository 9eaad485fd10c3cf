#pragma once
/// Inside of VectorField: what an equation may hold, checked token by token and written in names of our own, a space behind each token: input 3
/// becomes v00003, number 3 c3. expression_tree.hpp reads it.

#include <string>
#include <string_view>
#include <vector>

#include "models/expression.hpp"

namespace whirl::models::detail {

struct Function {
  std::string_view name;
  Step::Op op;
  int arguments = 1;
};
const Function* function_named(std::string_view name);  ///< null if there is none

/// Throws ExpressionError; `numbers` takes what c0, c1, ... stand for.
std::string checked_text(std::string_view text, int equation, const std::vector<std::string>& inputs, std::vector<double>& numbers);

/// Throws ExpressionError (of equation 0) for an input whose name is none, or is given twice.
void check_names(const std::vector<std::string>& inputs);

}  // namespace whirl::models::detail
