// Statics of guys against [Sarvi1968, ch. II] recomputed in exact arithmetic: tables in lb and ft of the Oklahoma City guy.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "models/guy/catenary_functions.hpp"
#include "models/guy/group.hpp"
#include "models/guy/tangent.hpp"
#include "models/guy/transverse_modes.hpp"
#include "tests/models/guy_cases.hpp"

using namespace whirl::models::guy;
using namespace guy_cases;

namespace {

struct CurveRow {
  double dl, H_first, slope_first, H_exact, xx, xy, yy;
};
// Span change [ft]; H [lb], dH/dl [lb/ft] first order; H, Kxx, Kxy, Kyy exact: the unstressed length of H = 35300 lb.
const CurveRow curve_rows[] = {
    {-10, 16204.9509471, 733.596209562, 16199.2248025, 733.2442395, 1004.512352, 1426.881684},
    {-7.5, 18373.3954258, 1026.94872586, 18366.7037742, 1026.534999, 1416.037855, 2010.96196},
    {-5, 21527.7153678, 1550.8175535, 21520.0366074, 1550.497415, 2152.681681, 3056.361381},
    {-3, 25318.5773154, 2311.43266034, 25310.7576802, 2311.785094, 3224.477242, 4577.084073},
    {-2, 27905.8243138, 2891.01747723, 27898.7863123, 2892.342949, 4042.311008, 5737.226515},
    {-1, 31163.9095075, 3660.14584616, 31159.0555228, 3663.396604, 5128.639337, 7277.903972},
    {-0.5, 33108.2763474, 4126.74850673, 33105.4092138, 4131.520009, 5788.101463, 8212.981647},
    {-0.2, 34391.8461592, 4433.71115432, 34390.5774167, 4439.626893, 6222.070272, 8828.235278},
    {0, 35300, 4649.24319872, 35300, 4656.029838, 6526.827501, 9260.25681},
    {0.2, 36252.0949934, 4873.04327485, 36253.5470284, 4880.792606, 6843.30909, 9708.858428},
    {0.2096, 36298.9287136, 4883.9847356, 36300.4553752, 4891.782648, 6858.782432, 9730.790268},
    {0.5, 37766.0943609, 5222.98168045, 37770.109233, 5232.354296, 7338.215008, 10410.28353},
    {1, 40529.7797539, 5837.29536328, 40539.2538492, 5849.860659, 8207.067919, 11641.41933},
    {2, 47005.5043081, 7115.65349836, 47031.396176, 7136.243924, 10014.44584, 14200.99528},
    {3, 54734.0970091, 8314.39739871, 54785.1892064, 8344.316325, 11706.32503, 16594.4531},
    {4, 63561.5703496, 9298.65694124, 63647.3335673, 9338.030151, 13090.2024, 18548.92212},
    {5, 73246.6643825, 10031.1863218, 73376.3483493, 10079.57025, 14113.37537, 19990.20854},
    {6, 83551.7542835, 10547.7463145, 83734.1383364, 10604.70462, 14827.52511, 20992.20601},
};

struct GroupRow {
  int n;
  double theta_deg, delta, axial, full, across;
};
// Guys, direction [deg], displacement [ft], reactions [kip]; the direction is counted from the one away from the first guy's anchor.
const GroupRow group_rows[] = {
    {4, 0, -4, -40.3271459, -40.6247365, 3.43192e-15},
    {4, 0, -2, -19.09968, -19.2483525, 1.42109e-15},
    {4, 0, -0.5, -4.65781801, -4.69497655, 2.99538e-16},
    {4, 0, -0.1, -0.929917634, -0.937349218, 5.71522e-17},
    {4, 0, 0.1, 0.929917634, 0.937349218, -5.58199e-17},
    {4, 0, 0.5, 4.65781801, 4.69497655, -2.66231e-16},
    {4, 0, 2, 19.09968, 19.2483525, -8.98837e-16},
    {4, 0, 4, 40.3271459, 40.6247365, -1.46372e-15},
    {4, 45, -4, -39.0342854, -39.4006786, 0},
    {4, 45, -2, -18.860227, -19.017919, 0},
    {4, 45, -0.5, -4.65354345, -4.69084484, 9.09495e-16},
    {4, 45, -0.1, -0.929883141, -0.937315869, 0},
    {4, 45, 0.1, 0.929883141, 0.937315869, 5.68434e-17},
    {4, 45, 0.5, 4.65354345, 4.69084484, 0},
    {4, 45, 2, 18.860227, 19.017919, 0},
    {4, 45, 4, 39.0342854, 39.4006786, 3.63798e-15},
    {3, 0, -4, -23.7710799, -24.112174, -3.63798e-15},
    {3, 0, -2, -12.6239554, -12.7609799, 1.05865e-12},
    {3, 0, -0.5, -3.38889832, -3.41818731, 6.14818e-13},
    {3, 0, -0.1, -0.693305295, -0.698934031, -3.63798e-15},
    {3, 0, 0.1, 0.701545284, 0.707064783, 0},
    {3, 0, 0.5, 3.59461796, 3.62117396, 1.49157e-13},
    {3, 0, 2, 15.8415948, 15.9343945, -3.63798e-15},
    {3, 0, 4, 35.655746, 35.8143554, -7.27596e-15},
    {3, 60, -4, -35.655746, -35.8143554, 1.09139e-14},
    {3, 60, -2, -15.8415948, -15.9343945, 6.36646e-15},
    {3, 60, -0.5, -3.59461796, -3.62117396, -1.56206e-13},
    {3, 60, -0.1, -0.701545284, -0.707064783, -2.27374e-16},
    {3, 60, 0.1, 0.693305295, 0.698934031, 1.64846e-15},
    {3, 60, 0.5, 3.38889832, 3.41818731, 1.81899e-15},
    {3, 60, 2, 12.6239554, 12.7609799, -1.05319e-12},
    {3, 60, 4, 23.7710799, 24.112174, 0},
    {3, 30, -4, -29.8006179, -30.0487739, -6.11295},
    {3, 30, -2, -14.2370741, -14.3519348, -1.60281},
    {3, 30, -0.5, -3.49176295, -3.5196854, -0.101552},
    {3, 30, -0.1, -0.697425291, -0.702999408, -0.00406547},
    {3, 30, 0.1, 0.697425291, 0.702999408, -0.00406547},
    {3, 30, 0.5, 3.49176295, 3.5196854, -0.101552},
    {3, 30, 2, 14.2370741, 14.3519348, -1.60281},
    {3, 30, 4, 29.8006179, 30.0487739, -6.11295},
};

Statics moved(const Statics& rest, double dl) {
  Guy g = rest.guy;
  g.horizontal_span += dl;
  return solve(g, Known::unstressed_length, rest.unstressed_length, rest.form);
}

const Known all_known[] = {Known::horizontal_tension, Known::unstressed_length, Known::sag,
                           Known::lower_tension,      Known::upper_tension,     Known::first_frequency};

}  // namespace

