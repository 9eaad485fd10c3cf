#include "models/expression_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "models/expression_text.hpp"

namespace whirl::models::detail {

using Op = Step::Op;

bool Node::is_whole() const { return kind == Kind::number && number == std::floor(number); }

namespace {

std::string signed_key(const Node& n) { return (n.negative ? '-' : '+') + n.key; }

Node count(double x) {
  return {.kind = Node::Kind::number, .negative = x < 0.0, .key = fmt::format("{:a}", std::abs(x)), .number = std::abs(x), .counted = true};
}

void sort_by_key(std::vector<Node>& parts) {
  std::stable_sort(parts.begin(), parts.end(), [](const Node& a, const Node& b) { return a.key > b.key; });
}

Node power(Node base, Node exponent) {
  bool negative = false;
  if (exponent.is_whole()) {
    negative = base.negative && std::fmod(exponent.number, 2.0) != 0.0;
    base.negative = false;
  }
  std::string key = "^(" + signed_key(base) + ',' + signed_key(exponent) + ')';
  return {.kind = Node::Kind::power, .negative = negative, .key = std::move(key), .parts = {std::move(base), std::move(exponent)}};
}

// How often a thing stands in a sum, or to which power in a product, in the order of first appearance.
class Tally {
 public:
  void add(Node thing, double times) {
    const auto [at, fresh] = place_.try_emplace(thing.key, things_.size());
    if (fresh) things_.emplace_back(std::move(thing), 0.0);
    things_[at->second].second += times;
  }
  std::vector<std::pair<Node, double>>& things() { return things_; }

 private:
  std::map<std::string, std::size_t> place_;
  std::vector<std::pair<Node, double>> things_;
};

Node product(std::vector<Node> factors);

void add_term(Node term, Tally& tally) {
  if (term.kind == Node::Kind::sum) {
    for (Node& part : term.parts) {
      part.negative = part.negative != term.negative;
      add_term(std::move(part), tally);
    }
    return;
  }
  double times = term.negative ? -1.0 : 1.0;
  term.negative = false;
  if (term.kind == Node::Kind::product) {  // a count before it
    const auto counted = std::find_if(term.parts.begin(), term.parts.end(), [](const Node& part) { return part.counted; });
    if (counted != term.parts.end()) {
      times *= counted->number;
      term.parts.erase(counted);
      term = product(std::move(term.parts));
    }
  }
  tally.add(std::move(term), times);
}

Node sum(std::vector<Node> terms) {
  Tally tally;
  for (Node& term : terms) add_term(std::move(term), tally);
  std::vector<Node> parts;
  for (auto& [thing, times] : tally.things()) {
    if (times == 0.0) continue;
    if (std::abs(times) != 1.0) thing = product({count(std::abs(times)), std::move(thing)});
    thing.negative = times < 0.0;
    parts.push_back(std::move(thing));
  }
  if (parts.empty()) return count(0.0);
  if (parts.size() == 1) return std::move(parts.front());
  sort_by_key(parts);
  Node n{.kind = Node::Kind::sum, .negative = parts.front().negative, .key = "+("};
  for (Node& part : parts) {
    part.negative = part.negative != n.negative;
    n.key += signed_key(part) + ',';
  }
  n.key += ')';
  n.parts = std::move(parts);
  return n;
}

void add_factor(Node factor, Tally& tally, double& counted, bool& negative) {
  negative = negative != factor.negative;
  factor.negative = false;
  if (factor.kind == Node::Kind::product) {
    for (Node& part : factor.parts) add_factor(std::move(part), tally, counted, negative);
  } else if (factor.counted) {
    counted *= factor.number;
  } else if (factor.kind == Node::Kind::power && factor.parts[1].counted) {
    const double exponent = factor.parts[1].negative ? -factor.parts[1].number : factor.parts[1].number;
    tally.add(std::move(factor.parts[0]), exponent);
  } else {
    tally.add(std::move(factor), 1.0);
  }
}

Node product(std::vector<Node> factors) {
  Tally tally;
  double counted = 1.0;
  bool negative = false;
  for (Node& factor : factors) add_factor(std::move(factor), tally, counted, negative);
  std::vector<Node> parts;
  if (counted == 0.0) return count(0.0);
  if (counted != 1.0) parts.push_back(count(counted));
  for (auto& [thing, exponent] : tally.things()) {
    if (exponent == 0.0) continue;
    parts.push_back(exponent == 1.0 ? std::move(thing) : power(std::move(thing), count(exponent)));
  }
  if (parts.empty()) parts.push_back(count(1.0));
  if (parts.size() == 1) {
    parts.front().negative = parts.front().negative != negative;
    return std::move(parts.front());
  }
  sort_by_key(parts);
  Node n{.kind = Node::Kind::product, .negative = negative, .key = "*("};
  for (const Node& part : parts) n.key += part.key + ',';
  n.key += ')';
  n.parts = std::move(parts);
  return n;
}

Node inverse(Node n) {
  if (n.counted && n.number == 0.0) throw std::domain_error("divides by zero");
  if (n.kind == Node::Kind::product) {
    for (Node& part : n.parts) part = inverse(std::move(part));
    std::vector<Node> parts = std::move(n.parts);
    Node all = product(std::move(parts));
    all.negative = all.negative != n.negative;
    return all;
  }
  if (n.kind == Node::Kind::power) {
    Node exponent = n.parts[1];
    exponent.negative = !exponent.negative;
    Node flipped = power(std::move(n.parts[0]), std::move(exponent));
    flipped.negative = n.negative;
    return flipped;
  }
  return power(std::move(n), count(-1.0));
}

Node call(const Function& f, std::vector<Node> arguments) {
  if (f.op == Op::sqrt) return power(std::move(arguments.front()), count(0.5));
  const bool odd = f.op == Op::sin || f.op == Op::tan || f.op == Op::sinh || f.op == Op::tanh || f.op == Op::atan || f.op == Op::sign;
  const bool even = f.op == Op::cos || f.op == Op::cosh || f.op == Op::abs;
  Node n{.kind = Node::Kind::call, .key = std::string(f.name) + '(', .op = f.op};
  if (arguments.size() > 1) sort_by_key(arguments);
  n.negative = odd && arguments.front().negative;
  if (odd || even) arguments.front().negative = false;
  for (const Node& part : arguments) n.key += signed_key(part) + (arguments.size() > 1 ? "," : "");
  n.key += ')';
  n.parts = std::move(arguments);
  return n;
}

/// sum: [+ -] product {+ - product}; product: raised {* / raised}; raised: value [^ value]; value: name, number, (sum), function(sum {, sum}).
class Parser {
 public:
  Parser(const std::string& tokens, const std::vector<double>& numbers) : numbers_(numbers) {
    std::istringstream in(tokens);
    for (std::string token; in >> token;) tokens_.push_back(std::move(token));
  }

