#include "models/expression_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numbers>

namespace whirl::models::detail {

using Op = Step::Op;

namespace {

constexpr std::size_t max_length = 20000;  // of one equation; with max_depth it keeps the recursions below far from the end of the stack
constexpr int max_depth = 200;

constexpr Function functions[] = {{"exp", Op::exp},   {"log", Op::log},   {"sin", Op::sin},    {"cos", Op::cos},   {"tan", Op::tan},
                                  {"sinh", Op::sinh}, {"cosh", Op::cosh}, {"tanh", Op::tanh},  {"atan", Op::atan}, {"sqrt", Op::sqrt},
                                  {"abs", Op::abs},   {"sign", Op::sign}, {"max", Op::max, 2}, {"min", Op::min, 2}};

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
    const Function* called = nullptr;  ///< whose parentheses these are
    int arguments = 1;
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
    else if (const Function* f = function_named(name)) {
      value(name, std::string(name));
      previous_ = Before::function;
      called_ = f;
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
        level_ = {.called = previous_ == Before::function ? called_ : nullptr};
        previous_ = Before::open;
        break;
      case ',':
        next_argument();
        break;
      case ')':
        if (open_.empty()) fail(fmt::format("unbalanced: ')' {} closes nothing", where()));
        if (previous_ != Before::value) fail(fmt::format("a value is missing before ')' {}", where()));
        if (level_.called && level_.arguments < level_.called->arguments)
          fail(fmt::format("function {} takes two values: {}(a, b)", level_.called->name, level_.called->name));
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

  void next_argument() {
    if (!level_.called) fail(fmt::format("',' {} is not understood", where()));
    if (previous_ != Before::value) fail(fmt::format("a value is missing before ',' {}", where()));
    if (level_.arguments == level_.called->arguments)
      fail(fmt::format("function {} takes {}", level_.called->name, level_.called->arguments == 1 ? "one value" : "two values"));
    level_ = {.called = level_.called, .arguments = level_.arguments + 1};
    previous_ = Before::open;
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
  const Function* called_ = nullptr;  ///< the last function named
  Level level_;
  std::vector<Level> open_;
};

}  // namespace

const Function* function_named(std::string_view name) {
  const auto it = std::find_if(std::begin(functions), std::end(functions), [&](const Function& f) { return f.name == name; });
  return it == std::end(functions) ? nullptr : it;
}

std::string checked_text(std::string_view text, int equation, const std::vector<std::string>& inputs, std::vector<double>& numbers) {
  return Scanner(text, equation, inputs, numbers).rewritten();
}

void check_names(const std::vector<std::string>& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string& name = inputs[i];
    const bool well_formed = !name.empty() && letter(name[0]) && std::all_of(name.begin(), name.end(), [](char c) { return letter(c) || digit(c); });
    if (!well_formed) throw ExpressionError(0, fmt::format("'{}' is no name: letters, digits and _ only, a letter first", name));
    if (function_named(name)) throw ExpressionError(0, fmt::format("'{}' is the name of a function", name));
    if (std::find(inputs.begin(), inputs.begin() + static_cast<std::ptrdiff_t>(i), name) != inputs.begin() + static_cast<std::ptrdiff_t>(i))
      throw ExpressionError(0, fmt::format("the name '{}' is given twice", name));
  }
}

}  // namespace whirl::models::detail
