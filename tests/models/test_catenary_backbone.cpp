// Amplitude dependence of the swing out of plane: taut limit, stiff limit, and a chain of masses and springs integrated in time.
#include <cmath>

#include "models/catenary/backbone.hpp"
#include "tests/models/catenary/chain.hpp"
#include "tests/models/catenary/reference.hpp"

using namespace catenary_test;

TEST_CASE("catenary backbone: taut string under uniform tension") {
  const double m = 1e-3, kappa = 1e-3, p = 3.14159265358979324 / (2.0 * m);
  // omega^2 = p^2 + 3 A^2 (p^2 m/2)^2 / (4 m kappa) / m with kappa c^2 -> 0; lambda^2 = 8e-6: sag counts for 1e-4 of it, axial inertia for 4 kappa/12
  const Backbone b = lateral_backbone(core(unit_geometry(m, 0.0), kappa), 1);
  const double uniform = 3.0 * std::pow(0.5 * p * p * m, 2) / (4.0 * m * kappa) / (2.0 * p * p * m);
  CHECK(b.curvature == Approx(uniform).epsilon(3e-3));
  CHECK(b.direct == Approx(1.5 * uniform).epsilon(3e-3));  // mean cos^4 over the square of mean cos^2
}

TEST_CASE("catenary backbone: finite for a stiff cable, where projection on the mode alone is not") {
  const Geometry g = unit_geometry(1.0, 0.5);
  const Backbone soft = lateral_backbone(core(g, 1e-5), 1), stiff = lateral_backbone(core(g, 1e-7), 1);
  CHECK(stiff.curvature == Approx(soft.curvature).epsilon(1e-3));
  CHECK(stiff.curvature < 0.0);  // a deep cable swings like a pendulum: softer
  CHECK(stiff.direct > 1e5 * std::abs(stiff.curvature));
  CHECK_THROWS_AS(lateral_backbone(core(g), 1), std::invalid_argument);
}

TEST_CASE("catenary backbone: a chain of masses swings as predicted", "[slow]") {
  for (const auto& [m, h] : {std::pair{1.0, 0.0}, {0.8, 0.6}}) {
    const double kappa = 5e-3;
    const Geometry g = unit_geometry(m, h);
    const Backbone b = lateral_backbone(core(g, kappa), 1);
    const Mode swing = out_of_plane_modes(core(g, kappa), {.count = 1}).modes[0];
    const Chain chain(g, kappa, 60);
    const auto shape = chain.displaced([&](double x) { return std::array{0.0, 0.0, swing.field.at(x, Quantity::W)}; });
    const auto frequency = [&](double A) {
      return chain.frequency(shape, chain.displaced([&](double x) {
        const auto follow = [&](Quantity quantity) { return A * A * (b.steady.at(x, quantity) + b.twice.at(x, quantity)); };
        return std::array{follow(Quantity::U), follow(Quantity::V), A * swing.field.at(x, Quantity::W)};
      }),
                             40);
    };
    const double small = 0.02, base = frequency(small);
    const auto curvature = [&](double A) { return (frequency(A) / base - 1.0) / (A * A - small * small); };
    // The curvature measured at an amplitude differs from that at rest by its square; two amplitudes take that out.
    const double A = 0.06, larger = 0.1, at = curvature(A), measured = at - (curvature(larger) - at) * A * A / (larger * larger - A * A);
    INFO("m " << m << " h " << h << " predicted " << b.curvature << " measured " << measured << " direct " << b.direct);
    CHECK(measured == Approx(b.curvature).epsilon(0.01));  // 60 sides: 2e-3 of it, and the fourth power of the amplitude
  }
}
