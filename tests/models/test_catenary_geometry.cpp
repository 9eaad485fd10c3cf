// Catenary shapes: printed tables, every sufficient set, refusals.
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "tests/models/catenary/reference.hpp"

using namespace catenary_test;

TEST_CASE("catenary: Tables A-1 and A-4", "[published]") {
  const Table printed = table("A1_printed"), a1 = table("A1_verified");
  REQUIRE(printed.rows.size() == a1.rows.size());
  for (std::size_t i = 1; i < a1.rows.size(); ++i) {  // row 0 is the limit
    const double m = half_width_of(a1(i, "sag"));
    CHECK(0.5 / m == Approx(a1(i, "a_over_b_true")).epsilon(1e-11));                     // 12 digits given
    CHECK(0.5 / m == Approx(printed(i, "a_over_b")).epsilon(0).margin(0.5e-5 * 1.001));  // as printed, to 5 decimals: all hold
  }
  const Table a4 = table("A4_verified");
  for (std::size_t i = 0; i < a4.rows.size(); ++i) {
    const double h = a4(i, "h_over_b");
    const Geometry g = unit_geometry(half_width_reaching(a4(i, "xi2"), h), h);
    CHECK(xi_of(g.x2) == Approx(4.0).epsilon(1e-12));
    CHECK(xi_of(g.x1) == Approx(a4(i, "xi1_true")).epsilon(1e-9));  // 10 digits given
    CHECK(0.5 / g.m == Approx(a4(i, "a_over_b_true")).epsilon(1e-9));
    CHECK(g.sag_parameter() == Approx(a4(i, "sag_min_true")).epsilon(1e-9));
    CHECK(xi_of(g.x1) == Approx(a4(i, "xi1_printed")).epsilon(0).margin(0.5e-3 * 1.001));
    CHECK(g.sag_parameter() == Approx(a4(i, "sag_min_printed")).epsilon(0).margin(0.5e-3 * 1.001));
  }
  CHECK_THROWS_WITH(half_width_reaching(4.0, 5.0), Catch::Contains("the chord alone is steeper"));
}

TEST_CASE("catenary: every sufficient set gives the same cable") {
  for (const double height : {0.0, 30.0, 250.0})
    for (const double length_ratio : {1.0001, 1.05, 2.5}) {
      const double weight = 98.1, span = 100.0, length = length_ratio * std::hypot(span, height);
      const Geometry g = geometry({.span = span, .height = height, .length = length});
      INFO("height " << height << " length " << length << " m " << g.m);
      // The catenary by its definition: arc length, height and tension balance.
      CHECK(g.a * (std::sinh(g.x2) - std::sinh(g.x1)) == Approx(length).epsilon(1e-12));
      CHECK(g.a * (std::cosh(g.x2) - std::cosh(g.x1)) == Approx(height).epsilon(1e-12).margin(1e-10));
      CHECK(g.a * (g.x2 - g.x1) == Approx(span).epsilon(1e-14));
      CHECK(0.5 * g.a * (std::cosh(g.x1) + std::cosh(g.x2)) - g.a * std::cosh(g.x_m) == Approx(g.sag).epsilon(1e-8));
      const double H = weight * g.a, f = g.sag;
      std::vector<Geometry> same = {
          geometry({.span = span, .height = height, .sag = f}),
          geometry({.span = span, .height = height, .horizontal_tension = H, .weight_per_length = weight}),
          geometry({.height = height, .length = length, .sag = f}),
          geometry({.height = height, .length = length, .horizontal_tension = H, .weight_per_length = weight}),
          geometry({.height = height, .sag = f, .horizontal_tension = H, .weight_per_length = weight}),
      };
      if (height > 0.0) {  // at h = 0 these ask for the square root of a rounding error
        same.push_back(geometry({.span = span, .length = length, .sag = f}));
        same.push_back(geometry({.span = span, .length = length, .horizontal_tension = H, .weight_per_length = weight}));
        same.push_back(geometry({.span = span, .sag = f, .horizontal_tension = H, .weight_per_length = weight}));
        same.push_back(geometry({.length = length, .sag = f, .horizontal_tension = H, .weight_per_length = weight}));
      }
      if (length_ratio < 2.0)  // the taut one of two
        same.push_back(geometry({.span = span, .height = height, .upper_tension = H * std::cosh(g.x2), .weight_per_length = weight}));
      for (const Geometry& k : same) {
        CHECK(k.m == Approx(g.m).epsilon(1e-9));  // ill-conditioned where the cable is nearly its chord: (l/chord - 1)/eps
        CHECK(k.x_m == Approx(g.x_m).epsilon(1e-8).margin(1e-7));
        CHECK(k.span == Approx(span).epsilon(1e-8));
        CHECK(k.length == Approx(length).epsilon(1e-8));
      }
    }
}

