#include "models/expression.hpp"

#include <fmt/format.h>
#include <ginac/ginac.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>

#include "models/expression_steps.hpp"

namespace whirl::models {

using Op = Step::Op;

ExpressionError::ExpressionError(int equation_number, const std::string& why)
    : std::invalid_argument(equation_number > 0 ? fmt::format("equation {}: {}", equation_number, why) : why),
      equation(equation_number),
      reason(why) {}

namespace {

constexpr std::size_t max_length = 20000;  // of one equation; with max_depth it keeps the recursions below far from the end of the stack
constexpr int max_depth = 200;

struct Function {
  std::string_view name;
  Op op;
};
constexpr Function functions[] = {{"exp", Op::exp},   {"log", Op::log},   {"sin", Op::sin},   {"cos", Op::cos},
                                  {"tan", Op::tan},   {"sinh", Op::sinh}, {"cosh", Op::cosh}, {"tanh", Op::tanh},
                                  {"atan", Op::atan}, {"sqrt", Op::sqrt}, {"abs", Op::abs}};
const Function* function(std::string_view name) {
  const auto it = std::find_if(std::begin(functions), std::end(functions), [&](const Function& f) { return f.name == name; });
  return it == std::end(functions) ? nullptr : it;
}

// ASCII only, whatever the locale.
bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }

// ---------------------------------------------------------------------------------------------------------------- text to text

/// Edit distance; what a misspelt name most likely stands for, "" if nothing is near.
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t least = std::max<std::size_t>(1, (name.size() + 1) / 3) + 1;
  if (name.size() > 100) return best;
  for (const auto& candidate : candidates) {
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= name.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j < row.size(); ++j) {
        const std::size_t replaced = diagonal + (name[i - 1] == candidate[j - 1] ? 0u : 1u);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
      }
    }
    if (row.back() < least) {
      least = row.back();
      best = candidate;
    }
  }
  return best;
}

/// Checks an equation token by token and writes it for GiNaC in names of our own: input 3 becomes v00003, number 3 c3. So GiNaC
/// never computes with the user's numbers, whose digits it would round to decimal places and whose powers it would expand without limit, and no
/// input is taken for one of its constants.
class Scanner {
 public:
  Scanner(std::string_view text, int equation, const std::vector<std::string>& inputs, std::vector<double>& numbers)
      : text_(text), equation_(equation), inputs_(inputs), numbers_(numbers) {}

  std::string rewritten() {
    if (text_.size() > max_length) fail(fmt::format("longer than {} characters", max_length));
    while (skip_space(), at_ < text_.size()) {
      const char c = text_[at_];
      if (digit(c) || c == '.') number();
      else if (letter(c)) name();
      else symbol(c);
    }
    if (previous_ == Before::start) fail("is empty");
    if (previous_ != Before::value) fail(fmt::format("ends with '{}' where a value must follow", shown_));
    if (!open_.empty()) fail(fmt::format("unbalanced: {} '(' not closed", open_.size()));
    return out_;
  }

 private:
  enum class Before { start, open, value, operation, function };
  struct Level {
    bool in_exponent = false;
  };

  [[noreturn]] void fail(const std::string& reason) const { throw ExpressionError(equation_, reason); }
  std::string where() const { return fmt::format("at character {}", at_ + 1); }

