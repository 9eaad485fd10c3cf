// Crossing and veering of frequencies as the cable's flexibility varies.
#include <cmath>

#include "continuation/walker.hpp"
#include "models/catenary/veering.hpp"
#include "tests/models/catenary/reference.hpp"

using namespace catenary_test;
using namespace whirl::continuation;
using whirl::models::catenary::Parity;

namespace {
constexpr double pi = 3.14159265358979323846;
}

TEST_CASE("catenary veering: the curve's derivatives") {
  const FrequencyCurve curve(-0.4, 0.7, 8, 5.0);
  const int n = curve.size();
  std::srand(3);
  const Vector u = curve.start(0.01, 2) + 0.01 * Vector::Random(n + 1), a = Vector::Random(n + 1), b = Vector::Random(n + 1),
               c = Vector::Random(n + 1);
  Vector r(n), p(n), m(n), t(n);
  Matrix j(n, n + 1), jp = j, jm = j, h = j, hp = j, hm = j;
  const double d = 1e-5;
  curve.jacobian(u, j);
  curve.residual(u + d * a, p);
  curve.residual(u - d * a, m);
  CHECK((j * a - (p - m) / (2 * d)).norm() < 1e-7 * (j * a).norm());
  curve.jacobian(u + d * a, jp);
  curve.jacobian(u - d * a, jm);
  curve.second(u, a, h);
  CHECK((h - (jp - jm) / (2 * d)).norm() < 1e-7 * h.norm());
  curve.second(u + d * c, a, hp);
  curve.second(u - d * c, a, hm);
  curve.third(u, a, b, c, t);
  CHECK((t - (hp - hm) * b / (2 * d)).norm() < 1e-7 * t.norm());
}

TEST_CASE("catenary veering: crossings at h = 0, by the walker and by their own equation", "[published]") {
  const Table t = table("crossover_h0");
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    const double m = t(i, "b_over_2a"), kappa = t(i, "kappa_cross");
    const int n = int(t(i, "pair n (sym n = antisym n)"));
    INFO("b/2a " << m << " pair " << n);
    const auto found = closest_approaches(-m, m, 0.5 * kappa, 2.0 * kappa, 2 * n + 2, 12);
    const auto wanted = std::find_if(found.begin(), found.end(), [&](const Approach& a) { return a.lower_mode == 2 * n - 1; });
    REQUIRE(wanted != found.end());
    CHECK(wanted->crossing);
    CHECK(wanted->kappa == Approx(kappa).epsilon(1e-10));  // 12 digits given
    CHECK(wanted->lower == Approx(t(i, "omega_cross")).epsilon(1e-10));
    CHECK(wanted->upper == Approx(wanted->lower).epsilon(1e-11));
    CHECK(irvine_lambda2(unit_geometry(m, 0.0), wanted->kappa) / (4.0 * n * n * pi * pi) ==
          Approx(t(i, "lambda2_over_(4 n^2 pi^2)")).epsilon(0).margin(0.51e-8));
  }
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    const double m = t(i, "b_over_2a"), kappa = t(i, "kappa_cross");
    const int n = int(t(i, "pair n (sym n = antisym n)"));
    if (m < 0.05 || n > 1) continue;
    INFO("walker, b/2a " << m);
    const FrequencyCurve curve(-m, m, functions_for_range(-m, m, 0.6 * kappa, 1.6 * kappa, 4), t(i, "omega_cross"));
    WalkOptions options;
    options.lower = std::sqrt(0.6 * kappa);
    options.upper = std::sqrt(1.6 * kappa);
    const Branch branch = Walker(curve, options).walk(curve.start(0.8 * kappa, 1, Parity::symmetric));
    CHECK(branch.stop_reason == StopReason::parameter_bound);
    std::vector<SpecialPoint> crossing;
    for (const auto& s : branch.special)
      if (s.type == EventType::branch_point) crossing.push_back(s);
    REQUIRE(crossing.size() == 1);
    CHECK(crossing[0].subtype == "X");
    CHECK(FrequencyCurve::kappa(crossing[0].u) == Approx(kappa).epsilon(1e-9));  // events are located to 1e-10 relative, of s
    CHECK(curve.omega(crossing[0].u) == Approx(t(i, "omega_cross")).epsilon(1e-9));
  }
}

