#include <catch2/catch.hpp>
#include <limits>

#include "core/dual.hpp"
#include "core/quadrature.hpp"
#include "models/shallow/modes.hpp"
#include "models/statics.hpp"

using namespace whirl;
using namespace whirl::models;
using namespace whirl::models::shallow;
using Approx = Catch::Detail::Approx;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

// The cable of section "another cable": horizontal, 200 m.
Cable<double> second_cable() { return {200.0, 37.6e6, 37e3, 1.57, 0.0, 9.81}; }

// A cable whose lambda2 is the one asked for, at a sag ratio of 1:20.
Cable<double> cable_with(double lambda2) {
  const double r = 0.05, T = 1.0e5, l = 100.0;
  return {l, lambda2 * T * (1.0 + 8.0 * r * r) / (64.0 * r * r), T, 8.0 * T * r / (9.81 * l), 0.0, 9.81};
}

struct Root {
  double lambda2;
  int order;
  double b;
};
// Roots b of the symmetric frequency equation, computed in 40 digits (residuals below 1e-29) and rounded.
// clang-format off
const Root roots[] = {
    {0.0, 1, 3.141592653589793},
    {0.0, 2, 9.42477796076938},
    {0.0, 3, 15.70796326794897},
    {0.0, 4, 21.99114857512855},
    {0.0, 5, 28.27433388230814},
    {0.0, 6, 34.55751918948773},
    {0.1, 1, 3.154465166857235},
    {0.1, 2, 9.42525622691198},
    {0.1, 3, 15.70806651266702},
    {0.1, 4, 21.9911861938331},
    {0.1, 5, 28.27435158080396},
    {0.1, 6, 34.55752888271331},
    {1.0, 1, 3.267886207620111},
    {1.0, 2, 9.429602888986565},
    {1.0, 3, 15.70899931114533},
    {1.0, 4, 21.99152544623634},
    {1.0, 5, 28.27451106376254},
    {1.0, 6, 34.55761619411997},
    {39.478417604357434475, 1, 6.283185307179586},
    {39.478417604357434475, 2, 9.718272546111003},
    {39.478417604357434475, 3, 15.75596085832446},
    {39.478417604357434475, 4, 22.00727872050917},
    {39.478417604357434475, 5, 28.28167707422901},
    {39.478417604357434475, 6, 34.56147502717861},
    {100.0, 1, 8.159295885441595},
    {100.0, 2, 10.93172165418193},
    {100.0, 3, 15.87340830937929},
    {100.0, 4, 22.03820013944209},
    {100.0, 5, 28.29451223304328},
    {100.0, 6, 34.56808700610457},
    {157.9136704174297379, 1, 8.600065238180801},
    {157.9136704174297379, 2, 12.56637061435917},
    {157.9136704174297379, 3, 16.09171676362201},
    {157.9136704174297379, 4, 22.07791789385564},
    {157.9136704174297379, 5, 28.30900536545355},
    {157.9136704174297379, 6, 34.57512701943509},
    {1000.0, 1, 8.948084122029504},
    {1000.0, 2, 15.37046429424672},
    {1000.0, 3, 21.6468676000095},
    {1000.0, 4, 27.67542797475574},
    {1000.0, 5, 31.55360274738443},
    {1000.0, 6, 35.04736292550182},
    {inf, 1, 8.986818915818128},
    {inf, 2, 15.45050367387541},
    {inf, 3, 21.8082433188578},
    {inf, 4, 28.13238782566295},
    {inf, 5, 34.44151054386154},
    {inf, 6, 40.74260591857513},
};
struct Correction {
  double lambda2, drop, increase, drop_large, increase_large, drop_small;
};
// The elastic parabola, the cubic and its limits.
const Correction corrections[] = {
    {0.001, 0.96534581960861, 27.856547426769, 0.33332407433127, 0.49997916753469, 0.96533193628247},
    {0.01, 0.92544855183089, 12.413555666037, 0.33324076645376, 0.49979175343607, 0.92530992089071},
    {0.1, 0.84046207264909, 5.2681019905724, 0.33240997229917, 0.49792531120332, 0.83908510256573},
    {1, 0.66666666666667, 2.0, 0.32432432432432, 0.48, 0.65331936282468},
    {10, 0.369275249357, 0.5854776572198, 0.26086956521739, 0.35294117647059, 0.25309920890714},
    {39.4784176043574, 0.18265467587733, 0.22347307861997, 0.15898584497229, 0.18904062912835, -0.18045516933348},
    {100, 0.093716484895816, 0.10340746944409, 0.088235294117647, 0.096774193548387, -0.60914897434272},
    {157.91367041743, 0.06431923675248, 0.068740578281468, 0.061883207997498, 0.065965355833149, -0.87385577760127},
    {1000, 0.011653251821543, 0.011790651249696, 0.011583011583012, 0.01171875, -2.4668063717532},
    {10000, 0.0011964137644021, 0.0011978468849029, 0.0011956954962136, 0.0011971268954509, -6.4690079109286},
};
// clang-format on