TEST_CASE("catenary: the tension at the upper end with any two of the others") {
  const double weight = 98.1;
  for (const double height : {20.0, 90.0})
    for (const double length : {140.0, 200.0}) {
      const Geometry g = geometry({.span = 100.0, .height = height, .length = length});
      const double tension = weight * g.a * std::cosh(g.x2);
      const GeometryInput pairs[] = {{.span = 100.0, .length = length},
                                     {.span = 100.0, .sag = g.sag},
                                     {.height = height, .length = length},
                                     {.height = height, .sag = g.sag},
                                     {.length = length, .sag = g.sag}};
      for (GeometryInput in : pairs) {
        in.upper_tension = tension;
        in.weight_per_length = weight;
        const Geometry k = geometry(in);
        INFO("height " << height << " length " << length << " span " << k.span << " height " << k.height << " sag " << k.sag);
        CHECK(weight * k.a * std::cosh(k.x2) == Approx(tension).epsilon(1e-11));
        if (in.span) CHECK(k.span == Approx(*in.span).epsilon(1e-9));
        if (in.height) CHECK(k.height == Approx(*in.height).epsilon(1e-9));
        if (in.length) CHECK(k.length == Approx(*in.length).epsilon(1e-9));
        if (in.sag) CHECK(k.sag == Approx(*in.sag).epsilon(1e-9));
        CHECK(k.a > g.a * (1.0 - 1e-9));  // this cable, or a tauter one with the same three
      }
    }
}

TEST_CASE("catenary: a level cable is read from numbers that stand at the limit of what can be, to their last digit") {
  // Three numbers of a level cable without its height: span, length, sag and a tension. The height goes with the root of the distance from the
  // limit, so that 1e-16 would become 1e-8 of the length.
  const double weight = 7.3;
  const auto printed = [](double x, int digits) { return std::stod(fmt::format("{:.{}g}", x, digits)); };
  for (const double a : {3.1, 123.456, 2711.3})
    for (const double m : {0.01, 0.125, 0.7, 1.9, 3.0})
      for (const int digits : {17, 14, 12}) {
        const double b = 2.0 * a * m, l = 2.0 * a * std::sinh(m), f = 2.0 * a * std::sinh(0.5 * m) * std::sinh(0.5 * m);
        const double B = printed(b, digits), L = printed(l, digits), F = printed(f, digits), H = printed(weight * a, digits),
                     T = printed(weight * a * std::cosh(m), digits);
        const GeometryInput triples[] = {{.span = B, .length = L, .sag = F},
                                         {.span = B, .length = L, .horizontal_tension = H},
                                         {.span = B, .sag = F, .horizontal_tension = H},
                                         {.length = L, .sag = F, .horizontal_tension = H},
                                         {.span = B, .length = L, .upper_tension = T},
                                         {.span = B, .sag = F, .upper_tension = T},
                                         {.length = L, .sag = F, .upper_tension = T},
                                         {.height = 0.0, .length = L, .upper_tension = T},
                                         {.height = 0.0, .sag = F, .upper_tension = T}};
        int which = 0;
        for (GeometryInput in : triples) {
          in.weight_per_length = weight;
          INFO("a " << a << " m " << m << " digits " << digits << " triple " << which++);
          Geometry g{};
          CHECK_NOTHROW(g = geometry(in));
          // Where printed digits leave a little height it is that of the digits: cosh x_m = 1 + O(10^-digits), magnified where the cable is taut.
          const double height = digits == 17 ? 1e-9 : 40.0 * std::pow(10.0, -0.5 * digits) / std::min(1.0, m * m);
          CHECK(g.height <= height * g.length);
          if (digits < 17) continue;
          const double taut = 1e-11 / std::min(1.0, m * m);  // a from l - b or from f loses the square of m
          CHECK(g.a == Approx(a).epsilon(taut));
          CHECK(g.span == Approx(b).epsilon(taut));
          CHECK(g.length == Approx(l).epsilon(taut));
          CHECK(g.a * std::cosh(g.x2) == Approx(a * std::cosh(m)).epsilon(taut));
        }
      }
  CHECK_THROWS_WITH(geometry({.span = 100.0, .length = 100.1, .horizontal_tension = 1.0, .weight_per_length = 1.0}), Catch::Contains("out of reach"));
}

