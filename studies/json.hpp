#pragma once
/// A JSON value: what `--json` prints. Members keep the order in which they were put.
///
/// The text is strictly valid [RFC 8259] whatever numbers and names it holds: what is not finite is null, quotes, backslashes and control characters
/// of a text are escaped, bytes that are no UTF-8 become U+FFFD. Numbers carry the digits that read back unchanged.
///
///     Json point = Json::object();
///     point.put("type", "LP").put("omega", 1.25);           // a key put twice throws std::logic_error: nothing is told under two meanings
///     Json all = Json::array();
///     all.add(std::move(point));

#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace whirl::studies {

class Json {
 public:
  Json() = default;  ///< null
  Json(bool value);
  Json(double value);
  template <std::integral Integer>
  requires(!std::same_as<Integer, bool>) Json(Integer value) : scalar_(std::to_string(value)) {}
  Json(std::string_view text);
  Json(const std::string& text) : Json(std::string_view(text)) {}
  Json(const char* text) : Json(std::string_view(text)) {}

  static Json array() { return Json(Kind::array); }
  static Json array(const std::vector<double>& values);
  static Json array(const std::vector<std::string>& values);
  static Json object() { return Json(Kind::object); }

  Json& put(std::string_view key, Json value);  ///< into an object
  Json& add(Json value);                        ///< to an array
  bool has(std::string_view key) const;
  std::size_t size() const { return members_.size(); }

  /// A line for each member, and for each of its members that hold others; ends with a newline.
  std::string text() const;

 private:
  enum class Kind { scalar, array, object };
  explicit Json(Kind kind) : kind_(kind) {}
  void append(std::string& out, int depth) const;

  Kind kind_ = Kind::scalar;
  std::string scalar_ = "null";  // as it is printed
  std::vector<std::pair<std::string, Json>> members_;
};

}  // namespace whirl::studies