using D2 = Dual<Dual<double, 1>, 1>;
D2 place(double xi) {
  D2 x(xi);
  x.v.d[0] = 1.0;
  x.d[0] = Dual<double, 1>(1.0);
  return x;
}

}  // namespace

TEST_CASE("symmetric frequency numbers of any order", "[published]") {
  for (const Root& r : roots) {
    INFO(r.lambda2 << ", order " << r.order);
    CHECK(shallow::symmetric_root(r.lambda2, r.order) == Approx(r.b).epsilon(1e-14));  // a bracket of 52 bits
  }
  CHECK_THROWS_AS(shallow::symmetric_root(-1.0, 1), std::invalid_argument);
  CHECK_THROWS_AS(shallow::symmetric_root(1.0, 0), std::invalid_argument);
}

TEST_CASE("symmetric roots: cross-overs, the taut string from both sides of the switch, far orders") {
  for (int n = 1; n <= 12; ++n) CHECK(shallow::symmetric_root(cross_over(n), n) == Approx(2 * n * pi).epsilon(1e-14));
  for (int n = 1; n <= 30; ++n) {
    const double left = (n - 0.5) * pi, lambda2 = 4e-9 * left * left * left;
    CHECK(shallow::symmetric_root(0.9999 * lambda2, n) == Approx(shallow::symmetric_root(1.0001 * lambda2, n)).epsilon(1e-12));
  }
  for (const double lambda2 : {1e-10, 1e-3, 1.0, 300.0, 1e9})
    for (int n = 1; n <= 40; ++n) {
      const double x = 0.5 * shallow::symmetric_root(lambda2, n), g = std::sin(x) - (x - 4.0 * x * x * x / lambda2) * std::cos(x);
      // rounding of x times the slope of g, whose largest part is 4 x^3/lambda2
      CHECK(std::abs(g) < 1e-14 * x * (1.0 + x + 4.0 * x * x * x / lambda2));
      CHECK((x >= (n - 0.5) * pi && x <= (n + 0.5) * pi));
    }
  CHECK(shallow::symmetric_root(0.41464398, 1) == Approx(models::symmetric_root(0.41464398)).epsilon(1e-15));  // the two-mode model's
}

TEST_CASE("the second cable of the reference", "[published]") {
  const auto c = second_cable();
  const Statics s = statics(c);
  CHECK(s.lambda2 == Approx(7.0373).epsilon(0).margin(5e-5));  // printed to four decimals
  CHECK(s.sag == Approx(2.0813).epsilon(2e-5));
  CHECK(ModeShape(s, c, Family::out_of_plane, 1).frequency_hz() == Approx(0.38379).epsilon(2e-5));
  CHECK(ModeShape(s, c, Family::symmetric, 1).frequency_hz() == Approx(0.48122).epsilon(2e-5));
  CHECK(ModeShape(s, c, Family::symmetric, 2).frequency_hz() == Approx(1.15577).epsilon(1e-5));
}

