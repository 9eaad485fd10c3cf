// A taut inclined cable, its lower end moved vertically: planar motion loses stability to the first out-of-plane mode at twice its frequency.
#include <catch2/catch.hpp>

#include "continuation/walker.hpp"
#include "models/multimode/cable_model.hpp"
#include "models/statics.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

CableModel inclined(int in_plane, double ratio) {
  CableModel m{.stay = {{1.98, 100e3, 205.0, 0.67, 20.0, 9.81}, 0.002, 0.002, 1e-6, 1.0}};
  // The reference stretches with AE/L; ours with AE/(L (1 + 8 r^2/3)), 1.5e-4 less.
  const double r = parabola(m.stay.cable).sag_ratio;
  m.stay.cable.axial_stiffness *= 1.0 + 8.0 / 3.0 * r * r;
  m.in_plane = lowest_half_waves(in_plane);
  m.longitudinal = Longitudinal::quasi_static;
  m.shapes = Shapes::sines;
  m.end = End::lower;
  m.direction = Direction::vertical;
  m.stay.omega = ratio * modes(m.stay.cable).omega1;
  return m;
}

class Planar {
 public:
  explicit Planar(const CableModel& m)
      : balance_(cable_system(m, {Lens("support_amplitude")}), {.harmonics = 10, .reflections = cable_reflections(m)}) {}

  // 1 + trace + determinant of the out-of-plane monodromy over one period: zero where a multiplier is -1, one of 1 over two periods.
  double test(In u) const {
    REQUIRE(u.head(2 * balance_.harmonics() + 1).isZero(0.0));  // exactly in plane
    REQUIRE(balance_.tail(u) < 1e-10);
    const ModalSystem<double> system = balance_.system_at(u);
    Floquet floquet(system, balance_.harmonics(), 1);
    const FloquetResult& f = floquet.compute(system, u.head(balance_.size()));
    REQUIRE(f.converged);
    REQUIRE(f.blocks.front() == std::vector<int>{0});
    const Matrix& a = f.monodromy;
    const int n = balance_.coordinates();
    return 1.0 + a(0, 0) + a(n, n) + a(0, 0) * a(n, n) - a(0, n) * a(n, 0);
  }

  // Along the planar motion that starts from rest, with rising amplitude and round its folds, to the first loss of stability out of plane.
  double threshold() const {
    const double first = 1e-6;
    const auto start = newton(balance_, balance_.linear_response(Vector::Constant(1, first)));
    REQUIRE(start.ok());
    continuation::Walker walker(balance_, {.lower = 0.0, .upper = 1.5e-3, .max_step = 0.02, .locate_events = false});
    const auto branch = walker.walk_from(start.x, Vector::Unit(balance_.size() + 1, balance_.size()), false);
    Vector before = start.x;
    for (int k = 0; k < branch.points(); ++k) {
      const Vector point = branch.u(k);
      if (test(point) > 0.0) {
        before = point;
        continue;
      }
      return between(before, point);
    }
    return 0.0;
  }

 private:
  double between(Vector low, Vector high) const {  // no fold between them
    const auto p = balance_.size();
    while (high[p] - low[p] > 1e-10) {
      const auto middle = newton(balance_, Vector(0.5 * (low + high)), {.max_iterations = 20});
      REQUIRE(middle.ok());
      (test(middle.x) > 0.0 ? low : high) = middle.x;
    }
    return 0.5 * (low[p] + high[p]);
  }

  HarmonicBalance balance_;
};

}  // namespace

TEST_CASE("threshold of the first out-of-plane mode by Floquet about the exact planar motion", "[published][slow]") {
  struct Row {
    double ratio;
    double threshold[3];  // mm, with 1, 2, 4 in-plane modes, three digits
  };
  const Row rows[] = {{1.98, {0.505, 1.063, 1.055}}, {2.00, {0.0992, 0.362, 0.357}}, {2.02, {0.507, 0.134, 0.134}}};
  const int counts[] = {1, 2, 4};
  for (const Row& row : rows)
    for (int i = 0; i < 3; ++i) {
      INFO(row.ratio << ", " << counts[i] << " in-plane modes");
      const double mm = 1e3 * Planar(inclined(counts[i], row.ratio)).threshold();
      CHECK(mm == Approx(row.threshold[i]).epsilon(0).margin(row.threshold[i] < 0.1 ? 0.00005 : 0.0005));  // half of the last digit given
    }
}

TEST_CASE("first frequency of the inclined cable", "[published]") {
  CHECK(modes(inclined(1, 2.0).stay.cable).omega1 / (2.0 * pi) == Approx(4.4172).epsilon(2e-5));
}

// First order: stiffness w^2 (1 + eps cos Wt) loses stability at eps = 4 |zeta + i (W/2w - 1)|; eps from the stretching of the chord alone.
TEST_CASE("closed form of the parametric rule", "[published]") {
  const double quoted[] = {0.484, 0.0949, 0.484};
  int i = 0;
  for (const double ratio : {1.98, 2.0, 2.02}) {
    const auto terms = cable_equations(inclined(1, ratio)).terms;
    const auto parametric =
        std::find_if(terms.begin(), terms.end(), [](const auto& t) { return t.equation == 0 && t.degree == 1 && t.cos_harmonic == 1; });
    REQUIRE(parametric != terms.end());
    const double w = modes(inclined(1, ratio).stay.cable).omega1, per_metre = std::abs(parametric->coefficient) / 1e-6 / (w * w);
    CHECK(1e3 * 4.0 * std::hypot(0.002, 0.5 * ratio - 1.0) / per_metre == Approx(quoted[i++]).epsilon(0).margin(0.0005));
  }
}