TEST_CASE("Oklahoma City guy at rest", "[published]") {
  const Statics s = oklahoma_rest(Form::first_order);
  CHECK(s.r() == Approx(0.1211048159).epsilon(1e-9));  // the reference's last printed digit
  CHECK(s.length / foot == Approx(1651.278829).epsilon(1e-9));
  CHECK((s.length - s.unstressed_length) / foot == Approx(1.750166295).epsilon(1e-9));
  CHECK(s.unstressed_length / foot == Approx(1649.528663).epsilon(1e-9));
  CHECK(s.r() == Approx(0.121105).epsilon(0).margin(5e-7));  // as printed on p. 9
  CHECK((s.length - s.unstressed_length) / foot == Approx(1.7502).epsilon(0).margin(5e-5));
  CHECK(s.lower_tension / pound == Approx(55587.21876).epsilon(1e-9));
  CHECK(s.upper_tension / pound == Approx(67728.21876).epsilon(1e-9));
  CHECK(s.vertical_tension / s.horizontal_tension == Approx(1.216432339724).epsilon(1e-11));
  CHECK(horizontal_modulus(s) / kip_per_foot == Approx(4.649243199).epsilon(1e-9));
  CHECK(s.guy.taut_modulus() / kip_per_foot == Approx(11.66996636).epsilon(1e-9));
  // change of span for +1000 lb and -17000 lb at the same unstressed length
  const auto span_change = [&](double dH) {  // by bisection on the curve H(l)
    double lo = -20.0 * foot, hi = 10.0 * foot;
    for (int i = 0; i < 60; ++i) (moved(s, 0.5 * (lo + hi)).horizontal_tension > s.horizontal_tension + dH * pound ? hi : lo) = 0.5 * (lo + hi);
    return 0.5 * (lo + hi) / foot;
  };
  CHECK(span_change(1000.0) == Approx(0.2098193412).epsilon(1e-8));
  CHECK(span_change(-17000.0) == Approx(942.4281502 - 950.0).epsilon(0).margin(1e-7));  // printed 942.4280
}

