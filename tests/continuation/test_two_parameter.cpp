#include <catch2/catch.hpp>

#include "continuation/network.hpp"
#include "continuation/normal_form.hpp"
#include "continuation/two_parameter.hpp"
#include "models/closed_forms.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;
using namespace whirl::continuation;

namespace {

struct CuspField {  // x' = mu + lambda x - x^3, p = (mu, lambda)
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    r[0] = u[1] + u[2] * u[0] - u[0] * u[0] * u[0];
  }
};

struct CuspFixed {
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    r[0] = u[1] + u[0] - u[0] * u[0] * u[0];
  }
};

struct CoOxidation {  // p = q2 (k fixed) or (q2, k)
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    const S &x = u[0], &y = u[1], &s = u[2], &q2 = u[3];
    const S k = u.size() > 4 ? u[4] : S(0.4), z = 1.0 - x - y - s;
    r[0] = z * z * 5.0 - x * x * 2.0 - x * y * 10.0;
    r[1] = q2 * z - y * 0.1 - x * y * 10.0;
    r[2] = (z - k * s) * 0.0675;
  }
};

struct HopfForm {  // r' = p r + a r^3 in Cartesian form, frequency 2: l1 is known
  double a;
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    const S q = u[0] * u[0] + u[1] * u[1];
    r[0] = u[2] * u[0] - u[1] * 2.0 + q * u[0] * a;
    r[1] = u[2] * u[1] + u[0] * 2.0 + q * u[1] * a;
  }
};

struct PitchforkForm {
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {  // x' = p x - 3 x^3 + x y, y' = -y + x^2: effective cubic -3 + 1
    r[0] = u[2] * u[0] - u[0] * u[0] * u[0] * 3.0 + u[0] * u[1];
    r[1] = u[0] * u[0] - u[1];
  }
};

SpecialPoint find(const Branch& b, EventType type, std::size_t k = 0) {
  for (const auto& s : b.special)
    if (s.type == type && k-- == 0) return s;
  throw std::runtime_error("no such point");
}

std::vector<const CodimensionTwo*> of_type(const DefiningCurve& c, const std::string& type) {
  std::vector<const CodimensionTwo*> all;
  for (const auto& s : c.special)
    if (s.type == type) all.push_back(&s);
  return all;
}

}  // namespace

TEST_CASE("normal-form coefficients of forms that are known", "[published]") {
  SpecialPoint p;
  p.type = EventType::hopf;
  p.u = Eigen::Vector3d(0, 0, 0);
  p.frequency = 2.0;
  for (const double a : {-1.5, 0.7}) {
    set_normal_form(DualProblem<HopfForm>({a}, 2, 1, true), p);
    // z' = i w z + c1 z |z|^2 for z = <p, x>, with q of unit length z is sqrt 2 times smaller: Re c1 = 2 a, l1 = Re c1 / w
    CHECK(p.coefficient == Approx(2.0 * a / 2.0 * 1.0).epsilon(1e-12));
  }
  p.type = EventType::branch_point;
  set_normal_form(DualProblem<PitchforkForm>({}, 2, 1, true), p);
  CHECK(p.coefficient == Approx(-2.0).epsilon(1e-12));
  p.type = EventType::fold;
  p.u = Eigen::Vector2d(std::sqrt(1.0 / 3.0), -2.0 / (3.0 * std::sqrt(3.0)));
  set_normal_form(DualProblem<CuspFixed>({}, 1, 1, true), p);
  CHECK(std::abs(p.coefficient) == Approx(3.0 * std::sqrt(1.0 / 3.0)).epsilon(1e-12));
}

TEST_CASE("fold curve of the cusp", "[published]") {
  const DualProblem<CuspFixed> f({}, 1, 1, true);
  const DualProblem<CuspField> f2({}, 1, 2, true);
  WalkOptions o;
  o.lower = -2.0;
  o.upper = 2.0;
  const Branch b = Walker(f, o).walk(Eigen::Vector2d(-1.6, -2.0));
  TwoParameterOptions t;
  t.range1[0] = -3.0;
  t.range1[1] = 3.0;
  t.range2[0] = -1.0;
  t.range2[1] = 2.0;
  const DefiningCurve c = follow(f2, find(b, EventType::fold), 1.0, t);
  REQUIRE(c.u.cols() > 10);
  for (Eigen::Index i = 0; i < c.u.cols(); ++i)  // 27 mu^2 = 4 lambda^3
    CHECK(27.0 * c.u(1, i) * c.u(1, i) == Approx(4.0 * std::pow(c.u(2, i), 3)).epsilon(0).margin(1e-9));
  const auto cusps = of_type(c, "CP");
  REQUIRE(cusps.size() == 1);
  CHECK(cusps[0]->u.norm() < 1e-9);
  REQUIRE(of_type(c, "MIN").size() == 1);
}

