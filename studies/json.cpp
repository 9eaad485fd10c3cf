#include "studies/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace whirl::studies {
namespace {

// Bytes of the UTF-8 sequence that begins here; 0 if there is none [RFC 3629, section 4].
std::size_t sequence_at(std::string_view s, std::size_t i) {
  const auto byte = [&](std::size_t k) { return i + k < s.size() ? static_cast<unsigned char>(s[i + k]) : 0U; };
  const auto continues = [&](std::size_t k) { return (byte(k) & 0xC0U) == 0x80U; };
  const unsigned first = byte(0), second = byte(1);
  if (first < 0x80U) return 1;
  if (first >= 0xC2U && first <= 0xDFU) return continues(1) ? 2 : 0;
  if (first >= 0xE0U && first <= 0xEFU) {
    const bool overlong = first == 0xE0U && second < 0xA0U, surrogate = first == 0xEDU && second > 0x9FU;
    return continues(1) && continues(2) && !overlong && !surrogate ? 3 : 0;
  }
  if (first >= 0xF0U && first <= 0xF4U) {
    const bool overlong = first == 0xF0U && second < 0x90U, beyond = first == 0xF4U && second > 0x8FU;
    return continues(1) && continues(2) && continues(3) && !overlong && !beyond ? 4 : 0;
  }
  return 0;
}

std::string quoted(std::string_view s) {
  std::string out = "\"";
  for (std::size_t i = 0; i < s.size();) {
    const char c = s[i];
    const std::size_t length = sequence_at(s, i);
    if (c == '"' || c == '\\') (out += '\\') += c;
    else if (static_cast<unsigned char>(c) < 0x20U || c == 0x7F) out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else if (length == 0) out += "\\ufffd";
    else out += s.substr(i, length);
    i += std::max<std::size_t>(length, 1);
  }
  return out + '"';
}

}  // namespace

Json::Json(bool value) : scalar_(value ? "true" : "false") {}
Json::Json(double value) : scalar_(std::isfinite(value) ? fmt::format("{}", value) : "null") {}
Json::Json(std::string_view text) : scalar_(quoted(text)) {}

Json Json::array(const std::vector<double>& values) {
  Json all = array();
  for (const double value : values) all.add(value);
  return all;
}

Json Json::array(const std::vector<std::string>& values) {
  Json all = array();
  for (const auto& value : values) all.add(value);
  return all;
}

bool Json::has(std::string_view key) const {
  return std::any_of(members_.begin(), members_.end(), [&](const auto& member) { return member.first == key; });
}

Json& Json::put(std::string_view key, Json value) {
  if (kind_ != Kind::object) throw std::logic_error("only a JSON object has keys");
  if (has(key)) throw std::logic_error(fmt::format("JSON key '{}' put twice", key));
  members_.emplace_back(std::string(key), std::move(value));
  return *this;
}

Json& Json::add(Json value) {
  if (kind_ != Kind::array) throw std::logic_error("only a JSON array is added to");
  members_.emplace_back(std::string(), std::move(value));
  return *this;
}

void Json::append(std::string& out, int depth) const {
  if (kind_ == Kind::scalar) {
    out += scalar_;
    return;
  }
  const bool object = kind_ == Kind::object;
  const auto holds = [](const auto& member) { return member.second.kind_ != Kind::scalar; };
  const bool lines = depth == 0 || (depth == 1 && !object && std::any_of(members_.begin(), members_.end(), holds));
  const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
  out += object ? '{' : '[';
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (i > 0) out += lines ? "," : ", ";
    if (lines) out += "\n  " + indent;
    if (object) out += quoted(members_[i].first) + ": ";
    members_[i].second.append(out, depth + 1);
  }
  if (lines) out += "\n" + indent;
  out += object ? '}' : ']';
}

std::string Json::text() const {
  std::string out;
  append(out, 0);
  return out + '\n';
}

}  // namespace whirl::studies
