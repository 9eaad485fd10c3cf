#include "studies/configuration.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

// toml++ from its shared library: compiled into this file it aborts on inputs as short as `[=`.
#ifndef TOML_SHARED_LIB
#define TOML_SHARED_LIB 1
#endif
#include <toml++/toml.h>

namespace whirl::studies {
namespace {

template <class... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};
template <class... Fs>
Overloaded(Fs...) -> Overloaded<Fs...>;

constexpr std::size_t max_file_size = std::size_t{1} << 24;  // 16 MB: a study file is a page; stops /dev/zero and swapped arguments
constexpr std::size_t max_depth = 64;                        // of nested sections; keeps recursion far from the end of the stack

std::string number_text(double x) {
  if (std::isnan(x)) return "nan";
  std::string s = fmt::format("{}", x);
  return std::isinf(x) || s.find_first_of(".e") != std::string::npos ? s : s + ".0";
}

std::string in_quotes(std::string_view text) {
  std::string s = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') s += {'\\', c};
    else if (c == '\n') s += "\\n";
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) s += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    else s += c;
  }
  return s + '"';
}

bool inside_character(std::string_view s, std::size_t at) { return (static_cast<unsigned char>(s[at]) & 0xc0) == 0x80; }  // of UTF-8

std::string without_breaks(std::string_view text) {
  std::string s;
  for (const char c : text) {
    const bool space = static_cast<unsigned char>(c) <= 0x20 || c == 0x7f;
    if (!space) s += c;
    if (space && !s.empty() && s.back() != ' ') s += ' ';
  }
  return s;
}

/// One line of at most 80 characters.
std::string one_line(std::string_view text) {
  std::string s = without_breaks(text);
  if (s.size() <= 80) return s;
  std::size_t end = 77;
  while (end > 0 && inside_character(s, end)) --end;
  return s.substr(0, end) + "...";
}

/// A node as one line of TOML, what is nested deeply left out.
std::string inline_text(const toml::node& node, int depth = 0) {
  std::vector<std::string> parts;
  if (depth > 4) return "...";
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& item : *array) parts.push_back(inline_text(item, depth + 1));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, item] : *table) parts.push_back(fmt::format("{} = {}", key.str(), inline_text(item, depth + 1)));
    return fmt::format("{{{}}}", fmt::join(parts, ", "));
  }
  if (node.is_string()) return in_quotes(node.as_string()->get());
  if (node.is_floating_point()) return number_text(node.as_floating_point()->get());
  std::ostringstream out;
  node.visit([&](const auto& n) { out << n; });
  return out.str();
}

std::string shown(const toml::node& node) { return one_line(inline_text(node)); }

template <class Names>
std::string quoted_list(const Names& names) {
  std::vector<std::string> q;
  for (const auto& name : names) q.push_back(in_quotes(name));
  return fmt::format("{}", fmt::join(q, ", "));
}

std::string section_of(std::string_view name) {
  const auto dot = name.rfind('.');
  return std::string(dot == std::string_view::npos ? "" : name.substr(0, dot));
}
std::string leaf_of(std::string_view name) { return std::string(name.substr(name.rfind('.') + 1)); }  // npos + 1 == 0
std::string join(std::string_view section, std::string_view name) {
  return section.empty() ? std::string(name) : fmt::format("{}.{}", section, name);
}

/// Damerau-Levenshtein distance (optimal string alignment): insertions, deletions, substitutions, swaps of neighbours.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

/// "> 0 and <= 1", "" without bounds
std::string bounds(const Key& key) {
  std::string s;
  if (std::isfinite(key.lower)) s = fmt::format("{} {}", key.closed_lower ? ">=" : ">", key.lower);
  if (std::isfinite(key.upper)) s += fmt::format("{}{} {}", s.empty() ? "" : " and ", key.closed_upper ? "<=" : "<", key.upper);
  return s;
}

std::string unit_text(const Key& key) { return key.unit.empty() || key.unit == "-" ? "" : fmt::format(" [{}]", key.unit); }

