/// Branches that leave a pitchfork and come back to it: two FitzHugh-Nagumo cells coupled so that they differ. Their four folds are the images of two
/// under the exchange of the cells; where the branch closes it stands upright and has none.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/continuation/text_model.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::continuation::text_model;

namespace {

System two_cells(double coupling, double slow) {
  const auto cell = [&](const char* v, const char* w, const char* other) {
    return std::vector<std::string>{fmt::format("{0} - {0}^3/3 - {1} + I + ({2:.17g})*({3} - {0})", v, w, coupling, other),
                                    fmt::format("{2:.17g}*({0} + 0.7 - 0.8*{1})", v, w, slow)};
  };
  const auto first = cell("v", "w", "x"), second = cell("x", "y", "v");
  return {{"v", "w", "x", "y"}, {first[0], first[1], second[0], second[1]}, {{"I", -1.0}}};
}

}  // namespace

TEST_CASE("a branch that closes at the pitchfork it left has no fold there and counts on") {
  for (const double coupling : {-0.5, -0.2})
    for (const double slow : {0.08, 0.2, 0.5}) {
      CAPTURE(coupling, slow);
      const auto all = branches(two_cells(coupling, slow), "I", -1.0, 3.0, {{-1.5, -1.0, -1.5, -1.0, -1.0}});
      CHECK(sound(all));
      REQUIRE(all.size() == 2);
      CHECK(all[1].stop_reason == StopReason::closed_loop);
      const auto pitchforks = values({all[0]}, EventType::branch_point), folds = values({all[1]}, EventType::fold);
      REQUIRE(pitchforks.size() == 2);
      REQUIRE(folds.size() == 4);
      CHECK(folds[0] == Approx(folds[1]).epsilon(1e-9));
      CHECK(folds[2] == Approx(folds[3]).epsilon(1e-9));
      for (const double fold : folds)
        for (const double at : pitchforks) CHECK(std::abs(fold - at) > 1e-3);
      for (const auto& b : all)
        for (std::size_t i = 0; i + 1 < b.special.size(); ++i) CHECK(b.special[i].unstable_after == b.special[i + 1].unstable_before);
    }
}
