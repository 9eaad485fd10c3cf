// Longitudinal steady states and lumped-mass statics of guys, [Sarvi1968, ch. IV and VI].
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "models/guy/longitudinal.hpp"
#include "models/guy/lumped.hpp"
#include "models/guy/tangent.hpp"
#include "tests/models/guy_cases.hpp"

using namespace whirl::models::guy;
using namespace guy_cases;
using C = std::complex<double>;

TEST_CASE("Oklahoma City guy: funicular polygon of five masses, Table III", "[published]") {
  const Polygon p = funicular_polygon(oklahoma_rest(Form::first_order), 5);
  const double slope[] = {1.216432339724, 1.300633526485, 1.384834713246, 1.469035900007, 1.553237086768, 1.637438273529};
  const double x[] = {103.4384358371, 304.7763936665, 498.1559280901, 684.0326740919, 862.8441744191};  // x4: 684.0330 for the misprinted 689.0330
  const double y[] = {125.8258585227, 387.6927566296, 655.4914487309, 928.5510615839, 1206.287715433};
  const double tension[] = {55.58721876067, 57.91403215777, 60.29759952998, 62.73145187597, 65.20995903188, 67.72821876067};
  const double length[] = {162.8854096639, 330.3199140032, 330.3207287244, 330.3206273845, 330.3198473305, 167.2212130654};
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(p.slope[i] == Approx(slope[i]).epsilon(1e-11));
    CHECK(p.tension[i] / (1000.0 * pound) == Approx(tension[i]).epsilon(1e-11));
    CHECK(p.length[i] / foot == Approx(length[i]).epsilon(3e-11));  // differences of the points
    if (i == 5) break;
    CHECK(p.x[i + 1] / foot == Approx(x[i]).epsilon(3e-11));
    CHECK(p.y[i + 1] / foot == Approx(y[i]).epsilon(3e-11));
    CHECK(p.weight[i] / (32.174 * pound) == Approx(92.38210644).epsilon(1e-9));  // slug
  }
  CHECK(p.x[4] / foot == Approx(684.0330).epsilon(0).margin(5e-4));
}

TEST_CASE("Oklahoma City guy: hung masses", "[published]") {
  const Statics s = oklahoma_rest(Form::first_order);
  struct Row {
    int n;
    double segment, slugs, H, slope;
  };
  const Row rows[] = {
      {1, 825.639414629, 230.955266105, 30465.5206171, 1.30502500896}, {2, 550.426276419, 153.970177403, 33238.3146186, 1.27791152995},
      {5, 275.21313821, 76.9850887017, 34796.0384192, 1.24897920936},  {10, 150.116257205, 41.9918665645, 35150.8164512, 1.23475787149},
      {20, 78.6323252028, 21.995739629, 35259.1304173, 1.22622420464}, {40, 40.2750933965, 11.2661105417, 35289.2826987, 1.22150426511}};
  for (const Row& row : rows) {
    const Polygon p = equal_hung_masses(s, row.n);
    CHECK(p.length[0] / foot == Approx(row.segment).epsilon(1e-11));
    CHECK(p.weight[0] / (32.174 * pound) == Approx(row.slugs).epsilon(1e-10));
    CHECK(p.horizontal_tension / pound == Approx(row.H).epsilon(3e-10));  // amplified by the length's last digit
    CHECK(p.slope[0] == Approx(row.slope).epsilon(3e-10));
  }
  std::vector<double> weights(5, s.guy.weight() * s.length / 6.0);
  weights[2] += 500.0 * pound;
  const Polygon heavy = hung_masses(s.guy, std::vector(6, s.length / 6.0), weights);
  CHECK(heavy.horizontal_tension / pound == Approx(36606.8369779).epsilon(3e-10));
  CHECK(heavy.slope[0] == Approx(1.25095580119).epsilon(3e-10));
}

TEST_CASE("a chain of hung masses closes, balances, and tends to the elastic catenary with second order") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int trial = 0; trial < 50; ++trial) {
    const Guy g{.horizontal_span = 40.0 + 100.0 * u(random), .rise = 100.0 * (u(random) - 0.3), .axial_stiffness = 1e8, .mass_per_length = 3.0};
    const int n = 1 + static_cast<int>(8 * u(random));
    std::vector<double> l, w;
    for (int i = 0; i <= n; ++i) l.push_back(0.5 + u(random));
    for (int i = 0; i < n; ++i) w.push_back(1.0 + 500.0 * u(random));
    const double slack = 1.0 + std::pow(10.0, -4.0 + 3.3 * u(random)), sum = std::accumulate(l.begin(), l.end(), 0.0);
    for (double& v : l) v *= g.chord() * slack / sum;
    const Polygon p = hung_masses(g, l, w, trial % 2 == 0 ? 1e7 : std::numeric_limits<double>::infinity());
    INFO("n = " << n << ", slack " << slack);
    CHECK(p.x.back() == Approx(g.horizontal_span).epsilon(1e-10));
    CHECK(p.y.back() == Approx(g.rise).epsilon(0).margin(1e-10 * g.chord() * slack));
    for (int i = 0; i < n; ++i)
      CHECK(p.horizontal_tension * (p.slope[i + 1] - p.slope[i]) == Approx(w[i]).epsilon(1e-9).margin(1e-12 * p.tension[0]));
  }
  for (const double sag : {30.0, 300.0, 1000.0}) {  // slack guys: half a kilometre of chord
    const Statics slack = solve(oklahoma(), Known::sag, sag, Form::first_order);
    for (const int n : {1, 5, 40}) {
      if (n < sag / 40.0) continue;  // a few long lines cannot close without one of them going slack
      const Polygon p = equal_hung_masses(slack, n);
      CHECK(p.x.back() == Approx(slack.guy.horizontal_span).epsilon(1e-10));
      CHECK(p.y.back() == Approx(slack.guy.rise).epsilon(1e-10));
    }
    CHECK(equal_hung_masses(slack, 300).horizontal_tension == Approx(slack.horizontal_tension).epsilon(2e-3));
  }
  const Statics s = oklahoma_rest();
  const auto error = [&](int n) {  // n + 1 equal segments; half a segment's weight rests on each end
    const double part = s.unstressed_length / (n + 1);
    return hung_masses(s.guy, std::vector(n + 1, part), std::vector(n, s.guy.weight() * part), s.guy.axial_stiffness).horizontal_tension /
               s.horizontal_tension -
           1.0;
  };
  CHECK(std::abs(error(79)) < 5e-4);
  CHECK(error(39) / error(79) == Approx(4.0).epsilon(0.02));
  CHECK(error(79) / error(159) == Approx(4.0).epsilon(0.02));
}

