#include "models/expression.hpp"

#include <fmt/format.h>
#include <ginac/ginac.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "models/expression_steps.hpp"
#include "models/expression_text.hpp"

namespace whirl::models {

using Op = Step::Op;

ExpressionError::ExpressionError(int equation_number, const std::string& why)
    : std::invalid_argument(equation_number > 0 ? fmt::format("equation {}: {}", equation_number, why) : why),
      equation(equation_number),
      reason(why) {}

using detail::Function, detail::function_in_ginac;

namespace {

// Functions of two values and jumps that GiNaC leaves as they stand.
DECLARE_FUNCTION_2P(maximum)
DECLARE_FUNCTION_2P(minimum)
DECLARE_FUNCTION_1P(signum)
REGISTER_FUNCTION(maximum, dummy())
REGISTER_FUNCTION(minimum, dummy())
REGISTER_FUNCTION(signum, dummy())

// --------------------------------------------------------------------------------------------------------------- tree to steps

/// GiNaC orders sums and products by addresses in memory, another order in every run, and with it chooses between a - b and -(b - a). Here they are
/// sorted by their text and signs are drawn out, so that results repeat to the last digit. Last inputs come first: parameters fixed later meet
/// before a variable joins them.
struct Node {
  enum class Kind { input, number, sum, product, power, call };
  Kind kind;
  bool negative = false;  ///< the value is minus what the rest says
  std::string key;
  int input = 0;
  double number = 0.0;  ///< >= 0
  Op op = Op::constant;
  std::vector<Node> parts = {};  ///< power: base, exponent
  bool is_whole() const { return kind == Kind::number && number == std::floor(number); }
};

class Reader {
 public:
  explicit Reader(const std::vector<double>& numbers) : numbers_(numbers) {}

  Node read(const GiNaC::ex& e) const {
    if (GiNaC::is_a<GiNaC::symbol>(e)) {
      const std::string name = GiNaC::ex_to<GiNaC::symbol>(e).get_name();
      const int index = std::stoi(name.substr(1));
      if (name[0] == 'v') return {.kind = Node::Kind::input, .key = name, .input = index};
      return {.kind = Node::Kind::number, .key = name, .number = numbers_[static_cast<std::size_t>(index)]};
    }
    if (GiNaC::is_a<GiNaC::numeric>(e) && e.info(GiNaC::info_flags::real)) {
      const double x = GiNaC::ex_to<GiNaC::numeric>(e).to_double();
      return {.kind = Node::Kind::number, .negative = x < 0.0, .key = fmt::format("{:a}", std::abs(x)), .number = std::abs(x)};
    }
    if (GiNaC::is_a<GiNaC::add>(e)) return sum(e);
    if (GiNaC::is_a<GiNaC::mul>(e)) return product(e);
    if (GiNaC::is_a<GiNaC::power>(e)) return power(e);
    if (GiNaC::is_a<GiNaC::function>(e))
      if (const Function* f = function_in_ginac(GiNaC::ex_to<GiNaC::function>(e).get_name()))
        return f->arguments == 1 ? call(*f, read(e.op(0))) : choice(*f, e);
    throw std::invalid_argument("is not a real expression");
  }

 private:
  static std::string signed_key(const Node& n) { return (n.negative ? '-' : '+') + n.key; }
  std::vector<Node> sorted(const GiNaC::ex& e) const {
    std::vector<Node> parts;
    for (std::size_t i = 0; i < e.nops(); ++i) parts.push_back(read(e.op(i)));
    std::stable_sort(parts.begin(), parts.end(), [](const Node& a, const Node& b) { return a.key > b.key; });
    return parts;
  }
  Node sum(const GiNaC::ex& e) const {
    Node n{.kind = Node::Kind::sum, .key = "+(", .parts = sorted(e)};
    n.negative = n.parts.front().negative;
    for (Node& part : n.parts) {
      part.negative = part.negative != n.negative;
      n.key += signed_key(part) + ',';
    }
    n.key += ')';
    return n;
  }
  Node product(const GiNaC::ex& e) const {
    Node n{.kind = Node::Kind::product, .key = "*(", .parts = sorted(e)};
    for (Node& part : n.parts) {
      n.negative = n.negative != part.negative;
      part.negative = false;
    }
    std::erase_if(n.parts, [](const Node& part) { return part.kind == Node::Kind::number && part.number == 1.0; });
    if (n.parts.empty()) return {.kind = Node::Kind::number, .negative = n.negative, .key = "1", .number = 1.0};
    if (n.parts.size() == 1) {
      Node only = std::move(n.parts.front());
      only.negative = n.negative;
      return only;
    }
    for (const Node& part : n.parts) n.key += part.key + ',';
    n.key += ')';
    return n;
  }
  Node power(const GiNaC::ex& e) const {
    Node base = read(e.op(0)), exponent = read(e.op(1));
    bool negative = false;
    if (exponent.is_whole()) {
      negative = base.negative && std::fmod(exponent.number, 2.0) != 0.0;
      base.negative = false;
    }
    std::string key = "^(" + signed_key(base) + ',' + signed_key(exponent) + ')';
    return {.kind = Node::Kind::power, .negative = negative, .key = std::move(key), .parts = {std::move(base), std::move(exponent)}};
  }
  static Node call(const Function& f, Node argument) {
    const bool odd = f.op == Op::sin || f.op == Op::tan || f.op == Op::sinh || f.op == Op::tanh || f.op == Op::atan || f.op == Op::sign;
    const bool even = f.op == Op::cos || f.op == Op::cosh || f.op == Op::abs;
    const bool negative = odd && argument.negative;
    if (odd || even) argument.negative = false;
    std::string key = std::string(f.name) + '(' + signed_key(argument) + ')';
    return {.kind = Node::Kind::call, .negative = negative, .key = std::move(key), .op = f.op, .parts = {std::move(argument)}};
  }

  Node choice(const Function& f, const GiNaC::ex& e) const {
    Node n{.kind = Node::Kind::call, .key = std::string(f.name) + '(', .op = f.op, .parts = sorted(e)};
    for (const Node& part : n.parts) n.key += signed_key(part) + ',';
    n.key += ')';
    return n;
  }

  const std::vector<double>& numbers_;
};

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
  static std::mutex one_at_a_time;  // GiNaC counts references without locks
  const std::lock_guard lock(one_at_a_time);
  Writer writer(inputs_);
  for (std::size_t i = 0; i < equations.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    std::vector<double> numbers;
    const std::string text = detail::text_for_ginac(equations[i], number, inputs, numbers);
    try {
      GiNaC::symtab symbols;
      for (int k = 0; k < inputs_; ++k) symbols[fmt::format("v{:05}", k)] = GiNaC::realsymbol(fmt::format("v{:05}", k));
      for (std::size_t k = 0; k < numbers.size(); ++k) symbols[fmt::format("c{}", k)] = GiNaC::realsymbol(fmt::format("c{}", k));
      GiNaC::parser reader(symbols, true);
      results_.push_back(writer.result(Flattener(writer).flatten(Reader(numbers).read(reader(text)))));
    } catch (const GiNaC::pole_error&) {
      throw ExpressionError(number, "divides by zero");
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