TEST_CASE("Oklahoma City guy: force against span, both forms", "[published]") {
  const Statics first = oklahoma_rest(Form::first_order), exact = oklahoma_rest(Form::exact);
  for (const CurveRow& row : curve_rows) {
    INFO("dl = " << row.dl << " ft");
    const Statics a = moved(first, row.dl * foot), b = moved(exact, row.dl * foot);
    CHECK(a.horizontal_tension / pound == Approx(row.H_first).epsilon(1e-10));  // 12 printed digits, amplified 374 times by the length
    CHECK(horizontal_modulus(a) / pound_per_foot == Approx(row.slope_first).epsilon(1e-10));
    CHECK(b.horizontal_tension / pound == Approx(row.H_exact).epsilon(1e-10));
    const Tangent k = tangent(b);
    CHECK(k.xx / pound_per_foot == Approx(row.xx).epsilon(6e-10));  // 10 printed digits
    CHECK(k.xy / pound_per_foot == Approx(row.xy).epsilon(6e-10));
    CHECK(k.yy / pound_per_foot == Approx(row.yy).epsilon(6e-10));
  }
}

TEST_CASE("tangents are the slopes of the curves") {
  for (const Form form : {Form::exact, Form::first_order})
    for (const Statics& rest : {oklahoma_rest(form), davenport_rest(form)}) {
      const double d = 2e-5 * rest.guy.horizontal_span;  // central differences of fourth order and the curve's own 1e-12/2e-5
      const auto H = [&](double k) { return moved(rest, k * d).horizontal_tension; };
      const double slope = (8.0 * (H(1) - H(-1)) - (H(2) - H(-2))) / (12.0 * d);
      CHECK(horizontal_modulus(rest) == Approx(slope).epsilon(1e-7));
    }
  const Statics rest = oklahoma_rest();
  const double d = 1e-5 * rest.unstressed_length;
  const auto H = [&](double k) { return solve(rest.guy, Known::unstressed_length, rest.unstressed_length + k * d).horizontal_tension; };
  const double slope = (8.0 * (H(1) - H(-1)) - (H(2) - H(-2))) / (12.0 * d);
  CHECK(tension_per_unstressed_length(rest) == Approx(slope).epsilon(1e-6));
  const Statics first = oklahoma_rest(Form::first_order);  // the quoted -7.99 kips/ft is the first-order form's, with the factor 374
  const auto Hf = [&](double k) { return solve(rest.guy, Known::unstressed_length, first.unstressed_length + k * d, first.form).horizontal_tension; };
  const double slope_first = (8.0 * (Hf(1) - Hf(-1)) - (Hf(2) - Hf(-2))) / (12.0 * d);
  CHECK(slope_first / kip_per_foot == Approx(-7.99).epsilon(0).margin(0.005));
  CHECK(-slope_first * first.unstressed_length / first.horizontal_tension == Approx(374.0).epsilon(0).margin(0.5));
  CHECK(tension_per_unstressed_length(rest) / kip_per_foot == Approx(-8.006).epsilon(0).margin(5e-4));
}