TEST_CASE("catenary veering: least gaps at h > 0", "[published]") {
  const Table t = table("veering_h");
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    const double m = t(i, "b_over_2a"), h = t(i, "h_over_b"), kappa = t(i, "kappa_at_min_gap");
    const int lower = t.text(i, "pair")[0] - '0';
    INFO("b/2a " << m << " h/b " << h << " pair " << t.text(i, "pair"));
    const Geometry g = unit_geometry(m, h);
    const auto found = closest_approaches(g.x1, g.x2, 0.7 * kappa, 1.4 * kappa, lower + 2, 12);
    const auto wanted = std::find_if(found.begin(), found.end(), [&](const Approach& a) { return a.lower_mode == lower; });
    REQUIRE(wanted != found.end());
    CHECK_FALSE(wanted->crossing);
    CHECK(wanted->gap == Approx(t(i, "gap_rel")).epsilon(1e-5));  // 6 digits given, of a minimum
    CHECK(wanted->kappa == Approx(kappa).epsilon(1e-3));          // where it is flat
    CHECK(wanted->lower == Approx(t(i, "w_lower")).epsilon(1e-3));
    CHECK(wanted->width < 1e-11);
    // Nowhere in the neighbourhood is the gap smaller.
    for (const double factor : {0.99, 0.999, 1.001, 1.01}) {
      const auto fan = frequency_fan(g.x1, g.x2, Vector::Constant(1, factor * wanted->kappa), lower + 1);
      CHECK(2.0 * (fan.omega(0, lower) - fan.omega(0, lower - 1)) / (fan.omega(0, lower) + fan.omega(0, lower - 1)) > wanted->gap);
    }
  }
}

TEST_CASE("catenary veering: a deep level cable, whose modes of one parity nearly meet") {
  const auto shape = [](double h) { return geometry({.span = 100.0, .height = h, .length = 600.0, .weight_per_length = 1.0}); };
  const Geometry g = shape(0.0), tilted = shape(0.1);
  const double kappa_lower = 1e-4, kappa_upper = 0.3;
  const auto level = closest_approaches(g.x1, g.x2, kappa_lower, kappa_upper, 6),
             inclined = closest_approaches(tilted.x1, tilted.x2, kappa_lower, kappa_upper, 6);
  // A crossing opens as the cable tilts, every other approach stays where it is.
  REQUIRE(level.size() == inclined.size());
  std::vector<double> crossings;
  for (std::size_t i = 0; i < level.size(); ++i) {
    CHECK(level[i].lower_mode == inclined[i].lower_mode);
    CHECK(level[i].kappa == Approx(inclined[i].kappa).epsilon(1e-5));
    CHECK((level[i].crossing ? inclined[i].gap < 1e-3 : std::abs(level[i].gap / inclined[i].gap - 1.0) < 1e-4));
    if (level[i].crossing) crossings.push_back(level[i].kappa);
  }
  CHECK(level.size() - crossings.size() >= 5);
  // A walk along a symmetric mode keeps to it past gaps of a hundredth, and meets every crossing once.
  const ModeSet first = in_plane_modes({.x1 = g.x1, .x2 = g.x2, .kappa = kappa_lower}, {.count = 6, .shapes = false});
  const FrequencyCurve curve(g.x1, g.x2, functions_for_range(g.x1, g.x2, kappa_lower, kappa_upper, 6), first.modes[0].omega);
  WalkOptions options;
  options.lower = std::sqrt(kappa_lower);
  options.upper = std::sqrt(kappa_upper);
  std::vector<double> walked;
  for (int mode = 1; mode <= 3; ++mode) {
    const Branch branch = Walker(curve, options).walk(curve.start(1.0001 * kappa_lower, mode, Parity::symmetric));
    for (const auto& s : branch.special) {
      CHECK(s.type != EventType::unresolved);
      if (s.type == EventType::branch_point) walked.push_back(FrequencyCurve::kappa(s.u));
    }
  }
  std::sort(walked.begin(), walked.end());
  std::sort(crossings.begin(), crossings.end());
  REQUIRE(walked.size() == crossings.size());
  for (std::size_t i = 0; i < walked.size(); ++i) CHECK(walked[i] == Approx(crossings[i]).epsilon(1e-9));
}

TEST_CASE("catenary veering: modes exchange their parity, hybrid in between") {
  const Geometry g = unit_geometry(0.3, 0.1);
  const auto found = closest_approaches(g.x1, g.x2, 5e-3, 2e-2, 3, 40);
  REQUIRE(!found.empty());
  const double kappa = found[0].kappa;
  CHECK(kind_of(found[0].odd_lower) == ModeKind::hybrid);
  CHECK(kind_of(found[0].odd_upper) == ModeKind::hybrid);
  const FrequencyFan fan = frequency_fan(g.x1, g.x2, Vector(Eigen::Vector2d(0.5 * kappa, 2.0 * kappa)), 2);
  CHECK(fan.odd_share(0, 0) > 0.95);  // stiff cable: the first mode is the antisymmetric one
  CHECK(fan.odd_share(1, 0) < 0.05);
}

TEST_CASE("catenary veering: frequencies of a cable that softens") {
  const Table t = table("kappa_sweep");
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    const Geometry g = unit_geometry(t(i, "b_over_2a"), t(i, "h_over_b"));
    const FrequencyFan fan = frequency_fan(g.x1, g.x2, Vector::Constant(1, t(i, "kappa")), 8);
    for (int k = 0; k < 8; ++k) CHECK(fan.omega(0, k) == Approx(t(i, "w" + std::to_string(k + 1))).epsilon(2e-8));  // kappa has 8 digits
  }
  CHECK_THROWS_AS(closest_approaches(-1.0, 1.0, 0.0, 1.0, 2), std::invalid_argument);
  CHECK_THROWS_AS(closest_approaches(-1.0, 1.0, 1.0, 0.5, 2), std::invalid_argument);
}