  Node all() {
    Node n = whole_sum();
    if (at_ < tokens_.size()) throw std::invalid_argument("is not understood");
    return n;
  }

 private:
  bool is(std::string_view token) const { return at_ < tokens_.size() && tokens_[at_] == token; }
  bool take(std::string_view token) {
    if (!is(token)) return false;
    ++at_;
    return true;
  }
  void expect(std::string_view token) {
    if (!take(token)) throw std::invalid_argument("is not understood");
  }

  Node whole_sum() {
    std::vector<Node> terms;
    bool negative = take("-");
    if (!negative) (void)take("+");
    for (;;) {
      terms.push_back(whole_product());
      terms.back().negative = terms.back().negative != negative;
      if (take("+")) negative = false;
      else if (take("-")) negative = true;
      else return terms.size() == 1 ? std::move(terms.front()) : sum(std::move(terms));
    }
  }
  Node whole_product() {
    std::vector<Node> factors;
    bool below = false;
    for (;;) {
      Node factor = raised();
      factors.push_back(below ? inverse(std::move(factor)) : std::move(factor));
      if (take("*")) below = false;
      else if (take("/")) below = true;
      else return factors.size() == 1 ? std::move(factors.front()) : product(std::move(factors));
    }
  }
  Node raised() {
    Node base = value();
    if (!take("^")) return base;
    return power(std::move(base), value());
  }
  Node value() {
    if (take("(")) {
      Node inside = whole_sum();
      expect(")");
      return inside;
    }
    if (at_ == tokens_.size()) throw std::invalid_argument("is not understood");
    const std::string& token = tokens_[at_++];
    if (is("(")) {
      const Function* f = function_named(token);
      if (!f) throw std::invalid_argument("is not understood");
      ++at_;
      std::vector<Node> arguments = {whole_sum()};
      while (take(",")) arguments.push_back(whole_sum());
      expect(")");
      return call(*f, std::move(arguments));
    }
    const int index = std::stoi(token.substr(1));
    if (token[0] == 'v') return {.kind = Node::Kind::input, .key = token, .input = index};
    return {.kind = Node::Kind::number, .key = token, .number = numbers_[static_cast<std::size_t>(index)]};
  }

  const std::vector<double>& numbers_;
  std::vector<std::string> tokens_;
  std::size_t at_ = 0;
};

}  // namespace

Node tree_of(const std::string& tokens, const std::vector<double>& numbers) { return Parser(tokens, numbers).all(); }

}  // namespace whirl::models::detail