TEST_CASE("elastic parabola: the cubic and its limits", "[published]") {
  for (const Correction& k : corrections) {
    INFO(k.lambda2);
    const auto e = elastic_correction(k.lambda2);
    CHECK(e.tension_drop == Approx(k.drop).epsilon(2e-13));  // printed to 14 digits
    CHECK(e.sag_increase == Approx(k.increase).epsilon(2e-13));
    CHECK(elastic_correction_large(k.lambda2).tension_drop == Approx(k.drop_large).epsilon(2e-13));
    CHECK(elastic_correction_large(k.lambda2).sag_increase == Approx(k.increase_large).epsilon(2e-13));
    CHECK(elastic_correction_small(k.lambda2).tension_drop == Approx(k.drop_small).epsilon(2e-13));
    const double h = e.tension_drop;
    CHECK(std::pow(1.0 - h, 3) == Approx(k.lambda2 / 24.0 * (2.0 * h - h * h)).epsilon(1e-11));
  }
  // The limits meet the cubic: errors of the next order.
  CHECK(elastic_correction(1e8).tension_drop == Approx(elastic_correction_large(1e8).tension_drop).epsilon(1e-6));
  CHECK(elastic_correction(1e-9).sag_increase == Approx(elastic_correction_small(1e-9).sag_increase).epsilon(1e-2));
  CHECK(elastic_correction(0.0).tension_drop == 1.0);
}

// The cubic is the small-sag limit of: arc length less stretch is the unstressed length.
TEST_CASE("the elastic parabola is the unstressed length's small-sag limit") {
  double last = 1.0;
  for (const double r : {0.02, 0.01, 0.005}) {  // inextensible sag ratio; lambda2 = 30 throughout
    const double l = 100.0, mg = 10.0, T = mg * l / (8.0 * r), EA = 30.0 * T * (1.0 + 8.0 * r * r) / (64.0 * r * r);
    const double cut = l * (0.5 * (std::sqrt(1.0 + 16.0 * r * r) + std::asinh(4.0 * r) / (4.0 * r)));
    const auto found = tensions({l, EA, 0.0, mg / 9.81, 0.0, 9.81}, Given::unstressed_length, cut);
    REQUIRE(found.size() == 1);
    const double error = std::abs(found[0] / T - (1.0 - elastic_correction(30.0).tension_drop));
    CHECK(error < 10.0 * r * r);
    CHECK(error < 0.3 * last);  // of second order in the sag ratio
    last = error;
  }
}

TEST_CASE("any one of tension, sag, unstressed length, first frequency gives the rest") {
  for (Cable<double> c : {second_cable(), Cable<double>{260.0, 2.17e9, 5.5e6, 81.05, 30.4, 9.81}, cable_with(40.0)}) {
    const double T = c.chord_tension;
    const Statics s = statics(c);
    const double f1 = ModeShape(s, c, Family::out_of_plane, 1).frequency_hz(), f2 = ModeShape(s, c, Family::symmetric, 1).frequency_hz();
    c.chord_tension = std::numeric_limits<double>::quiet_NaN();
    CHECK(complete(c, Given::chord_tension, T).chord_tension == T);
    CHECK(complete(c, Given::sag, s.sag).chord_tension == Approx(T).epsilon(1e-13));
    CHECK(complete(c, Given::first_frequency, f1).chord_tension == Approx(T).epsilon(1e-13));
    CHECK(complete(c, Given::unstressed_length, s.unstressed_length).chord_tension == Approx(T).epsilon(1e-9));  // 1 part in 1e-4 of l is left
    bool found = false;
    for (const double t : tensions(c, Given::first_in_plane_frequency, f2)) {
      CHECK(std::is_sorted(&t, &t + 1));
      c.chord_tension = t;
      CHECK(ModeShape(statics(c), c, Family::symmetric, 1).frequency_hz() == Approx(f2).epsilon(1e-12));
      found = found || std::abs(t / T - 1.0) < 1e-10;
    }
    CHECK(found);
  }
  // Above the cross-over the first in-plane frequency falls and rises again with the tension: several cables have it.
  CHECK(tensions(second_cable(), Given::first_in_plane_frequency, 0.48122).size() >= 2);
  CHECK_THROWS_AS(complete(second_cable(), Given::sag, 60.0), std::invalid_argument);  // 1:3.3
  CHECK_THROWS_AS(complete(second_cable(), Given::unstressed_length, 230.0), std::invalid_argument);
  CHECK_THROWS_AS(complete(second_cable(), Given::sag, -1.0), std::invalid_argument);
}