std::string of(const Key& key, std::string_view lead) {
  const std::string range = key.choices.empty() ? bounds(key) : "one of " + quoted_list(key.choices);
  return fmt::format("{}{}{}{}", lead, range.empty() || lead.empty() ? "" : " ", range, unit_text(key));
}

std::string array_of(const Key& key, std::string_view plural) {
  std::string s;
  if (key.min_items == key.max_items) s = fmt::format("an array of {} {}", key.min_items, plural);
  else if (key.min_items > 0)
    s = fmt::format("an array of at least {} {}", key.min_items, key.min_items == 1 ? plural.substr(0, plural.size() - 1) : plural);
  else s = fmt::format("an array of {}", plural);
  if (key.max_items != key.min_items && key.max_items != std::numeric_limits<std::size_t>::max()) s += fmt::format(", at most {}", key.max_items);
  const std::string each = of(key, "");
  const bool ranged = !key.choices.empty() || !bounds(key).empty();
  return s + (ranged ? ", each " + each : each);
}

/// What is wrong with a value of the right type: "must be > 0 [N]"; "" if nothing is.
std::string complaint(const Key& key, const Value& value) {
  const auto number = [&](double x, const char* who) {
    const bool above = key.closed_lower ? x >= key.lower : x > key.lower;
    const bool below = key.closed_upper ? x <= key.upper : x < key.upper;
    if (!std::isfinite(x)) return fmt::format("{} be {}", who, of(key, "a finite number"));
    return above && below ? std::string() : fmt::format("{} be {}", who, of(key, ""));
  };
  const auto text = [&](const std::string& s, const char* who) {
    const bool known = key.choices.empty() || std::find(key.choices.begin(), key.choices.end(), s) != key.choices.end();
    return known ? std::string() : fmt::format("{} be {}", who, of(key, ""));
  };
  const auto each = [&](const auto& items, const auto& check) {
    if (items.size() < key.min_items || items.size() > key.max_items) return "must be " + key.accepted();
    for (const auto& item : items)
      if (std::string s = check(item, "each value must"); !s.empty()) return s;
    return std::string();
  };
  return std::visit(
      Overloaded{[](bool) { return std::string(); }, [&](std::int64_t i) { return number(static_cast<double>(i), "must"); },
                 [&](double x) { return number(x, "must"); }, [&](const std::string& s) { return text(s, "must"); },
                 [&](const std::vector<double>& v) { return each(v, number); }, [&](const std::vector<std::string>& v) { return each(v, text); }},
      value);
}

std::optional<double> number_of(const toml::node& node) {
  if (const auto* i = node.as_integer()) return static_cast<double>(i->get());
  return node.value_exact<double>();
}
std::optional<std::string> text_of(const toml::node& node) { return node.value_exact<std::string>(); }

template <class Read>
auto array_of_values(const toml::node& node, Read&& read) -> std::optional<Value> {
  const toml::array* array = node.as_array();
  if (!array) return std::nullopt;
  std::vector<typename decltype(read(node))::value_type> items;
  for (const toml::node& item : *array) {
    auto x = read(item);
    if (!x) return std::nullopt;
    items.push_back(std::move(*x));
  }
  return items;
}

template <class T>
std::optional<Value> wrap(const std::optional<T>& x) {
  return x ? std::optional<Value>(*x) : std::nullopt;
}

/// The node as the type of `like`; nothing if it is of another type.
std::optional<Value> typed(const toml::node& node, const Value& like) {
  return std::visit(
      Overloaded{[&](bool) { return wrap(node.value_exact<bool>()); }, [&](std::int64_t) { return wrap(node.value_exact<std::int64_t>()); },
                 [&](double) { return wrap(number_of(node)); }, [&](const std::string&) { return wrap(text_of(node)); },
                 [&](const std::vector<double>&) { return array_of_values(node, number_of); },
                 [&](const std::vector<std::string>&) { return array_of_values(node, text_of); }},
      like);
}

