#pragma once
/// What input that is refused is told: one line.
#include <catch2/catch.hpp>

#include "studies/configuration.hpp"

namespace whirl::studies::tests {

/// The message of the InputError that `run` throws; "accepted" if it throws none.
template <class Run>
std::string message(Run&& run) {
  try {
    run();
  } catch (const InputError& e) {
    CHECK(std::string(e.what()).find('\n') == std::string::npos);
    return e.what();
  }
  return "accepted";
}

/// `text` with its first `what` replaced.
inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

}  // namespace whirl::studies::tests
