#include "models/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "models/expression_steps.hpp"
#include "models/expression_text.hpp"
#include "models/expression_tree.hpp"

namespace whirl::models {

using Op = Step::Op;

ExpressionError::ExpressionError(int equation_number, const std::string& why)
    : std::invalid_argument(equation_number > 0 ? fmt::format("equation {}: {}", equation_number, why) : why),
      equation(equation_number),
      reason(why) {}

using detail::Node;

namespace {

// --------------------------------------------------------------------------------------------------------------- tree to steps

class Flattener {
 public:
  explicit Flattener(Writer& writer) : writer_(writer) {}

  Operand flatten(const Node& n) { return flatten(n, n.negative); }

 private:
  Operand flatten(const Node& n, bool negative) {
    switch (n.kind) {
      case Node::Kind::input:
        return signed_value(writer_.input(n.input), negative);
      case Node::Kind::number:
        return fixed(negative ? -n.number : n.number);
      case Node::Kind::sum:
        return sum(n, negative);
      case Node::Kind::product:
        return product(n, negative);
      case Node::Kind::power:
        return signed_value(writer_.raise(flatten(n.parts[0]), flatten(n.parts[1])), negative);
      case Node::Kind::call:
        return signed_value(
            n.parts.size() == 1 ? writer_.call(n.op, flatten(n.parts[0])) : writer_.choose(n.op, flatten(n.parts[0]), flatten(n.parts[1])), negative);
    }
    throw std::logic_error("no such node");
  }
  Operand signed_value(const Operand& x, bool negative) { return negative ? writer_.multiply(x, fixed(-1.0)) : x; }
  Operand sum(const Node& n, bool negative) {
    std::optional<Operand> plus, minus;
    for (const Node& part : n.parts) {
      auto& side = part.negative != negative ? minus : plus;
      const Operand x = flatten(part, false);
      side = side ? writer_.add(*side, x) : x;
    }
    if (!minus) return *plus;
    return writer_.subtract(plus ? *plus : fixed(0.0), *minus);
  }
  // Factors with a negative exponent divide. A sign goes to a number, else into a sum.
  Operand product(const Node& n, bool negative) {
    const auto takes = [&](Node::Kind kind) {
      return std::find_if(n.parts.begin(), n.parts.end(), [&](const Node& part) { return part.kind == kind; });
    };
    auto bearer = takes(Node::Kind::number);
    if (bearer == n.parts.end()) bearer = takes(Node::Kind::sum);
    Operand above = fixed(1.0), below = fixed(1.0), number = fixed(1.0);
    for (auto part = n.parts.begin(); part != n.parts.end(); ++part) {
      const bool inverse = part->kind == Node::Kind::power && part->parts[1].kind == Node::Kind::number && part->parts[1].negative;
      const Operand x = inverse ? writer_.raise(flatten(part->parts[0]), flatten(part->parts[1], false)) : flatten(*part, negative && part == bearer);
      if (x.known) number = inverse ? writer_.divide(number, x) : writer_.multiply(number, x);
      else if (inverse) below = writer_.multiply(below, x);
      else above = writer_.multiply(above, x);
    }
    if (negative && bearer == n.parts.end()) number = writer_.multiply(number, fixed(-1.0));
    return writer_.divide(writer_.multiply(above, number), below);
  }

  Writer& writer_;
};

}  // namespace

VectorField::VectorField(const std::vector<std::string>& equations, const std::vector<std::string>& inputs)
    : inputs_(static_cast<int>(inputs.size())) {
  detail::check_names(inputs);
  Writer writer(inputs_);
  for (std::size_t i = 0; i < equations.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    std::vector<double> numbers;
    const std::string tokens = detail::checked_text(equations[i], number, inputs, numbers);
    try {
      results_.push_back(writer.result(Flattener(writer).flatten(detail::tree_of(tokens, numbers))));
    } catch (const std::domain_error& e) {
      throw ExpressionError(number, e.what());
    } catch (const std::exception& e) {
      const std::string_view what(e.what());
      throw ExpressionError(number, fmt::format("is not understood: {}", what.substr(0, what.find('\n'))));
    }
  }
  steps_ = std::move(writer.steps);
}

}  // namespace whirl::models