/// Names of a thousand parts and more would exhaust the stack of the parser.
void refuse_endless_names(std::string_view text, const std::string& source) {
  int line = 1, dots = 0;
  for (const char c : text) {
    if (c == '\n') ++line;
    if (c == '\n' || c == ',') dots = 0;
    if (c == '.' && ++dots > 1000) throw InputError(fmt::format("{}:{}: not valid TOML: sections nested too deeply", source, line));
  }
}

toml::table parse(std::string_view text, const std::string& source) {
  refuse_endless_names(text, source);
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& e) {
    throw InputError(fmt::format("{}:{}: not valid TOML: {}", source, e.source().begin.line, one_line(e.description())));
  }
}

std::string read_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError(fmt::format("{}: no such file", path.string()));
  if (std::filesystem::is_directory(path, ignored)) throw InputError(fmt::format("{}: is a directory, not a study file", path.string()));
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read", path.string()));
  std::string text;
  for (char block[4096]; in.read(block, sizeof block), in.gcount() > 0;) {
    text.append(block, static_cast<std::size_t>(in.gcount()));
    if (text.size() > max_file_size) throw InputError(fmt::format("{}: larger than 16 MB, not a study file", path.string()));
  }
  return text;
}

/// The value of an override as a node of its own table; nothing if the text is no single TOML value.
toml::table override_value(std::string_view text, const std::string& shown_override) {
  const bool one_value = text.find_first_of("\n\r") == std::string_view::npos;
  if (one_value) try {
      if (toml::table t = toml::parse(fmt::format("value = {}", text)); t.size() == 1) return t;
    } catch (const toml::parse_error&) {
    }
  const bool bare = one_value && !text.empty() && text.find_first_of("[]{}\"'=,#") == std::string_view::npos;
  if (!bare) throw InputError(fmt::format("--set: {}: the value is neither TOML nor a bare word", shown_override));
  return toml::table{{"value", std::string(text)}};
}

/// One part of an override's name, "term[2]": a key and what stands in brackets behind it, counted from 1.
struct PathPart {
  std::string key;
  std::vector<std::size_t> indices;
};

/// Nothing if the part is not of that form.
std::optional<PathPart> path_part(std::string_view text) {
  PathPart part{std::string(text.substr(0, text.find('['))), {}};
  for (text.remove_prefix(part.key.size()); !text.empty();) {
    std::size_t index = 0;
    const auto close = text.find(']');
    if (text.front() != '[' || close == std::string_view::npos) return std::nullopt;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + close, index);
    if (error != std::errc() || end != text.data() + close || index == 0) return std::nullopt;
    part.indices.push_back(index - 1);
    text.remove_prefix(close + 1);
  }
  return part.key.empty() ? std::nullopt : std::optional(part);
}

/// The node that the part names in a section, null if there is none.
toml::node* find_part(toml::table& section, const PathPart& part, std::size_t indices) {
  toml::node* node = section.get(part.key);
  for (std::size_t k = 0; k < indices && node; ++k) {
    toml::array* array = node->as_array();
    node = array ? array->get(part.indices[k]) : nullptr;
  }
  return node;
}