TEST_CASE("any one quantity known gives back the same guy") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < 40; ++i) {
    Guy g{.horizontal_span = 20.0 + 400.0 * u(random),
          .rise = 500.0 * (u(random) - 0.2),
          .axial_stiffness = 1e7 * std::pow(30.0, u(random)),
          .mass_per_length = 1.0 + 14.0 * u(random)};
    const double H = g.weight() * g.chord() * std::pow(10.0, 0.2 + u(random));  // r from .02 to .3: taut beyond the least tension
    for (const Form form : {Form::exact, Form::first_order}) {
      const Statics s = at_horizontal_tension(g, std::min(H, 0.02 * g.axial_stiffness * g.chord_cosine()), form);
      for (const Known k : all_known) {
        INFO(to_string(form) << " " << to_string(k) << " l = " << g.horizontal_span << " h = " << g.rise << " H = " << s.horizontal_tension);
        const Statics t = solve(g, k, value_of(s, k), form);
        const double tolerance = k == Known::unstressed_length || k == Known::sag ? 1e-9 : 1e-11;  // amplified by AE/T and L/sag
        CHECK(t.horizontal_tension == Approx(s.horizontal_tension).epsilon(tolerance));
      }
    }
  }
}

TEST_CASE("the exact curve: ends, equilibrium, sag") {
  for (const Statics& s : {oklahoma_rest(), davenport_rest()}) {
    const CurvePoint a = curve_at(s, 0.0), b = curve_at(s, s.unstressed_length);
    CHECK(a.x == 0.0);
    CHECK(a.y == 0.0);
    CHECK(b.x == Approx(s.guy.horizontal_span).epsilon(1e-14));
    CHECK(b.y == Approx(s.guy.rise).epsilon(1e-14));
    CHECK(b.tension == Approx(s.upper_tension).epsilon(1e-14));
    double deepest = 0.0, length = 0.0;
    CurvePoint before = a;
    for (int i = 1; i <= 2000; ++i) {
      const CurvePoint p = curve_at(s, s.unstressed_length * i / 2000.0);
      deepest = std::max(deepest, (p.x * s.guy.rise - p.y * s.guy.horizontal_span) / s.guy.chord());
      length += std::hypot(p.x - before.x, p.y - before.y);
      before = p;
    }
    CHECK(s.sag == Approx(deepest).epsilon(1e-6));  // grid of 2000
    CHECK(s.length == Approx(length).epsilon(1e-8));
    // parabola to second order: w l Lc / 8 H along the vertical, times cos gamma
    CHECK(s.sag == Approx(s.guy.weight() * s.guy.horizontal_span * s.guy.horizontal_span / (8.0 * s.horizontal_tension)).epsilon(0.02));
  }
}

TEST_CASE("limits: level, taut, slack, both forms meet for a stiff guy") {
  Guy level{.horizontal_span = 100.0, .rise = 0.0, .axial_stiffness = 1e9, .mass_per_length = 2.0};
  const Statics s = at_horizontal_tension(level, 20000.0);
  CHECK(s.lower_tension == Approx(s.upper_tension).epsilon(1e-14));
  CHECK(s.vertical_tension == Approx(-0.5 * level.weight() * s.unstressed_length).epsilon(1e-13));
  for (const double H : {150.0, 500.0, 2000.0}) {  // slack to taut, inextensible: closed form
    Guy stiff = level;
    stiff.axial_stiffness = 1e16;
    const double r = 0.5 * level.weight() * 100.0 / H;
    const Statics a = at_horizontal_tension(stiff, H), b = at_horizontal_tension(stiff, H, Form::first_order);
    CHECK(a.unstressed_length == Approx(100.0 * std::sinh(r) / r).epsilon(1e-11));
    CHECK(a.unstressed_length == Approx(b.unstressed_length).epsilon(1e-11));
    CHECK(a.sag == Approx(H / level.weight() * (std::cosh(r) - 1.0)).epsilon(1e-10));
    CHECK(tangent(a).xx == Approx(horizontal_modulus(b)).epsilon(1e-6));
  }
  // taut without weight: the bar along the chord
  Guy bar{.horizontal_span = 60.0, .rise = 80.0, .axial_stiffness = 1e8, .mass_per_length = 1e-7};
  const Tangent k = tangent(at_horizontal_tension(bar, 6e4));
  const double T = 1e5, L0 = 100.0 / (1.0 + T / 1e8), along = 1e8 / L0, across = T / 100.0;
  CHECK(k.xx == Approx(0.36 * along + 0.64 * across).epsilon(1e-10));
  CHECK(k.xy == Approx(0.48 * (along - across)).epsilon(1e-10));
  CHECK(k.zz == Approx(across).epsilon(1e-10));
  // nearly vertical: tension falls by the weight, horizontal stiffness of the hanging string w / ln(TL/T0) while it is taut
  Guy mast{.horizontal_span = 0.01, .rise = 100.0, .axial_stiffness = 1e9, .mass_per_length = 5.0};
  const Statics v = solve(mast, Known::upper_tension, 12000.0);
  CHECK(v.lower_tension == Approx(12000.0 - mast.weight() * v.unstressed_length).epsilon(1e-8));
  CHECK(tangent(v).zz == Approx(mast.weight() / std::log(v.upper_tension / v.lower_tension)).epsilon(2e-5));  // T/AE
  // against the solution mirrored at the vertical axis
  Guy down = oklahoma();
  down.rise = -down.rise;
  const Statics a = oklahoma_rest(), b = at_horizontal_tension(down, a.horizontal_tension);
  CHECK(b.unstressed_length == Approx(a.unstressed_length).epsilon(1e-14));
  CHECK(b.lower_tension == Approx(a.upper_tension).epsilon(1e-13));
  CHECK(b.sag == Approx(a.sag).epsilon(1e-11));
}

