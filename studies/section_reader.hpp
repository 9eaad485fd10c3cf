#pragma once
/// Typed access to a free section of a study file (Schema::add_free) and its arrays of tables; whatever is wrong is one line with its place.
///
///     SectionReader m(configuration, "modal_model");
///     auto frequency = m.numbers("frequency");                  // InputError: "my.toml:4: modal_model.frequency = \"a\": must be an array of
///     numbers" for (const auto& t : m.tables("term")) t.integer("equation", 1, n); m.no_others();                                            //
///     every key was asked for

#include <memory>
#include <set>

#include "studies/configuration.hpp"

namespace whirl::studies {

class SectionReader {
 public:
  SectionReader(const Configuration& c, const std::string& section);

  bool has(const std::string& key) const;  ///< counts as asked for
  /// Without a fallback the key is required.
  double number(const std::string& key, std::optional<double> fallback = std::nullopt) const;
  std::int64_t integer(const std::string& key, std::int64_t lower, std::int64_t upper, std::optional<std::int64_t> fallback = std::nullopt) const;
  std::string text(const std::string& key, std::optional<std::string> fallback = std::nullopt) const;
  std::vector<double> numbers(const std::string& key, std::optional<std::vector<double>> fallback = std::nullopt) const;
  std::vector<int> integers(const std::string& key) const;
  std::vector<std::string> texts(const std::string& key) const;
  std::vector<std::string> text_or_texts(const std::string& key) const;
  std::vector<std::vector<double>> rows(const std::string& key) const;                                      ///< an array of arrays of numbers
  std::vector<std::vector<std::string>> text_rows(const std::string& key) const;                            ///< an array of arrays of texts
  std::vector<std::pair<std::string, double>> named_numbers(const std::string& key) const;                  ///< a table of numbers, by name
  std::vector<std::pair<std::string, std::vector<std::string>>> named_texts(const std::string& key) const;  ///< a table of arrays of texts
  std::vector<SectionReader> tables(const std::string& key) const;                                          ///< [[section.key]], none if absent
  std::vector<std::string> others() const;                                                                  ///< keys that were not asked for
  void no_others() const;                                                                                   ///< InputError if there are any

  InputError error(const std::string& key, const std::string& what) const;  ///< "file:line: section.key = value: what"
  InputError error(const std::string& what) const;                          ///< about the whole section

 private:
  struct Node;
  SectionReader(const Configuration& c, std::string place, std::string name, std::shared_ptr<const Node> node)
      : configuration_(&c), place_(std::move(place)), name_(std::move(name)), node_(std::move(node)) {}
  template <class Read>
  auto array(const std::string& key, const char* wanted, Read&& read) const;

  const Configuration* configuration_;
  std::string place_, name_;  // as the configuration and as a reader counts: from 0 and from 1
  std::shared_ptr<const Node> node_;
  std::shared_ptr<std::set<std::string>> asked_ = std::make_shared<std::set<std::string>>();
};

}  // namespace whirl::studies