void apply_override(toml::table& root, const std::string& text) {
  const std::string shown_override = one_line(text);
  const auto fail = [&](const std::string& what) { return InputError(fmt::format("--set: {}: {}", shown_override, what)); };
  const auto equals = text.find('=');
  std::string_view name = std::string_view(text).substr(0, equals);
  while (!name.empty() && name.back() == ' ') name.remove_suffix(1);
  const bool well_formed = equals != std::string::npos && !name.empty() && name.front() != '.' && name.back() != '.' &&
                           name.find("..") == std::string_view::npos && std::count(name.begin(), name.end(), '.') < 8;
  if (!well_formed) throw fail("must be key=value");
  toml::table given = override_value(std::string_view(text).substr(equals + 1), shown_override);
  const auto next_part = [&](std::string_view part) {
    const auto read = path_part(part);
    if (!read) throw fail(fmt::format("{} is neither a key nor an entry such as term[1]", one_line(part)));
    return *read;
  };
  toml::table* section = &root;
  const std::string whole(name);
  for (auto dot = name.find('.'); dot != std::string_view::npos; dot = name.find('.')) {
    const PathPart part = next_part(name.substr(0, dot));
    toml::node* next = find_part(*section, part, part.indices.size());
    if (!next && part.indices.empty()) next = &section->insert(part.key, toml::table{}).first->second;
    if (!next) throw fail(fmt::format("there is no {}", one_line(name.substr(0, dot))));
    if (!next->is_table()) throw fail(fmt::format("{} is not a section", one_line(name.substr(0, dot))));
    name.remove_prefix(dot + 1);
    section = next->as_table();
  }
  // Copied, not moved: a copy has no source line, which marks it as an override.
  const PathPart leaf = next_part(name);
  if (leaf.indices.empty()) {
    given.get("value")->visit([&](const auto& value) { section->insert_or_assign(leaf.key, value); });
    return;
  }
  toml::node* list = find_part(*section, leaf, leaf.indices.size() - 1);
  if (!list || !list->as_array() || leaf.indices.back() >= list->as_array()->size()) throw fail(fmt::format("there is no {}", one_line(name)));
  given.get("value")->visit(
      [&](const auto& value) { list->as_array()->replace(list->as_array()->cbegin() + static_cast<std::ptrdiff_t>(leaf.indices.back()), value); });
}

std::string suggestion(const std::string& name) { return name.empty() ? "" : ", did you mean " + name + "?"; }

}  // namespace

std::string toml_text(const Value& value) {
  const auto array = [](const auto& items, const auto& text) {
    std::vector<std::string> s;
    for (const auto& item : items) s.push_back(text(item));
    return fmt::format("[{}]", fmt::join(s, ", "));
  };
  return std::visit(Overloaded{[](bool b) { return std::string(b ? "true" : "false"); }, [](std::int64_t i) { return std::to_string(i); },
                               [](double x) { return number_text(x); }, [](const std::string& s) { return in_quotes(s); },
                               [&](const std::vector<double>& v) { return array(v, number_text); },
                               [&](const std::vector<std::string>& v) { return array(v, in_quotes); }},
                    value);
}

std::string Key::accepted() const {
  return std::visit(Overloaded{[](bool) { return std::string("true or false"); }, [&](std::int64_t) { return of(*this, "an integer"); },
                               [&](double) { return of(*this, "a number"); },
                               [&](const std::string&) { return of(*this, choices.empty() ? "a text in quotes" : ""); },
                               [&](const std::vector<double>&) { return array_of(*this, "numbers"); },
                               [&](const std::vector<std::string>&) { return array_of(*this, "texts"); }},
                    default_value);
}

Schema& Schema::add(Key key) {
  if (find(key.name)) throw std::invalid_argument(fmt::format("{}: key {} added twice", kind_, key.name));
  const std::string wrong = key.required || key.optional ? "" : complaint(key, key.default_value);
  if (!wrong.empty()) throw std::invalid_argument(fmt::format("{}: default of {}: {}", kind_, key.name, wrong));
  keys_.push_back(std::move(key));
  return *this;
}

Schema& Schema::add_count(std::string name, std::string description, std::int64_t value, double lower, double upper) {
  return add({.name = std::move(name),
              .description = std::move(description),
              .default_value = value,
              .lower = lower,
              .upper = upper,
              .closed_lower = true,
              .closed_upper = true});
}

Schema& Schema::add_free(FreeSection section) {
  if (find_free(section.name)) throw std::invalid_argument(fmt::format("{}: section {} added twice", kind_, section.name));
  free_sections_.push_back(std::move(section));
  return *this;
}

Schema& Schema::add_alternative(Alternative alternative) {
  for (const std::string& name : alternative.free_sections)
    if (!find_free(name)) throw std::invalid_argument(fmt::format("{}: alternative {} is no free section", kind_, name));
  alternatives_.push_back(std::move(alternative));
  return *this;
}

