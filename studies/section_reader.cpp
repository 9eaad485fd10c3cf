#include "studies/section_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#ifndef TOML_SHARED_LIB
#define TOML_SHARED_LIB 1
#endif
#include <toml++/toml.h>

namespace whirl::studies {

struct SectionReader::Node {
  toml::table table;
};

namespace {

std::string inline_text(const toml::node& node) {
  if (const auto x = node.value_exact<double>()) return toml_text(*x);
  if (const auto text = node.value_exact<std::string>()) return toml_text(*text);
  if (const toml::array* array = node.as_array()) {
    std::vector<std::string> items;
    for (const toml::node& item : *array) items.push_back(inline_text(item));
    return fmt::format("[{}]", fmt::join(items, ", "));
  }
  std::ostringstream out;
  node.visit([&](const auto& n) { out << n; });
  return out.str();
}

std::string shown(const toml::node& node) {
  std::string s = inline_text(node);
  std::replace(s.begin(), s.end(), '\n', ' ');
  return s.size() > 80 ? s.substr(0, 77) + "..." : s;
}

std::optional<double> number_of(const toml::node& node) {
  std::optional<double> x;
  if (const auto* i = node.as_integer()) x = static_cast<double>(i->get());
  else x = node.value_exact<double>();
  return x && std::isfinite(*x) ? x : std::nullopt;
}
std::optional<int> integer_of(const toml::node& node) {
  constexpr std::int64_t largest = 999999;
  const auto i = node.value_exact<std::int64_t>();
  return i && *i >= -largest && *i <= largest ? std::optional<int>(static_cast<int>(*i)) : std::nullopt;
}
std::optional<std::string> text_of(const toml::node& node) { return node.value_exact<std::string>(); }

template <class T, class Read>
std::optional<std::vector<T>> items_of(const toml::node& node, Read&& read) {
  const toml::array* array = node.as_array();
  if (!array) return std::nullopt;
  std::vector<T> items;
  for (const toml::node& item : *array) {
    auto x = read(item);
    if (!x) return std::nullopt;
    items.push_back(std::move(*x));
  }
  return items;
}

}  // namespace

SectionReader::SectionReader(const Configuration& c, const std::string& section) : configuration_(&c), place_(section), name_(section) {
  node_ = std::make_shared<Node>(Node{toml::parse(c.raw(section))});
}

bool SectionReader::has(const std::string& key) const {
  asked_->insert(key);
  return node_->table.contains(key);
}

InputError SectionReader::error(const std::string& key, const std::string& what) const {
  const toml::node* node = node_->table.get(key);
  const std::string place = place_ + "." + key;
  return InputError(fmt::format("{}: {}.{}{}: {}", configuration_->place(configuration_->is_given(place) ? place : place_), name_, key,
                                node ? " = " + shown(*node) : " is missing", what));
}

InputError SectionReader::error(const std::string& what) const {
  return InputError(fmt::format("{}: {}: {}", configuration_->place(place_), name_, what));
}

double SectionReader::number(const std::string& key, std::optional<double> fallback) const {
  if (!has(key) && fallback) return *fallback;
  const toml::node* node = node_->table.get(key);
  const auto x = node ? number_of(*node) : std::nullopt;
  if (!x) throw error(key, "must be a finite number");
  return *x;
}

std::int64_t SectionReader::integer(const std::string& key, std::int64_t lower, std::int64_t upper, std::optional<std::int64_t> fallback) const {
  if (!has(key) && fallback) return *fallback;
  const toml::node* node = node_->table.get(key);
  const auto x = node ? node->value_exact<std::int64_t>() : std::nullopt;
  if (!x || *x < lower || *x > upper) throw error(key, fmt::format("must be an integer in {}..{}", lower, upper));
  return *x;
}

std::string SectionReader::text(const std::string& key, std::optional<std::string> fallback) const {
  if (!has(key) && fallback) return *fallback;
  const toml::node* node = node_->table.get(key);
  const auto x = node ? text_of(*node) : std::nullopt;
  if (!x || x->empty()) throw error(key, "must be a text in quotes");
  return *x;
}

template <class Read>
auto SectionReader::array(const std::string& key, const char* wanted, Read&& read) const {
  (void)has(key);
  const toml::node* node = node_->table.get(key);
  auto items = node ? read(*node) : std::nullopt;
  if (!items) throw error(key, fmt::format("must be {}", wanted));
  return std::move(*items);
}

std::vector<double> SectionReader::numbers(const std::string& key, std::optional<std::vector<double>> fallback) const {
  if (!has(key) && fallback) return *fallback;
  return array(key, "an array of finite numbers", [](const toml::node& n) { return items_of<double>(n, number_of); });
}
std::vector<int> SectionReader::integers(const std::string& key) const {
  return array(key, "an array of integers", [](const toml::node& n) { return items_of<int>(n, integer_of); });
}
std::vector<std::string> SectionReader::texts(const std::string& key) const {
  return array(key, "an array of texts", [](const toml::node& n) { return items_of<std::string>(n, text_of); });
}
std::vector<std::string> SectionReader::text_or_texts(const std::string& key) const {
  return array(key, "a text or an array of texts", [](const toml::node& n) {
    if (auto one = text_of(n)) return std::optional(std::vector{std::move(*one)});
    return items_of<std::string>(n, text_of);
  });
}
std::vector<std::vector<double>> SectionReader::rows(const std::string& key) const {
  return array(key, "an array of rows, each an array of numbers", [](const toml::node& n) {
    return items_of<std::vector<double>>(n, [](const toml::node& row) { return items_of<double>(row, number_of); });
  });
}
std::vector<std::vector<std::string>> SectionReader::text_rows(const std::string& key) const {
  return array(key, "an array of arrays of texts", [](const toml::node& n) {
    return items_of<std::vector<std::string>>(n, [](const toml::node& row) { return items_of<std::string>(row, text_of); });
  });
}

std::vector<std::pair<std::string, double>> SectionReader::named_numbers(const std::string& key) const {
  (void)has(key);
  const toml::node* node = node_->table.get(key);
  const toml::table* table = node ? node->as_table() : nullptr;
  if (!table) throw error(key, "must be a table of numbers: { a = 1.0, b = 2.0 }");
  std::vector<std::pair<std::string, double>> all;
  for (const auto& [name, value] : *table) {
    const auto x = number_of(value);
    if (!x) throw error(key, fmt::format("{} must be a finite number", name.str()));
    all.emplace_back(name.str(), *x);
  }
  return all;
}

std::vector<std::pair<std::string, std::vector<std::string>>> SectionReader::named_texts(const std::string& key) const {
  (void)has(key);
  const toml::node* node = node_->table.get(key);
  const toml::table* table = node ? node->as_table() : nullptr;
  const auto fail = [&] { return error(key, "must be a table of arrays of texts: { A = [\"x\", \"y\"] }"); };
  if (!table) throw fail();
  std::vector<std::pair<std::string, std::vector<std::string>>> all;
  for (const auto& [name, value] : *table) {
    auto items = items_of<std::string>(value, text_of);
    if (!items) throw fail();
    all.emplace_back(name.str(), std::move(*items));
  }
  return all;
}

std::vector<SectionReader> SectionReader::tables(const std::string& key) const {
  if (!has(key)) return {};
  const toml::array* array = node_->table.get(key)->as_array();
  if (!array || !std::all_of(array->begin(), array->end(), [](const toml::node& n) { return n.is_table(); }))
    throw error(key, fmt::format("must be tables, each under a header [[{}.{}]]", name_, key));
  std::vector<SectionReader> all;
  for (std::size_t i = 0; i < array->size(); ++i)
    all.push_back(SectionReader(*configuration_, fmt::format("{}.{}[{}]", place_, key, i), fmt::format("{}.{}[{}]", name_, key, i + 1),
                                std::make_shared<Node>(Node{*(*array)[i].as_table()})));
  return all;
}

std::vector<std::string> SectionReader::others() const {
  std::vector<std::string> names;
  for (const auto& [key, node] : node_->table)
    if (const std::string name(key.str()); !asked_->contains(name)) names.push_back(name);
  return names;
}

void SectionReader::no_others() const {
  for (const std::string& name : others()) {
    const std::string near = nearest(name, {asked_->begin(), asked_->end()});
    throw error(name, near.empty() ? fmt::format("unknown key; {} takes {}", name_, fmt::join(*asked_, ", "))
                                   : fmt::format("unknown key, did you mean {}?", near));
  }
}

}  // namespace whirl::studies