TEST_CASE("impossible chains are refused") {
  const Guy g = oklahoma();
  CHECK_THROWS_WITH(hung_masses(g, {200.0, 200.0}, {10.0}), Catch::Contains("cannot reach"));
  CHECK_THROWS_AS(hung_masses(g, {300.0, 300.0, 300.0}, {10.0}), std::invalid_argument);
  CHECK_THROWS_AS(hung_masses(g, {300.0, 300.0}, {-10.0}), std::invalid_argument);
  CHECK_THROWS_AS(equal_hung_masses(oklahoma_rest(Form::first_order), 0), std::invalid_argument);
  CHECK_THROWS_WITH(hung_masses(g, {2000.0, 10.0}, {10.0}), Catch::Contains("all lines taut"));
  CHECK_THROWS_AS(funicular_polygon(oklahoma_rest(Form::exact), 5), std::invalid_argument);
}

TEST_CASE("longitudinal steady states: closed forms, series, resonances") {
  const Statics s = oklahoma_rest(Form::first_order);
  const double alpha = horizontal_modulus(s) / s.guy.taut_modulus();
  const LongitudinalGuy bar(s.length, s.guy.axial_stiffness, s.guy.mass_per_length, alpha);
  CHECK(LongitudinalGuy(s.length, s.guy.axial_stiffness, s.guy.mass_per_length, 0.398).wave_speed() / foot == Approx(9090.465311).epsilon(1e-9));
  CHECK(LongitudinalGuy(s.length, s.guy.axial_stiffness, s.guy.mass_per_length, 0.485).wave_speed() / foot == Approx(10034.95541).epsilon(1e-9));
  CHECK(bar.held_frequency(1) == Approx(2.0 * bar.free_frequency(1)).epsilon(1e-15));
  for (const double ratio : {0.1, 0.7, 1.3, 2.6})
    for (const double damping : {0.0, 0.5}) {
      const double p = ratio * bar.free_frequency(1);
      for (const double at : {0.2, 0.7}) {
        const double x = at * s.length;
        // the terms of both series fall as i^-2 and i^-3
        CHECK(std::abs(bar.force_driven(1e4, x, p, damping) - bar.force_driven_series(1e4, x, p, damping, 4000)) <
              2e-6 * std::abs(bar.force_driven(1e4, x, p, damping)));
        CHECK(std::abs(bar.displacement_driven(0.3, x, p, damping) - bar.displacement_driven_series(0.3, x, p, damping, 4000)) < 1e-6 * 0.3);
      }
      // both descriptions are one: (4.59)
      const C end = bar.force_driven(1e4, s.length, p, damping);
      CHECK(std::abs(bar.stiffness(p, damping) * end - 1e4) < 1e-9 * 1e4);
      CHECK(std::abs(bar.magnification_of_force(p, damping) * bar.magnification_of_displacement(p, damping) - 1.0) < 1e-13);
      CHECK(bar.stiffness(p, damping).imag() >= 0.0);
    }
  CHECK(std::abs(bar.magnification_of_force(bar.free_frequency(2), 0.0)) < 1e-12);
  CHECK(std::abs(bar.magnification_of_displacement(bar.held_frequency(2), 0.0)) < 1e-12);
  CHECK(bar.magnification_of_force(1e-6, 0.0).real() == Approx(1.0));
  // the printed factor 2 p^2/pi^2 of (4.53) would miss by this much
  const double p = 0.7 * bar.free_frequency(1), x = 0.5 * s.length;
  const C right = bar.displacement_driven(1.0, x, p, 0.0), linear = x / s.length,
          series = bar.displacement_driven_series(1.0, x, p, 0.0, 4000) - linear;
  CHECK(std::abs(linear + series / std::numbers::pi - right) > 1e-3);
  CHECK_THROWS_AS(LongitudinalGuy(1.0, 1.0, 1.0, 0.0), std::invalid_argument);
  CHECK_THROWS_AS(bar.stiffness(0.0, 0.0), std::invalid_argument);
  CHECK_THROWS_AS(bar.stiffness(1.0, -1.0), std::invalid_argument);
}
