// The series method beside the spectral solver: agreement where it is valid, refusal where it is not.
#include "models/catenary/gale_series.hpp"
#include "tests/models/catenary/reference.hpp"

using namespace catenary_test;

TEST_CASE("catenary series: agrees with the spectral solver in its region", "[published]") {
  for (const auto& [name, plane] : {std::pair{"B3_verified", Plane::in_plane}, {"B4_verified", Plane::out_of_plane}}) {
    const Table t = table(name);
    int listed = 0, refused = 0;
    for (std::size_t i = 0; i < t.rows.size(); i += 2) {
      const Geometry g = by_sag(t(i, "sag"), t(i, "h_over_b"));
      const SeriesModes s = series_modes(g.x1, g.x2, 6, plane);
      INFO(name << " h/b " << t(i, "h_over_b") << " sag " << t(i, "sag") << " xi " << xi_of(g.x1) << " " << xi_of(g.x2));
      CHECK(s.missing == 0);
      CHECK(s.spurious == 0);
      CHECK(s.omega.size() + std::size_t(s.refused) == 6);
      for (std::size_t k = 0; k < s.omega.size();
           ++k)  // 12 digits given; rounding grown by what the sums cancelled, with two digits for the sensitivity of the root
        CHECK(std::abs(s.omega[k] / t(i, "w" + std::to_string(k + 1)) - 1.0) < 1e-11 + 2e-14 * std::pow(10.0, s.digits_lost[k]));
      CHECK(s.worst_difference() < 1e-6);
      listed += int(s.omega.size());
      refused += s.refused;
    }
    CHECK(listed > 100);
    CHECK(refused < 15);
  }
}

TEST_CASE("catenary series: digits lost by cancellation") {
  const Geometry g = by_sag(0.817, 0.0);  // xi_2 = 0.70015
  const SeriesOptions at_end{.match_in_plane = 0.71};
  CHECK(series_determinant(g.x1, g.x2, 5.0, Plane::in_plane, at_end).digits_lost == Approx(2.5).epsilon(0).margin(0.3));
  CHECK(series_determinant(g.x1, g.x2, 25.0, Plane::in_plane, at_end).digits_lost == Approx(12.0).epsilon(0).margin(0.3));
  const Geometry steep = by_sag(0.98, 1.0);
  const SeriesModes s = series_modes(steep.x1, steep.x2, 8, Plane::in_plane);
  CHECK(s.refused == 4);
  CHECK(s.omega.size() == 4);
}

TEST_CASE("catenary series: refuses what it cannot do") {
  const Geometry deep = by_sag(0.46, 0.0), edge = by_sag(0.469, 0.0);
  CHECK_THROWS_WITH(series_modes(deep.x1, deep.x2, 2, Plane::in_plane), Catch::Contains("within |xi| < 4"));
  CHECK_THROWS_WITH(series_modes(edge.x1, edge.x2, 2, Plane::in_plane, {.max_terms = 200}), Catch::Contains("does not converge in 200 terms"));
  CHECK_THROWS_WITH(series_modes(0.0, 0.3, 2, Plane::in_plane, {.match_in_plane = 1.2}), Catch::Contains("radii of convergence"));
}