TEST_CASE("codimension-2 points of the CO oxidation in (q2, k)", "[published]") {
  const DualProblem<CoOxidation> f({}, 3, 1, true), f2({}, 3, 2, true);
  WalkOptions o;
  o.lower = 0.5;
  o.upper = 2.0;
  // x small, y large at high q2: a start that Newton polishes
  Vector start(4);
  start << 0.0014673, 0.8261, 0.1232, 1.2;
  const Branch b = Walker(f, o).walk(start);
  int folds = 0, hopfs = 0;
  for (const auto& s : b.special) {
    folds += s.type == EventType::fold ? 1 : 0;
    hopfs += s.type == EventType::hopf ? 1 : 0;
  }
  REQUIRE(folds == 2);
  REQUIRE(hopfs == 2);
  TwoParameterOptions t;
  t.range1[0] = 0.3;
  t.range1[1] = 3.0;
  t.range2[0] = 0.02;
  t.range2[1] = 2.0;
  const auto near = [](const std::vector<const CodimensionTwo*>& all, double q2, double k) {
    return std::any_of(all.begin(), all.end(),
                       [&](const CodimensionTwo* s) { return std::abs(s->u[3] - q2) < 2e-6 && std::abs(s->u[4] - k) < 2e-6; });
  };
  const DefiningCurve lp = follow(f2, find(b, EventType::fold), 0.4, t);
  const auto cusp = of_type(lp, "CP");
  REQUIRE(cusp.size() >= 1);
  // s and y eliminated, the steady states are q2(x; k): at a cusp its first two slopes in x vanish. (A value .35665351 has been printed for
  // this cusp's k; on the fold curve k is never below the value checked here.)
  using D = Dual<Dual<double, 1>, 1>;
  D x(seed<Dual<double, 1>>(cusp[0]->u[0], 0));
  x.d[0].v = 1.0;
  const double k = cusp[0]->u[4];
  const D one = D(0.5) / x, z = (sqrt(one * (1.0 - x * 0.8) * 4.0 + (1.0 + 1.0 / k) * (1.0 + 1.0 / k)) - (1.0 + 1.0 / k)) / (one * 2.0);
  const D y = (z * z * 5.0 - x * x * 2.0) / (x * 10.0), q2 = (y * 0.1 + x * y * 10.0) / z;
  CHECK(q2.v.v == Approx(cusp[0]->u[3]).epsilon(1e-10));
  CHECK(std::abs(q2.v.d[0]) < 1e-8);  // located to 1e-10 in k, slopes of order 100
  CHECK(std::abs(q2.d[0].d[0]) < 1e-5);
  CHECK(k == Approx(0.35599127).epsilon(2e-8));
  CHECK(near(of_type(lp, "BT"), 1.417628, 0.971397));  // printed to 6 decimals
  CHECK(near(of_type(lp, "BT"), 1.161199, 0.722339));
  const DefiningCurve hb = follow(f2, find(b, EventType::hopf), 0.4, t);
  CHECK(near(of_type(hb, "GH"), 0.924255, 0.305879));
  CHECK((near(of_type(hb, "BT"), 1.417628, 0.971397) || near(of_type(hb, "BT"), 1.161199, 0.722339)));
}

TEST_CASE("whirling threshold of the Oresund stay in frequency and support amplitude") {
  const SuperharmonicFlow f(oresund(0.5), {.order = 2}, {Lens("omega")}), f2(oresund(0.5), {.order = 2}, {Lens("omega"), Lens("support_amplitude")});
  WalkOptions o;
  o.lower = 1.2;
  o.upper = 2.4;
  Vector start(5);
  start << in_plane_states(f.model().coefficients<double>(std::array<double, 1>{1.2})).front(), 1.2;
  const Branch b = Walker(f, o).walk(start);
  TwoParameterOptions t;
  t.range1[0] = 1.0;
  t.range1[1] = 3.0;
  t.range2[0] = 0.05;
  t.range2[1] = 0.8;
  const DefiningCurve c = follow(f2, find(b, EventType::branch_point), 0.5, t);
  const auto least = of_type(c, "MIN");
  REQUIRE(least.size() == 1);
  // Newton on the fixed-omega problem in U at the threshold's omega gives the same U.
  CHECK(least[0]->u[5] == Approx(0.3225487668).epsilon(1e-9));
  CHECK(least[0]->u[4] == Approx(1.6187487888).epsilon(1e-7));  // flat there: omega is the square root less exact
  bool both = false;
  for (Eigen::Index i = 0; i + 1 < c.u.cols(); ++i)
    if ((c.u(5, i) - 0.5) * (c.u(5, i + 1) - 0.5) < 0.0) {
      const double s = (0.5 - c.u(5, i)) / (c.u(5, i + 1) - c.u(5, i)), w = c.u(4, i) + s * (c.u(4, i + 1) - c.u(4, i));
      both = both || std::abs(w - 1.90136878608) < 1e-2;
    }
  CHECK(both);
  CHECK(of_type(c, "DP").size() == 1);  // where whirling turns from super- to subcritical
}