TEST_CASE("the series near the taut limit meets the closed form") {
  for (const double r : {0.2999999, 0.3000001}) CHECK(cosh_minus_sinhc(r) == Approx(std::cosh(r) - std::sinh(r) / r).epsilon(1e-14));
  CHECK(cosh_minus_sinhc(1e-8) == Approx(1e-16 / 3.0).epsilon(1e-14));
  CHECK(asinh_difference(1e-9, -1e-9, 2e-9) == Approx(2e-9).epsilon(1e-15));
  CHECK(asinh_difference(3.0 + 1e-12, 3.0, 1e-12) == Approx(1e-12 / std::sqrt(10.0)).epsilon(1e-11));
}

TEST_CASE("groups of guys: reactions", "[published]") {
  const Statics rest = oklahoma_rest(Form::first_order);
  for (const GroupRow& row : group_rows) {
    INFO(row.n << " guys, " << row.theta_deg << " deg, " << row.delta << " ft");
    const Group group = equal_group(rest, row.n);
    const double direction = std::numbers::pi * (1.0 + row.theta_deg / 180.0), d = row.delta * foot;
    const Reaction a = reaction(group, d, direction, GroupTerms::axial), f = reaction(group, d, direction, GroupTerms::full_geometry);
    CHECK(a.along / (1000.0 * pound) == Approx(row.axial).epsilon(1e-8));  // 9 digits printed
    CHECK(f.along / (1000.0 * pound) == Approx(row.full).epsilon(1e-8));
    CHECK(std::abs(f.across) / (1000.0 * pound) == Approx(std::abs(row.across)).epsilon(0).margin(1e-5 * std::abs(row.full)));
  }
  const double modulus = horizontal_modulus(rest), lateral = rest.horizontal_tension / rest.guy.horizontal_span;
  for (const int n : {3, 4, 5}) {
    const Group group = equal_group(rest, n, 0.3);
    CHECK(group_modulus(group, 1.1, GroupTerms::axial) == Approx(0.5 * n * modulus).epsilon(1e-12));
    CHECK(group_modulus(group, 1.1, GroupTerms::full_geometry) == Approx(0.5 * n * (modulus + lateral)).epsilon(1e-12));
    const double d = 1e-4;
    const double slope =
        (reaction(group, d, 1.1, GroupTerms::full_geometry).along - reaction(group, -d, 1.1, GroupTerms::full_geometry).along) / (2.0 * d);
    CHECK(group_modulus(group, 1.1, GroupTerms::full_geometry) == Approx(slope).epsilon(1e-6));
  }
  CHECK(group_modulus(equal_group(rest, 4), 0.0, GroupTerms::axial) / kip_per_foot == Approx(9.298486397).epsilon(1e-9));
  CHECK(group_modulus(equal_group(rest, 3), 0.0, GroupTerms::axial) / kip_per_foot == Approx(6.973864798).epsilon(1e-9));
}

