// Short waves on a level cable: the asymptotic frequencies against the spectral solver, and its order.
#include <cmath>

#include "models/catenary/asymptotic.hpp"
#include "tests/models/catenary/reference.hpp"

using namespace catenary_test;

TEST_CASE("catenary asymptotic: the error falls as the fourth power of the mode") {
  for (const double m : {0.1, 0.5, 1.0, 1.5, 2.2}) {
    const ModeSet set = in_plane_modes(core(unit_geometry(m, 0.0)), {.count = 32, .shapes = false});
    REQUIRE(set.complete());
    const auto error = [&](int mode) { return std::abs(asymptotic_frequency(m, mode).value() / set.modes[std::size_t(mode) - 1].omega - 1.0); };
    INFO("b/2a " << m);
    for (const int first : {9, 10}) {  // antisymmetric and symmetric
      const double order = std::log(error(first) / error(first + 22)) / std::log((first + 22.0) / first);
      CHECK(order > 3.4);  // 4 in the limit; a first-order formula has 2
      CHECK(order < 5.0);
    }
    CHECK(error(31) < 3e-6);
  }
}

TEST_CASE("catenary asymptotic: shallow limit and deep cables") {
  const double m = 1e-3;
  double root = 4.49340945790906;                                               // tan z = z
  CHECK(asymptotic_frequency(m, 2).value() * m == Approx(root).epsilon(1e-6));  // of order m^2
  CHECK(asymptotic_frequency(m, 1).value() * m == Approx(3.14159265358979324).epsilon(1e-6));
  CHECK_FALSE(asymptotic_frequency(3.5, 1).has_value());  // the first mode of a deep cable is no short wave
  const ModeSet deep = in_plane_modes(core(unit_geometry(1.5, 0.0)), {.count = 5});
  CHECK(asymptotic_frequency(1.5, 1).value() == Approx(deep.modes[0].omega).epsilon(0.02));
  CHECK(asymptotic_frequency(1.5, 5).value() == Approx(deep.modes[4].omega).epsilon(1.5e-4));
  CHECK_THROWS_AS(asymptotic_frequency(0.0, 1), std::invalid_argument);
  CHECK_THROWS_AS(asymptotic_frequency(1.0, 0), std::invalid_argument);
}
