#pragma once
/// What a study kind accepts (`Schema`) and the values one run was given (`Configuration`).
///
/// A study file is TOML: `study = "<kind>"` and the keys of that kind. Every value is checked against the schema when it is read; bad input throws
/// `InputError`, whose message is the one line to print:
///
///     my.toml:7: cable.chord_tension = -5: must be > 0 [N]
///
/// Asking a Configuration for a key its schema lacks, or with another type, is misuse: std::invalid_argument.
///
///     Schema schema("superharmonic", "superharmonic response of a stay");
///     append_fields(schema);
///     schema.add({.name = "response.order", .description = "superharmonic order", .default_value = std::int64_t{2}, .lower = 2.0, .closed_lower =
///     true}); auto c = Configuration::from_file("my.toml", schemas, {"cable.chord_tension=5.5e6"}); double tension =
///     c.number("cable.chord_tension");

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "models/parameters.hpp"

namespace whirl::studies {

/// Bad input. The message is one line; the program prints it and ends with status 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<double>, std::vector<std::string>>;

/// The value as TOML, shortest text that reads back the same.
std::string toml_text(const Value& value);

/// One entry of a study file. Its type is the alternative `default_value` holds, also where the key has no default.
struct Key {
  std::string name = {};  ///< dotted: "cable.chord_tension"
  std::string unit = {};  ///< "" or "-" for none
  std::string description = {};
  Value default_value = 0.0;
  bool required = false;                                    ///< must be given
  bool optional = false;                                    ///< may be left without a value
  bool suggested = false;                                   ///< optional, yet filled in with its example by `whirl init`
  double lower = -std::numeric_limits<double>::infinity();  ///< of a number, and of every element of an array
  double upper = std::numeric_limits<double>::infinity();
  bool closed_lower = false, closed_upper = false;
  std::size_t min_items = 0, max_items = std::numeric_limits<std::size_t>::max();  ///< of an array
  std::vector<std::string> choices = {};                                           ///< of a string, and of every element of an array
  std::optional<Value> example = std::nullopt;                                     ///< what `whirl init` writes in place of the default

  std::string accepted() const;  ///< "a number > 0 [N]"
};

/// A part of the study file whose contents another reader checks, such as a whole modal model.
struct FreeSection {
  std::string name = {};  ///< "modal_model"
  std::string description = {};
  std::string example = {};  ///< TOML text with its [header], shown commented out
  bool required = false;
};

/// Sections that give way to a free section: a study takes a [cable] and what belongs to it, or a [modal_model].
struct Alternative {
  std::vector<std::string> sections = {};       ///< "cable", "support_motion"
  std::vector<std::string> free_sections = {};  ///< any one of them stands in for all of `sections`
};

class Schema {
 public:
  Schema(std::string kind, std::string summary) : kind_(std::move(kind)), summary_(std::move(summary)) {}

  /// Throws std::invalid_argument for a repeated name or a default outside the key's own range.
  Schema& add(Key key);
  /// A whole number from `lower` to `upper`, both among the values.
  Schema& add_count(std::string name, std::string description, std::int64_t value, double lower, double upper);
  Schema& add_free(FreeSection section);
  /// Where a free section of it is present, keys of its sections are refused, have no value and are not required.
  Schema& add_alternative(Alternative alternative);

  const std::string& kind() const { return kind_; }
  const std::string& summary() const { return summary_; }
  const std::vector<Key>& keys() const { return keys_; }
  const std::vector<FreeSection>& free_sections() const { return free_sections_; }
  const std::vector<Alternative>& alternatives() const { return alternatives_; }
  const Key* find(std::string_view name) const;                  ///< null if unknown
  const FreeSection* find_free(std::string_view section) const;  ///< null if unknown
  bool has_section(std::string_view section) const;              ///< some key's name starts with "section."
  std::string nearest(std::string_view name) const;              ///< the key a misspelt name stands for; "" if none is near
  std::string nearest_section(std::string_view section) const;

 private:
  std::string kind_, summary_;
  std::vector<Key> keys_;
  std::vector<FreeSection> free_sections_;
  std::vector<Alternative> alternatives_;
};

/// The candidate with the smallest Damerau-Levenshtein distance to `name`; "" if even that is more than a third of the name away.
std::string nearest(std::string_view name, const std::vector<std::string>& candidates);

/// Appends the physical parameters that `wanted` accepts, by default all.
void append_fields(Schema& schema, const std::function<bool(std::string_view name)>& wanted = {});

/// The commented study file `whirl init` writes: every key with unit, description, accepted range and default.
std::string example_toml(const Schema& schema);

class Configuration {
 public:
  using Overrides = std::vector<std::string>;  ///< "key=value", value in TOML; a bare word is a string

  static Configuration from_file(const std::filesystem::path& path, std::span<const Schema> schemas, const Overrides& overrides = {});
  static Configuration from_text(std::string_view text, std::string source, std::span<const Schema> schemas, const Overrides& overrides = {});

  double number(std::string_view name) const;  ///< of integers too
  std::int64_t integer(std::string_view name) const;
  bool flag(std::string_view name) const;
  const std::string& text(std::string_view name) const;
  const std::vector<double>& numbers(std::string_view name) const;
  const std::vector<std::string>& texts(std::string_view name) const;

  bool has(std::string_view name) const;       ///< a key with a value (given or default), or a free section that is present
  bool is_given(std::string_view name) const;  ///< stands in the file or among the overrides
  const std::string& kind() const { return schema_.kind(); }
  const Schema& schema() const { return schema_; }
  const std::string& source() const { return source_; }

  /// The contents of a free section as TOML text, without its own header; "" if absent.
  std::string raw(std::string_view section) const;
  int raw_line(std::string_view section) const;  ///< where it starts in the source; 0 if absent or from an override

  /// "my.toml:7" for a given key, also inside free sections ("modal_model.terms[2].power"); "--set" for an override; else the source.
  std::string place(std::string_view name) const;
  /// An error about a value that only a later check finds: "<place>: <name> = <value>: <what>".
  InputError error(std::string_view name, std::string_view what) const;

  /// The complete configuration, defaults included. Reading it again gives the same values.
  std::string resolved_toml() const;

  /// Visits (Key, Value) of every key that has a value, in the schema's order.
  template <class Visit>
  void each(Visit&& visit) const {
    for (const Key& key : schema_.keys())
      if (const auto it = values_.find(key.name); it != values_.end()) visit(key, it->second);
  }

 private:
  struct Raw {
    std::string contents, document;  ///< without and with the header
  };
  class Reader;
  explicit Configuration(Schema schema) : schema_(std::move(schema)) {}
  const Value& value(std::string_view name) const;

  Schema schema_;
  std::string source_;
  std::map<std::string, Value, std::less<>> values_;
  std::map<std::string, Raw, std::less<>> raw_;
  std::map<std::string, int, std::less<>> lines_;  ///< of everything given; 0 for overrides
};

/// The physical parameters of a study; those without a value keep `initial`.
models::StayParameters<double> stay_parameters(const Configuration& configuration, const models::StayParameters<double>& initial = {});

}  // namespace whirl::studies