const Key* Schema::find(std::string_view name) const {
  const auto it = std::find_if(keys_.begin(), keys_.end(), [&](const Key& key) { return key.name == name; });
  return it == keys_.end() ? nullptr : &*it;
}

const FreeSection* Schema::find_free(std::string_view section) const {
  const auto it = std::find_if(free_sections_.begin(), free_sections_.end(), [&](const FreeSection& s) { return s.name == section; });
  return it == free_sections_.end() ? nullptr : &*it;
}

bool Schema::has_section(std::string_view section) const {
  const std::string prefix = fmt::format("{}.", section);
  const auto starts = [&](const auto& entry) { return entry.name.starts_with(prefix); };
  return std::any_of(keys_.begin(), keys_.end(), starts) || std::any_of(free_sections_.begin(), free_sections_.end(), starts);
}

std::string Schema::nearest(std::string_view name) const {
  std::string section = section_of(name);
  if (!section.empty() && !has_section(section)) section = nearest_section(section);
  std::vector<std::string> siblings;
  if (section.empty()) siblings.push_back("study");
  for (const Key& key : keys_)
    if (section_of(key.name) == section) siblings.push_back(leaf_of(key.name));
  if (const std::string leaf = studies::nearest(leaf_of(name), siblings); !leaf.empty()) return join(section, leaf);
  for (const Key& key : keys_)  // the right key in the wrong section
    if (leaf_of(key.name) == leaf_of(name)) return key.name;
  return "";
}

std::string Schema::nearest_section(std::string_view section) const {
  std::vector<std::string> sections;
  for (const Key& key : keys_) sections.push_back(section_of(key.name));
  for (const FreeSection& s : free_sections_) sections.push_back(s.name);
  return studies::nearest(section, sections);
}

std::string nearest(std::string_view name, const std::vector<std::string>& candidates) {
  if (name.size() > 100) return "";
  std::string best;
  std::size_t least = std::max<std::size_t>(1, (name.size() + 1) / 3) + 1;
  for (const std::string& candidate : candidates)
    if (const std::size_t d = distance(name, candidate); d < least && !candidate.empty()) {
      least = d;
      best = candidate;
    }
  return best;
}

void append_fields(Schema& schema, const std::function<bool(std::string_view)>& wanted) {
  const models::StayParameters<double> record{};
  models::fields(record, [&](const models::Field& field, const double&) {
    if (wanted && !wanted(field.name)) return;
    schema.add({.name = std::string(field.name),
                .unit = std::string(field.unit),
                .description = std::string(field.description),
                .default_value = field.default_value,
                .required = std::isnan(field.default_value),
                .lower = field.lower,
                .upper = field.upper,
                .closed_lower = field.closed_lower,
                .closed_upper = field.closed_lower,  // both ends, see models::Field
                .example = std::isnan(field.default_value) ? std::optional<Value>(field.example) : std::nullopt});
  });
}

models::StayParameters<double> stay_parameters(const Configuration& configuration, const models::StayParameters<double>& initial) {
  models::StayParameters<double> record = initial;
  models::fields(record, [&](const models::Field& field, double& entry) {
    if (configuration.has(field.name)) entry = configuration.number(field.name);
  });
  return record;
}

std::string example_toml(const Schema& schema) {
  std::string text = fmt::format("# {}\nstudy = {}\n", schema.summary(), in_quotes(schema.kind()));
  std::vector<std::string> sections{""};
  for (const Key& key : schema.keys())
    if (const std::string s = section_of(key.name); std::find(sections.begin(), sections.end(), s) == sections.end()) sections.push_back(s);
  for (const std::string& section : sections) {
    if (!section.empty()) text += fmt::format("\n[{}]\n", section);
    for (const Key& key : schema.keys()) {
      if (section_of(key.name) != section) continue;
      const std::string role = key.required ? "required" : key.optional ? "optional" : "default " + toml_text(key.default_value);
      const bool commented = (key.optional && !key.suggested) || (key.required && !key.example);
      const std::string value = key.example ? toml_text(*key.example) : key.required || key.optional ? "" : toml_text(key.default_value);
      text += fmt::format("# {}: {}; {}\n{}{} ={}{}\n", key.description, key.accepted(), role, commented ? "# " : "", leaf_of(key.name),
                          value.empty() ? "" : " ", value);
    }
  }
  for (const FreeSection& section : schema.free_sections()) {
    text += fmt::format("\n# [{}] {}; {}\n", section.name, section.description, section.required ? "required" : "optional");
    std::istringstream lines(section.example);
    for (std::string line; std::getline(lines, line);) text += fmt::format("# {}\n", line);
  }
  return text;
}