  void skip_space() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r')) ++at_;
  }

  void value(std::string_view shown, const std::string& written) {
    if (previous_ == Before::value) fail(fmt::format("'{}' and '{}' stand side by side {}: write * between them", shown_, shown, where()));
    if (previous_ == Before::function) fail(fmt::format("function {} needs parentheses: {}(...)", shown_, shown_));
    out_ += written + ' ';
    shown_ = shown;
    previous_ = Before::value;
  }

  void number() {
    double x = 0.0;
    const char *first = text_.data() + at_, *last = text_.data() + text_.size();
    const auto [end, error] = std::from_chars(first, last, x);
    const std::string_view shown(first, static_cast<std::size_t>(std::max(end - first, std::ptrdiff_t{1})));
    if (error == std::errc::result_out_of_range) fail(fmt::format("the number {} is out of range", shown));
    if (error != std::errc() || (end != last && (*end == '.' || digit(*end)))) fail(fmt::format("not a number {}", where()));
    auto known = std::find(numbers_.begin(), numbers_.end(), x);
    if (known == numbers_.end()) known = numbers_.insert(numbers_.end(), x);
    value(shown, fmt::format("c{}", known - numbers_.begin()));
    at_ += static_cast<std::size_t>(end - first);
  }

  void name() {
    std::size_t end = at_;
    while (end < text_.size() && (letter(text_[end]) || digit(text_[end]))) ++end;
    const std::string_view name = text_.substr(at_, end - at_);
    const auto input = std::find(inputs_.begin(), inputs_.end(), name);
    if (input != inputs_.end()) value(name, fmt::format("v{:05}", input - inputs_.begin()));
    else if (const Function* f = function(name)) {
      value(name, std::string(f->name));
      previous_ = Before::function;
    } else if (name == "pi") {
      numbers_.push_back(std::numbers::pi);
      value(name, fmt::format("c{}", numbers_.size() - 1));
    } else unknown(name);
    at_ = end;
  }

  [[noreturn]] void unknown(std::string_view name) const {
    std::vector<std::string> known = inputs_;
    for (const auto& f : functions) known.emplace_back(f.name);
    const std::string near = nearest_name(name, known);
    std::string takes;
    for (const auto& i : inputs_) takes += (takes.empty() ? "" : ", ") + i;
    fail(fmt::format("unknown symbol '{}'{}", name, near.empty() ? "; known are " + takes : fmt::format(", did you mean {}?", near)));
  }

  void symbol(char c) {
    if (previous_ == Before::function && c != '(') fail(fmt::format("function {} needs parentheses: {}(...)", shown_, shown_));
    switch (c) {
      case '(':
        if (previous_ == Before::value) fail(fmt::format("'{}' and '(' stand side by side {}: write * between them", shown_, where()));
        if (static_cast<int>(open_.size()) >= max_depth) fail(fmt::format("more than {} parentheses in each other", max_depth));
        open_.push_back(level_);
        level_ = {};
        previous_ = Before::open;
        break;
      case ')':
        if (open_.empty()) fail(fmt::format("unbalanced: ')' {} closes nothing", where()));
        if (previous_ != Before::value) fail(fmt::format("a value is missing before ')' {}", where()));
        level_ = open_.back();
        open_.pop_back();
        break;
      case '+':
      case '-':
      case '*':
      case '/':
      case '^':
        operation(c);
        break;
      default:
        fail(static_cast<unsigned char>(c) < 0x7f && c > ' ' ? fmt::format("'{}' {} is not understood", c, where())
                                                             : fmt::format("a character that is not plain text {}", where()));
    }
    out_ += {c, ' '};
    shown_ = text_.substr(at_, 1);
    ++at_;
  }

  void operation(char c) {
    const bool sign = (c == '+' || c == '-') && (previous_ == Before::start || previous_ == Before::open);
    if (previous_ == Before::operation && (c == '+' || c == '-')) fail(fmt::format("a sign behind '{}' needs parentheses {}", shown_, where()));
    if (previous_ != Before::value && !sign) fail(fmt::format("a value is missing before '{}' {}", c, where()));
    if (c == '^' && level_.in_exponent) fail(fmt::format("x^y^z needs parentheses {}", where()));
    level_.in_exponent = c == '^';
    previous_ = Before::operation;
  }

  std::string_view text_;
  int equation_;
  const std::vector<std::string>& inputs_;
  std::vector<double>& numbers_;
  std::string out_;
  std::size_t at_ = 0;
  Before previous_ = Before::start;
  std::string_view shown_;
  Level level_;
  std::vector<Level> open_;
};

void check_names(const std::vector<std::string>& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string& name = inputs[i];
    const bool well_formed = !name.empty() && letter(name[0]) && std::all_of(name.begin(), name.end(), [](char c) { return letter(c) || digit(c); });
    if (!well_formed) throw ExpressionError(0, fmt::format("'{}' is no name: letters, digits and _ only, a letter first", name));
    if (function(name)) throw ExpressionError(0, fmt::format("'{}' is the name of a function", name));
    if (std::find(inputs.begin(), inputs.begin() + static_cast<std::ptrdiff_t>(i), name) != inputs.begin() + static_cast<std::ptrdiff_t>(i))
      throw ExpressionError(0, fmt::format("the name '{}' is given twice", name));
  }
}

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
      if (const Function* f = function(GiNaC::ex_to<GiNaC::function>(e).get_name())) return call(*f, read(e.op(0)));
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
    const bool odd = f.op == Op::sin || f.op == Op::tan || f.op == Op::sinh || f.op == Op::tanh || f.op == Op::atan;
    const bool even = f.op == Op::cos || f.op == Op::cosh || f.op == Op::abs;
    const bool negative = odd && argument.negative;
    if (odd || even) argument.negative = false;
    std::string key = std::string(f.name) + '(' + signed_key(argument) + ')';
    return {.kind = Node::Kind::call, .negative = negative, .key = std::move(key), .op = f.op, .parts = {std::move(argument)}};
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
        return signed_value(writer_.call(n.op, flatten(n.parts[0])), negative);
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
  check_names(inputs);
  static std::mutex one_at_a_time;  // GiNaC counts references without locks
  const std::lock_guard lock(one_at_a_time);
  Writer writer(inputs_);
  for (std::size_t i = 0; i < equations.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    std::vector<double> numbers;
    const std::string text = Scanner(equations[i], number, inputs, numbers).rewritten();
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