TEST_CASE("ice and temperature act on the unstressed length and on the weight") {
  const Statics rest = oklahoma_rest();
  const Statics iced = solve(with_ice(rest.guy, 4.0), Known::unstressed_length, rest.unstressed_length);
  CHECK(iced.horizontal_tension > rest.horizontal_tension);
  CHECK(iced.sag > rest.sag);
  const double warmer = heated_length(rest.unstressed_length, 20.0, 1.2e-5);
  const Statics warm = solve(rest.guy, Known::unstressed_length, warmer);
  // first order of a convex curve: between the tangents at both ends
  const double step = warmer - rest.unstressed_length, change = warm.horizontal_tension - rest.horizontal_tension;
  CHECK(change > tension_per_unstressed_length(rest) * step);
  CHECK(change < tension_per_unstressed_length(warm) * step);
}

TEST_CASE("impossible guys are refused") {
  const Guy g = oklahoma();
  CHECK_THROWS_WITH(solve(g, Known::unstressed_length, 450.0), Catch::Contains("cannot reach"));
  CHECK_THROWS_WITH(solve(g, Known::upper_tension, 5000.0), Catch::Contains("below the least its weight allows"));
  CHECK_THROWS_WITH(solve(g, Known::lower_tension, 100.0), Catch::Contains("below the least its weight allows"));
  CHECK_THROWS_WITH(solve(g, Known::upper_tension, 0.2 * g.axial_stiffness), Catch::Contains("strains"));
  CHECK_THROWS_WITH(at_horizontal_tension(g, -1.0), Catch::Contains("must be > 0"));
  CHECK_THROWS_WITH(at_horizontal_tension(g, 1.0), Catch::Contains("too slack"));
  CHECK_THROWS_AS(solve(g, Known::sag, 0.0), std::invalid_argument);
  CHECK_THROWS_AS(solve(g, Known::first_frequency, 1e4), std::invalid_argument);
  for (const Form form : {Form::exact, Form::first_order}) {
    CHECK_THROWS_AS(solve(g, Known::first_frequency, 1e-5, form), std::invalid_argument);
    CHECK_THROWS_AS(solve(g, Known::sag, 1e7, form), std::invalid_argument);
    CHECK_THROWS_WITH(solve(g, Known::unstressed_length, 1e7, form), Catch::Contains("too long"));
  }
  Guy bad = g;
  bad.mass_per_length = 0.0;
  CHECK_THROWS_AS(at_horizontal_tension(bad, 1e5), std::invalid_argument);
  bad = g;
  bad.axial_stiffness = 1e3;
  CHECK_THROWS_WITH(at_horizontal_tension(bad, 1e5), Catch::Contains("its own weight"));
  CHECK_THROWS_AS(tangent(oklahoma_rest(Form::first_order)), std::invalid_argument);
  CHECK_THROWS_AS(reaction({}, 1.0, 0.0, GroupTerms::axial), std::invalid_argument);
}

TEST_CASE("guys that their own weight strains by several per cent") {
  // H, T at the anchor, T at the mast of elastic catenaries: Newton on both end conditions from many starts, in another program
  const Guy g{20.0, 20.0, 5000013.48, 616.538, 9.81};
  struct {
    double length, H, lower, upper;
  } const cases[] = {
      {0.97, 149990.03965558362, 167296.97700747784, 283048.90618366504}, {0.98, 128707.32316445344, 139285.88846195268, 255654.77588176148},
      {0.99, 111938.87218036065, 117881.66396167602, 234726.39145458027}, {1.0, 98978.48102160015, 101957.02811444638, 219158.28215531277},
      {1.02, 81126.23980290345, 81458.99615914522, 199122.34657471703},   {1.05, 65634.70708557995, 66076.96308901624, 184089.45057223891},
      {1.1, 52283.22452472193, 56509.28768229136, 174739.97473571243}};
  for (const auto& c : cases) {
    const Statics s = solve(g, Known::unstressed_length, c.length * std::hypot(20.0, 20.0));
    INFO("length " << c.length);
    CHECK(s.horizontal_tension == Approx(c.H).epsilon(1e-10));
    CHECK(s.lower_tension == Approx(c.lower).epsilon(1e-10));
    CHECK(s.upper_tension == Approx(c.upper).epsilon(1e-10));
    for (const Known known : {Known::horizontal_tension, Known::sag}) {
      const Statics again = solve(g, known, value_of(s, known));
      CHECK(again.unstressed_length == Approx(s.unstressed_length).epsilon(1e-9));
    }
  }
}