/// Walks the parsed file once, checks every node against the schema and collects the values.
class Configuration::Reader {
 public:
  Reader(Configuration& into, const toml::table& root) : into_(into), root_(root) {}

  void read() {
    visit_table(root_, "");
    check_alternatives();
    for (const Key& key : into_.schema_.keys()) {
      if (into_.values_.contains(key.name) || !replaced_by(key).empty()) continue;
      if (key.required) missing(key.name, "must be " + key.accepted() + instead_of(key));
      if (!key.optional) into_.values_[key.name] = key.default_value;
    }
    for (const FreeSection& section : into_.schema_.free_sections())
      if (section.required && !into_.raw_.contains(section.name)) missing("[" + section.name + "]", section.description);
  }

 private:
  const Schema& schema() const { return into_.schema_; }

  /// The free section present that stands in for the key's section; "" if none.
  std::string replaced_by(const Key& key) const {
    for (const Alternative& a : schema().alternatives())
      if (std::find(a.sections.begin(), a.sections.end(), section_of(key.name)) != a.sections.end())
        for (const std::string& name : a.free_sections)
          if (into_.raw_.contains(name)) return name;
    return "";
  }

  /// "; or give [modal_model]" for a key that another section may stand in for.
  std::string instead_of(const Key& key) const {
    std::vector<std::string> others;
    for (const Alternative& a : schema().alternatives())
      if (std::find(a.sections.begin(), a.sections.end(), section_of(key.name)) != a.sections.end())
        others.insert(others.end(), a.free_sections.begin(), a.free_sections.end());
    return others.empty() ? "" : fmt::format("; or give [{}] in place of [{}]", fmt::join(others, "] or ["), section_of(key.name));
  }

  void check_alternatives() const {
    std::string present;
    for (const Alternative& a : schema().alternatives())
      for (const std::string& name : a.free_sections) {
        if (!into_.raw_.contains(name) || name == present) continue;
        if (!present.empty()) throw InputError(fmt::format("{}: [{}]: is not taken beside [{}]", into_.place(name), name, present));
        present = name;
      }
    for (const Key& key : schema().keys())
      if (into_.values_.contains(key.name) && !replaced_by(key).empty())
        throw into_.error(key.name, fmt::format("is not taken beside [{}]", replaced_by(key)));
  }

  void visit_table(const toml::table& table, const std::string& section) {
    for (const auto& [key, node] : table) {
      const std::string name = join(section, key.str());
      into_.lines_[name] = static_cast<int>(node.source().begin.line);
      if (key.str().find('.') != std::string_view::npos)
        throw InputError(fmt::format("{}: \"{}\": a key must not contain a dot", into_.place(name), name));
      if (name == "study") continue;
      if (schema().find_free(name)) keep_raw(name, node);
      else if (const Key* known = schema().find(name)) into_.values_[name] = checked(*known, node);
      else if (schema().has_section(name) && node.is_table()) visit_table(*node.as_table(), name);
      else unknown(name, node);
    }
  }

  Value checked(const Key& key, const toml::node& node) {
    const auto fail = [&](const std::string& what) {
      return InputError(fmt::format("{}: {} = {}: {}", into_.place(key.name), key.name, shown(node), what));
    };
    const std::optional<Value> value = typed(node, key.default_value);
    if (!value) throw fail("must be " + key.accepted());
    if (const std::string wrong = complaint(key, *value); !wrong.empty()) throw fail(wrong);
    return *value;
  }