TEST_CASE("catenary: what cannot hang is refused in one line") {
  const auto refusal = [](const GeometryInput& in) {
    try {
      (void)geometry(in);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK_THAT(refusal({.span = 100.0, .height = 0.0, .length = 90.0}), Catch::Contains("span 100 m is not shorter than the cable, 90 m"));
  CHECK_THAT(refusal({.span = 80.0, .height = 80.0, .length = 100.0}), Catch::Contains("height difference 80 m is beyond reach"));
  CHECK_THAT(refusal({.span = 80.0, .height = 180.0, .length = 100.0}), Catch::Contains("height difference 180 m is beyond reach"));
  CHECK_THAT(refusal({.span = 80.0, .height = 0.0, .sag = -1.0}), Catch::Contains("the sag must be > 0, got -1"));
  CHECK_THAT(refusal({.span = 80.0, .height = -1.0, .sag = 1.0}), Catch::Contains("height difference must be >= 0"));
  CHECK_THAT(refusal({.span = 80.0, .length = 100.0, .sag = 60.0}), Catch::Contains("exceeds half the length"));
  CHECK_THAT(refusal({.span = 80.0, .length = 100.0, .sag = 30.0}), Catch::Contains("out of reach"));
  CHECK_THAT(refusal({.span = 80.0, .height = 0.0}), Catch::Contains("exactly three"));
  CHECK_THAT(refusal({.span = 80.0, .height = 0.0, .length = 90.0, .sag = 1.0}), Catch::Contains("exactly three"));
  CHECK_THAT(refusal({.span = 80.0, .height = 0.0, .horizontal_tension = 1.0}), Catch::Contains("weight per length"));
  CHECK_THAT(refusal({.span = 80.0, .height = 0.0, .upper_tension = 10.0, .weight_per_length = 10.0}), Catch::Contains("out of reach"));
  CHECK_THAT(refusal({.span = 80.0, .length = 100.0, .upper_tension = 10.0, .weight_per_length = 10.0}),
             Catch::Contains("no cable with the other two"));
  CHECK_THAT(refusal({.span = 80.0, .horizontal_tension = 9.0, .upper_tension = 10.0, .weight_per_length = 1.0}), Catch::Contains("only one"));
  CHECK_THAT(refusal({.span = 1.0, .height = 0.0, .length = 1e8}), Catch::Contains("too deep"));
  CHECK_THAT(refusal({.span = 1.0, .height = 0.0, .horizontal_tension = 1e9, .weight_per_length = 1.0}), Catch::Contains("too taut"));
}
