#pragma once
/// Inside of VectorField: what an equation may hold, checked token by token and written for GiNaC in names of our own: input 3 becomes v00003,
/// number 3 c3. So GiNaC never computes with the user's numbers, whose digits it would round to decimal places and whose powers it would expand
/// without limit, and no input is taken for one of its constants.

#include <string>
#include <string_view>
#include <vector>

#include "models/expression.hpp"

namespace whirl::models::detail {

struct Function {
  std::string_view name, in_ginac;
  Step::Op op;
  int arguments = 1;
};
const Function* function_in_ginac(std::string_view name);  ///< null if there is none

/// Throws ExpressionError; `numbers` takes what c0, c1, ... stand for.
std::string text_for_ginac(std::string_view text, int equation, const std::vector<std::string>& inputs, std::vector<double>& numbers);

/// Throws ExpressionError (of equation 0) for an input whose name is none, or is given twice.
void check_names(const std::vector<std::string>& inputs);

}  // namespace whirl::models::detail