  void keep_raw(const std::string& name, const toml::node& node) {
    if (!node.is_table() && !node.is_array_of_tables())
      throw InputError(fmt::format("{}: {} = {}: must be a section", into_.place(name), name, shown(node)));
    note_lines(name, node, 0);
    std::ostringstream contents, document;
    const auto table = [](const std::string& key, const toml::node& value) {
      toml::table t;
      value.visit([&](const auto& v) { t.insert(key, v); });
      if (toml::table* section = t[key].as_table()) section->is_inline(false);  // however it was written
      return t;
    };
    toml::table whole = table(leaf_of(name), node);
    if (node.is_table()) contents << *whole[leaf_of(name)].as_table();
    else contents << whole;
    for (std::string section = section_of(name); !section.empty(); section = section_of(section)) whole = table(leaf_of(section), whole);
    document << whole;
    into_.raw_[name] = {contents.str(), document.str()};
  }

  void note_lines(const std::string& name, const toml::node& node, std::size_t depth) {
    into_.lines_[name] = static_cast<int>(node.source().begin.line);
    if (depth > max_depth) throw InputError(fmt::format("{}: sections nested too deeply", into_.place(name)));
    if (const toml::table* table = node.as_table())
      for (const auto& [key, child] : *table) note_lines(join(name, key.str()), child, depth + 1);
    if (const toml::array* array = node.as_array())
      for (std::size_t i = 0; i < array->size(); ++i) note_lines(fmt::format("{}[{}]", name, i), (*array)[i], depth + 1);
  }

  [[noreturn]] void unknown(const std::string& name, const toml::node& node) const {
    const std::string place = into_.place(name);
    if (node.is_table()) {
      const std::string near = schema().nearest_section(name);
      throw InputError(fmt::format("{}: [{}]: unknown section{}", place, one_line(name), near.empty() ? others("") : suggestion("[" + near + "]")));
    }
    const std::string near = schema().nearest(name);
    const std::string what =
        schema().has_section(name) ? "must be a section" : "unknown key" + (near.empty() ? others(section_of(name)) : suggestion(near));
    throw InputError(fmt::format("{}: {} = {}: {}", place, one_line(name), shown(node), what));
  }