TEST_CASE("mode shapes satisfy their equations and boundary conditions") {
  for (const double lambda2 : {1e-6, 1.0, 39.4784176043574, 100.0, 157.9136704174297, 1000.0}) {
    const auto c = cable_with(lambda2);
    const Statics s = statics(c);
    CHECK(s.lambda2 == Approx(lambda2).epsilon(1e-14));
    for (const Family family : {Family::out_of_plane, Family::antisymmetric, Family::symmetric})
      for (int n = 1; n <= 4; ++n) {
        INFO(to_string(family) << ' ' << n << ", lambda2 " << lambda2);
        const ModeShape m(s, c, family, n);
        const double b = m.frequency_number(), r = s.sag_ratio, d = s.sag, l = c.chord_length, T = c.chord_tension;
        double largest = 0.0;
        for (int i = 0; i <= 200; ++i) {
          const D2 x = place(i / 200.0), v = m.transverse(x), u = m.longitudinal(x);
          largest = std::max(largest, std::abs(v.v.v));
          // T v'' / l^2 + m omega^2 v = 8 d h / l^2, in units of T b^2 / l^2
          CHECK(std::abs(v.d[0].d[0] / (b * b) + v.v.v - 8.0 * d * m.added_tension() / (T * b * b)) < 1e-12);
          // h (ds/dx)^3 / EA = u' / l + y' v' / l with (ds/dx)^3 = 1 + (3/2) y'^2, in units of y' v' / l
          if (family == Family::out_of_plane) continue;
          const double slope = 4.0 * r * (1.0 - 2.0 * x.v.v), strain = m.added_tension() * (1.0 + 1.5 * slope * slope) / c.axial_stiffness;
          CHECK(std::abs(u.v.d[0] + slope * v.v.d[0] - strain * l) < 1e-12 * (4.0 * r * b));
        }
        CHECK(largest == Approx(1.0).epsilon(2e-3));  // 200 stations
        CHECK(std::abs(m.transverse(0.0)) + std::abs(m.transverse(1.0)) < 1e-13 * b);
        CHECK(std::abs(m.longitudinal(0.0)) + std::abs(m.longitudinal(1.0)) < 1e-12);
        // and the integrals
        CHECK(m.mean() == Approx(integrate<double>([&](double xi) { return m.transverse(xi); })).epsilon(0).margin(1e-14));
        CHECK(m.mean_square() == Approx(integrate<double>([&](double xi) { return m.transverse(xi) * m.transverse(xi); })).epsilon(1e-13));
      }
  }
}

TEST_CASE("the printed forms of v, h and u") {
  const auto c = cable_with(30.0);
  const Statics s = statics(c);
  const ModeShape m(s, c, Family::symmetric, 1), a(s, c, Family::antisymmetric, 2);
  const double b = m.frequency_number(), t = std::tan(0.5 * b), r = s.sag_ratio, h = m.added_tension() / c.chord_tension;
  for (int i = 0; i <= 10; ++i) {
    const double xi = 0.1 * i, bx = b * xi, brace = 1.0 - t * std::sin(bx) - std::cos(bx);
    CHECK(m.transverse(xi) == Approx(8.0 * s.sag * h / (b * b) * brace).epsilon(0).margin(1e-13));  // (17)
    const double Lx = c.chord_length * (xi + 24.0 * r * r * (xi - 2.0 * xi * xi + 4.0 / 3.0 * xi * xi * xi));
    const double bracket =
        b * b * Lx / (s.lambda2 * s.effective_length) - 0.5 * (1.0 - 2.0 * xi) * brace - (bx - t * (1.0 - std::cos(bx)) - std::sin(bx)) / b;
    CHECK(m.longitudinal(xi) == Approx(8.0 * s.sag * 8.0 * r * h / (b * b) * bracket).epsilon(0).margin(1e-13));  // (25)
    const double n = 2.0, A = (1.0 - 2.0 * xi) * std::sin(2.0 * n * pi * xi) + (1.0 - std::cos(2.0 * n * pi * xi)) / (n * pi);
    CHECK(a.longitudinal(xi) == Approx(-4.0 * r * A).epsilon(0).margin(1e-14));  // (14)
  }
}