  /// "; [cable] takes chord_length, ..." or, for the top level, "; the sections are ..."
  std::string others(const std::string& section) const {
    std::vector<std::string> names;
    for (const Key& key : schema().keys()) {
      const std::string parent = section_of(key.name);
      const std::string name = section.empty() && !parent.empty() ? "[" + parent + "]" : leaf_of(key.name);
      if ((section.empty() || parent == section) && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    if (section.empty())
      for (const FreeSection& free : schema().free_sections()) names.push_back("[" + free.name + "]");
    return fmt::format("; {} takes {}", section.empty() ? "this study" : "[" + section + "]", fmt::join(names, ", "));
  }

  [[noreturn]] void missing(const std::string& name, const std::string& what) const {
    const std::string section = section_of(name);  // its header is the best place to point at
    throw InputError(fmt::format("{}: {} is missing: {}", into_.lines_.contains(section) ? into_.place(section) : into_.source_, name, what));
  }

  Configuration& into_;
  const toml::table& root_;
};

Configuration Configuration::from_file(const std::filesystem::path& path, std::span<const Schema> schemas, const Overrides& overrides) {
  return from_text(read_file(path), path.string(), schemas, overrides);
}

Configuration Configuration::from_text(std::string_view text, std::string source, std::span<const Schema> schemas, const Overrides& overrides) {
  toml::table root = parse(text, source);
  for (const std::string& entry : overrides) apply_override(root, entry);

  std::vector<std::string> kinds;
  for (const Schema& schema : schemas) kinds.push_back(schema.kind());
  const toml::node* study = root.get("study");
  if (!study) throw InputError(fmt::format("{}: study is missing: must be one of {}", source, quoted_list(kinds)));
  const int line = static_cast<int>(study->source().begin.line);
  const std::string place = line > 0 ? fmt::format("{}:{}", source, line) : "--set";
  const auto kind = study->value_exact<std::string>();
  if (!kind) throw InputError(fmt::format("{}: study = {}: must be one of {}", place, shown(*study), quoted_list(kinds)));
  const auto schema = std::find_if(schemas.begin(), schemas.end(), [&](const Schema& s) { return s.kind() == *kind; });
  if (schema == schemas.end()) {
    const std::string near = nearest(*kind, kinds);
    throw InputError(fmt::format("{}: study = {}: unknown kind{}", place, shown(*study),
                                 near.empty() ? ", must be one of " + quoted_list(kinds) : suggestion(in_quotes(near))));
  }
  Configuration result(*schema);
  result.source_ = std::move(source);
  Reader(result, root).read();
  return result;
}

const Value& Configuration::value(std::string_view name) const {
  const auto it = values_.find(name);
  if (it == values_.end()) throw std::invalid_argument(fmt::format("{} study: no value for key {}", kind(), name));
  return it->second;
}

namespace {
template <class T>
const T& as(const Value& value, std::string_view name) {
  if (const T* x = std::get_if<T>(&value)) return *x;
  throw std::invalid_argument(fmt::format("key {} is of another type", name));
}
}  // namespace

double Configuration::number(std::string_view name) const {
  const Value& v = value(name);
  return std::holds_alternative<std::int64_t>(v) ? static_cast<double>(std::get<std::int64_t>(v)) : as<double>(v, name);
}
std::int64_t Configuration::integer(std::string_view name) const { return as<std::int64_t>(value(name), name); }
bool Configuration::flag(std::string_view name) const { return as<bool>(value(name), name); }
const std::string& Configuration::text(std::string_view name) const { return as<std::string>(value(name), name); }
const std::vector<double>& Configuration::numbers(std::string_view name) const { return as<std::vector<double>>(value(name), name); }
const std::vector<std::string>& Configuration::texts(std::string_view name) const { return as<std::vector<std::string>>(value(name), name); }

bool Configuration::has(std::string_view name) const { return values_.contains(name) || raw_.contains(name); }
bool Configuration::is_given(std::string_view name) const { return lines_.contains(name); }

std::string Configuration::raw(std::string_view section) const {
  const auto it = raw_.find(section);
  return it == raw_.end() ? "" : it->second.contents;
}

int Configuration::raw_line(std::string_view section) const {
  const auto it = lines_.find(section);
  return it == lines_.end() || !raw_.contains(section) ? 0 : it->second;
}

std::string Configuration::place(std::string_view name) const {
  const auto it = lines_.find(name);
  if (it == lines_.end()) return source_;
  return it->second > 0 ? fmt::format("{}:{}", source_, it->second) : "--set";
}

InputError Configuration::error(std::string_view name, std::string_view what) const {
  const auto it = values_.find(name);
  return InputError(fmt::format("{}: {}{}: {}", place(name), name, it == values_.end() ? "" : " = " + one_line(toml_text(it->second)), what));
}

std::string Configuration::resolved_toml() const {
  std::string top = fmt::format("study = {}\n", in_quotes(kind()));
  std::vector<std::pair<std::string, std::string>> sections;
  each([&](const Key& key, const Value& value) {
    const std::string line = fmt::format("{} = {}\n", leaf_of(key.name), toml_text(value)), section = section_of(key.name);
    if (section.empty()) {
      top += line;
      return;
    }
    auto it = std::find_if(sections.begin(), sections.end(), [&](const auto& s) { return s.first == section; });
    if (it == sections.end()) it = sections.insert(sections.end(), {section, ""});
    it->second += line;
  });
  for (const auto& [section, lines] : sections) top += fmt::format("\n[{}]\n{}", section, lines);
  for (const auto& [name, raw] : raw_) top += fmt::format("\n{}\n", raw.document);
  return top;
}

}  // namespace whirl::studies