TEST_CASE("the longitudinal motion of the antisymmetric modes has its local minimum at midspan") {
  const auto c = cable_with(30.0);
  const Statics s = statics(c);
  const ModeShape first(s, c, Family::antisymmetric, 1), second(s, c, Family::antisymmetric, 2);
  const auto slope = [](const ModeShape& m, double xi) { return m.longitudinal(place(xi)).v.d[0]; };
  CHECK(std::abs(slope(first, 0.5)) < 1e-13);
  CHECK(std::abs(slope(first, 0.25)) < 1e-13);  // the largest at the quarter spans
  CHECK(std::abs(first.longitudinal(0.25)) > std::abs(first.longitudinal(0.5)));
  CHECK(std::abs(slope(second, 0.5)) + std::abs(second.longitudinal(0.5)) < 1e-13);  // zero with zero slope
}

TEST_CASE("nodes of the symmetric modes on both sides of the cross-overs", "[published]") {
  const auto nodes = [](double lambda2, int n) {
    const auto c = cable_with(lambda2);
    return ModeShape(statics(c), c, Family::symmetric, n).internal_nodes();
  };
  CHECK(nodes(39.0, 1) == 0);
  CHECK(nodes(cross_over(1), 1) == 0);
  CHECK(nodes(40.0, 1) == 2);
  CHECK(nodes(1e6, 1) == 2);
  CHECK(nodes(39.0, 2) == 2);
  CHECK(nodes(100.0, 2) == 2);
  CHECK(nodes(cross_over(2), 2) == 2);
  CHECK(nodes(160.0, 2) == 4);
  for (const double lambda2 : {5.0, 39.0, 40.0, 100.0, 160.0, 1000.0})  // counted
    for (int n = 1; n <= 5; ++n) {
      const auto c = cable_with(lambda2);
      const ModeShape m(statics(c), c, Family::symmetric, n);
      int changes = 0;
      for (int i = 1; i < 5000; ++i) changes += m.transverse(i / 5001.0) * m.transverse((i + 1) / 5001.0) < 0.0;
      CHECK(m.internal_nodes() == changes);
    }
  // Tangential to the supports at the cross-over, in the first mode.
  const auto c = cable_with(cross_over(1));
  CHECK(std::abs(ModeShape(statics(c), c, Family::symmetric, 1).transverse(place(0.0)).v.d[0]) < 1e-13);
}

TEST_CASE("modes are orthogonal, and their effective masses add up to the cable") {
  const auto c = cable_with(60.0);
  const Statics s = statics(c);
  double total = 0.0;
  for (int n = 1; n <= 400; ++n) total += ModeShape(s, c, Family::symmetric, n).effective_mass();
  CHECK(total == Approx(1.0).epsilon(1e-3));  // the rest falls as 2/(pi^2 n)
  for (int i = 1; i <= 4; ++i)
    for (int k = 1; k < i; ++k) {
      const ModeShape a(s, c, Family::symmetric, i), z(s, c, Family::symmetric, k);
      CHECK(std::abs(integrate<double>([&](double xi) { return a.transverse(xi) * z.transverse(xi); })) < 1e-14);
    }
}

TEST_CASE("an inclined chord sees the weight across it") {
  Cable<double> c = second_cable();
  c.inclination_deg = 60.0;
  CHECK(statics(c).sag == Approx(0.5 * statics(second_cable()).sag).epsilon(1e-14));
  const auto list = lowest_modes(c, 5);
  REQUIRE(list.size() == 10);
  CHECK(list[5].name() == "z1");
  CHECK(list[6].name() == "z2");
  CHECK(list[4].name() == "y5");
  c.chord_tension = -1.0;
  CHECK_THROWS_AS(statics(c), std::invalid_argument);
}
