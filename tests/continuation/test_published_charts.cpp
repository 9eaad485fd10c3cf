/// Normal forms and two-parameter charts of systems of the literature; each value is checked against what defines it (eigenvalues, closed forms),
/// published digits where there are some.

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "tests/continuation/chart_of.hpp"

using namespace whirl;
using namespace whirl::continuation;
using namespace whirl::continuation::text_model;

namespace {

const System fitzhugh_nagumo{{"v", "w"}, {"v - v^3/3 - w + J", "eps*(v + a - b*w)"}, {{"J", 0.0}, {"eps", 0.08}, {"a", 0.7}, {"b", 0.8}}};
const System chua{{"x", "y", "z"}, {"alpha*(y - x^3/16 + x/6)", "x - y + z", "-beta*y"}, {{"alpha", 1.0}, {"beta", 14.0}}};
const System lorenz_84{{"x", "y", "z", "u"},  // with the sea surface temperature u
                       {"-y^2 - z^2 - a*x + a*F - g*u^2", "x*y - b*x*z - y + G", "b*x*y + x*z - z", "-d*u + g*u*x + T"},
                       {{"a", 0.25}, {"b", 1.0}, {"G", 0.25}, {"d", 1.04}, {"g", 0.987}, {"T", 0.04}, {"F", 3.0}}};
const System bazykin{
    {"x", "y"}, {"x - x*y/(1+alpha*x) - eps*x^2", "-y + x*y/(1+alpha*x) - delta*y^2"}, {{"alpha", 0.2}, {"eps", 0.01}, {"delta", 0.1}}};

}  // namespace

TEST_CASE("Hopf points of well-known systems and their first Lyapunov coefficients", "[published]") {
  // l1 with <q, q> = <p, q> = 1, from multilinear forms differentiated symbolically in another program, except where a closed form stands.
  struct Case {
    System system;
    std::string lens;
    double lower, upper;
    std::vector<double> start;
    std::vector<double> at, l1;
  };
  const double A = 1.5, v = std::sqrt(1.0 - 0.08 * 0.8), a = 0.08;
  const auto current = [](double x) { return (x + 0.7) / 0.8 - x + x * x * x / 3.0; };
  const auto selkov = [a](double sign) { return std::sqrt(0.5 * (1.0 - 2.0 * a + sign * std::sqrt(1.0 - 8.0 * a))); };
  const std::vector<Case> cases = {
      {{{"x", "y"}, {"A - (B+1)*x + x^2*y", "B*x - x^2*y"}, {{"A", A}, {"B", 1.0}}},
       "B",
       0.5,
       6.0,
       {A, 1.0 / A, 1.0},
       {1.0 + A * A},
       {-(2.0 + A * A) / (2.0 * A * (1.0 + 2.0 * A * A))}},
      {fitzhugh_nagumo, "J", -1.0, 3.0, {-1.2, -0.6, 0.0}, {current(-v), current(v)}, {0.9719710819890, 0.9719710819890}},
      {{{"x", "y"}, {"-x + a*y + x^2*y", "b - a*y - x^2*y"}, {{"a", a}, {"b", 0.2}}},
       "b",
       0.05,
       1.5,
       {0.2, 1.6, 0.2},
       {selkov(-1.0), selkov(1.0)},
       {-1.0541463322499, -0.2838086279134}},
      {{{"x", "y"}, {"x*(1-x/K) - x*y/(1+x)", "x*y/(1+x) - m*y"}, {{"K", 0.5}, {"m", 0.4}}},
       "K",
       0.1,
       5.0,
       {0.5, 0.0, 0.5},
       {1.4 / 0.6},
       {-0.2998215878522}},
      {chua, "alpha", 0.1, 15.0, {std::sqrt(8.0 / 3.0), 0.0, -std::sqrt(8.0 / 3.0), 1.0}, {6.57774721070176}, {-0.0152005065852754}},
  };
  for (const auto& c : cases) {
    const auto all = branches(c.system, c.lens, c.lower, c.upper, {c.start});
    CAPTURE(c.lens);
    CHECK(sound(all));
    const auto hopf = text_model::of_type(all, EventType::hopf);
    const std::size_t images = c.lens == "alpha" ? 2 : 1;  // Chua's circuit is odd: its two equilibria are images of each other
    REQUIRE(hopf.size() == images * c.at.size());
    for (std::size_t i = 0; i < hopf.size(); ++i) {
      CHECK(std::abs(hopf[i].u[hopf[i].u.size() - 1] - c.at[i % c.at.size()]) < 1e-10);
      CHECK(hopf[i].coefficient == Approx(c.l1[i % c.at.size()]).epsilon(1e-9));
    }
  }
}

TEST_CASE("generalised Hopf points of FitzHugh-Nagumo and Chua", "[published]") {
  // zeros of l1 along the closed-form Hopf curves, found in another program to 1e-11
  const auto nagumo = of_type(chart(fitzhugh_nagumo, {"J", "b"}, ranges(-3.0, 3.0, 0.1, 3.0), {-1.2, -0.6, 0.0}), "GH");
  REQUIRE(nagumo.size() == 2);
  for (const auto& z : nagumo) {
    CHECK(std::abs(z.u[3] - 0.51042119172) < 1e-9);
    CHECK(std::min(std::abs(z.u[2] - 0.11891101276), std::abs(z.u[2] - 2.62392181377)) < 1e-9);
  }
  const double rest = std::sqrt(8.0 / 3.0);
  const auto circuit = of_type(chart(chua, {"alpha", "beta"}, ranges(0.1, 15.0, 1.0, 30.0), {rest, 0.0, -rest, 1.0}), "GH");
  REQUIRE(circuit.size() == 2);  // at either of two equilibria that are images of each other
  for (const auto& z : circuit) {
    CHECK(std::abs(z.u[3] - 1.72886069174) < 1e-9);
    CHECK(std::abs(z.u[4] - 1.81678697037) < 1e-9);
  }
}

TEST_CASE("the extended Lorenz-84 model has every codimension-2 point of rest", "[published][slow]") {
  const auto curves = chart(lorenz_84, {"F", "T"}, ranges(-1.5, 3.2, -0.1, 0.1), {2.9787, -0.03868, 0.05823, -0.02105, 3.0});
  const EquilibriumFlow f2 = lorenz_84.flow({"F", "T"});
  CHECK(curves.size() == 4);  // one of folds, three of Hopf points
  const auto bt = of_type(curves, "BT"), zh = of_type(curves, "ZH"), hh = of_type(curves, "HH"), gh = of_type(curves, "GH"),
             cp = of_type(curves, "CP");
  REQUIRE(bt.size() >= 4);  // each on both curves it lies on
  REQUIRE(zh.size() >= 4);
  REQUIRE(hh.size() >= 4);
  REQUIRE(gh.size() == 2);
  REQUIRE(cp.size() == 1);
  for (const auto& z : bt) {
    const auto e = eigenvalues(f2, z.u);
    CHECK(std::abs(e[0] * e[1]) < 1e-9);  // a double root splits like the root of the error: its product and sum do not
    CHECK(std::abs(e[0] + e[1]) < 1e-9);
    CHECK(std::abs(std::abs(z.u[5]) - 0.02094016968) < 1e-9);
  }
  for (const auto& z : zh) {
    const auto e = eigenvalues(f2, z.u);
    for (int i = 0; i < 3; ++i) CHECK(std::abs(e[i].real()) < 1e-9);
    CHECK(std::abs(std::abs(z.u[5]) - 0.00012654083) < 1e-9);
  }
  for (const auto& z : hh) {
    const auto e = eigenvalues(f2, z.u);
    for (int i = 0; i < 4; ++i) CHECK(std::abs(e[i].real()) < 1e-9);
    CHECK(std::abs(std::abs(z.u[5]) - 0.02627393) < 1e-6);  // as a test of BifurcationKit.jl has it
  }
  for (const auto& z : gh) CHECK(std::abs(std::abs(eigenvalues(f2, z.u)[0].imag()) - 0.69036367) < 1e-5);  // the same, to 1e-5
  CHECK(std::abs(cp[0].u[5]) < 1e-9);  // on the axis of the symmetry (u, T) -> -(u, T)
}

TEST_CASE("a curve of Hopf points that only a Bogdanov-Takens point leads to") {
  const auto curves = chart(bazykin, {"alpha", "delta"}, ranges(0.05, 0.99, 0.001, 0.5), {1.3, 1.3, 0.2});
  const EquilibriumFlow f2 = bazykin.flow({"alpha", "delta"});
  int hopf = 0;
  for (const auto& c : curves) {
    if (c.type != EventType::hopf) continue;
    ++hopf;
    for (Eigen::Index i = 0; i < c.u.cols(); ++i) {
      Matrix j(2, 4);
      f2.jacobian(Vector(c.u.col(i)), j);
      CHECK(std::abs(j(0, 0) + j(1, 1)) < 1e-10);
    }
  }
  CHECK(hopf == 2);
  const auto bt = of_type(curves, "BT");
  REQUIRE(bt.size() == 4);
  for (const auto& z : bt) {
    const auto e = eigenvalues(f2, z.u);
    CHECK(std::abs(e[0] * e[1]) + std::abs(e[0] + e[1]) < 1e-9);
    CHECK(std::min(std::abs(z.u[2] - 0.45362432778), std::abs(z.u[2] - 0.86070445931)) < 1e-9);
  }
}

TEST_CASE("a fold curve that ends where a pitchfork degenerates") {
  // p = -q^2 - (c - q)^2 / 4 on the folds, p = -q^2 on the pitchforks: they meet where q = c
  for (const std::vector<std::vector<std::string>>& mirrors : {std::vector<std::vector<std::string>>{}, {{"x"}}}) {
    const System s{{"x"}, {"(p + q^2)*x + (c - q)*x^3 - x^5"}, {{"p", -1.0}, {"c", 1.0}, {"q", 0.3}}, mirrors};
    const auto curves = chart(s, {"p", "q"}, ranges(-3.0, 1.0, -1.0, 2.0), {0.0, -1.0});
    CAPTURE(mirrors.size());
    const auto degenerate = of_type(curves, "DP");
    REQUIRE(degenerate.size() >= 1);
    for (const auto& z : degenerate) CHECK((z.u - Eigen::Vector3d(0.0, -1.0, 1.0)).norm() < 1e-9);
    int folds = 0;
    for (const auto& c : curves) {
      if (c.type != EventType::fold) continue;
      ++folds;
      if (!mirrors.empty()) CHECK(c.special.empty());
      for (const auto& z : c.special) {  // without the symmetry it passes the degenerate point, which is no cusp, and turns there
        CHECK((z.type == "DP" || z.type == "MIN" || z.type == "MAX"));
        CHECK((z.u - degenerate[0].u).norm() < 1e-3);
      }
      for (Eigen::Index i = 0; i < c.u.cols(); ++i) {
        const double p = c.u(1, i), q = c.u(2, i);
        CHECK(std::abs(p + q * q + 0.25 * (1.0 - q) * (1.0 - q)) < 1e-9);
      }
    }
    CHECK(folds == 1);
  }
}

TEST_CASE("a closed curve of special points, and ends exactly on the bounds") {
  // folds of (x - 1)^3 / 3 ... : x' = p - h(x, q), h_x = (x - 1)^2 + q^2 - 1/4 vanishes on a circle
  const System s{{"x"}, {"p - (x-1)^3/3 - (q^2 - 0.25)*x"}, {{"p", -1.0}, {"q", 0.1}}};
  auto curves = chart(s, {"p", "q"}, ranges(-1.0, 1.0, -1.0, 1.0), {0.0, -1.0});
  REQUIRE(curves.size() == 1);
  CHECK(curves[0].stop_reason == StopReason::closed_loop);
  CHECK(of_type(curves, "CP").size() == 2);  // where both folds meet, q = +-1/2 ... x = 1
  for (const auto& z : of_type(curves, "CP")) CHECK(std::abs(std::abs(z.u[2]) - 0.5) < 1e-9);
  curves = chart(s, {"p", "q"}, ranges(-1.0, 1.0, -0.3, 0.4), {0.0, -1.0});
  for (const auto& c : curves)
    for (const Eigen::Index i : {Eigen::Index{0}, c.u.cols() - 1}) CHECK((c.u(2, i) == -0.3 || c.u(2, i) == 0.4));
}

TEST_CASE("a branch point that dissolves with the second parameter lies on a curve of folds") {
  // q + p x - x^3: 27 q^2 = 4 p^3 with its cusp where the pitchfork was; q + p x - x^2: p^2 = -4 q
  const struct {
    const char* rhs;
    double (*relation)(double p, double q);
    std::size_t cusps;
  } cases[] = {{"p*x - x^3 + q", [](double p, double q) { return 27.0 * q * q - 4.0 * p * p * p; }, 1},
               {"p*x - x^2 + q", [](double p, double q) { return p * p + 4.0 * q; }, 0}};
  for (const auto& c : cases) {
    const System s{{"x"}, {c.rhs}, {{"p", -1.0}, {"q", 0.0}}};
    const auto curves = chart(s, {"p", "q"}, ranges(-1.0, 1.0, -1.0, 1.0), {0.0, -1.0});
    CAPTURE(c.rhs);
    REQUIRE(curves.size() == 1);
    CHECK(curves[0].type == EventType::fold);
    CHECK(curves[0].u.cols() > 20);
    for (Eigen::Index i = 0; i < curves[0].u.cols(); ++i) CHECK(std::abs(c.relation(curves[0].u(1, i), curves[0].u(2, i))) < 1e-9);
    const auto cusps = of_type(curves, "CP");
    REQUIRE(cusps.size() == c.cusps);
    for (const auto& z : cusps) CHECK(z.u.norm() < 1e-9);
  }
}

TEST_CASE("Hopf points of the Brusselator on a line, eight cells", "[published]") {
  // Mode k of the differences grows where (Dx + Dy) s_k / L^2 = B - 1 - A^2, s_k = 4 (N + 1)^2 sin^2(k pi / (2 N + 2)): a closed form in L.
  constexpr int N = 8;
  const double A = 2.0, B = 5.4, Dx = 0.008, Dy = 0.004, pi = std::acos(-1.0);
  System s;
  s.parameters = {{"A", A}, {"B", B}, {"L", 0.5}, {"cx", Dx * (N + 1) * (N + 1)}, {"cy", Dy * (N + 1) * (N + 1)}};
  const auto cell = [](const char* name, int i, const char* wall) { return i < 0 || i >= N ? std::string(wall) : name + std::to_string(i); };
  for (const char* name : {"x", "y"})
    for (int i = 0; i < N; ++i) {
      const bool first = name[0] == 'x';
      const std::string x = cell("x", i, ""), y = cell("y", i, ""), wall = first ? "A" : "B/A", at = cell(name, i, "");
      const std::string spread = std::string(first ? "cx" : "cy") + "/L^2*(" + cell(name, i - 1, wall.c_str()) + " - 2*" + at + " + " +
                                 cell(name, i + 1, wall.c_str()) + ")";
      s.variables.push_back(at);
      s.rhs.push_back((first ? "A - (B+1)*" + x + " + " : "B*" + x + " - ") + x + "^2*" + y + " + " + spread);
    }
  std::vector<double> rest(N, A);
  rest.insert(rest.end(), N, B / A);
  rest.push_back(0.5);
  const auto all = branches(s, "L", 0.4, 1.3, {rest});
  CHECK(sound(all));
  std::vector<double> wanted;
  for (int k = 1; k <= 2; ++k) wanted.push_back(2.0 * (N + 1) * std::sin(k * pi / (2.0 * N + 2.0)) * std::sqrt((Dx + Dy) / (B - 1.0 - A * A)));
  const auto found = text_model::values(all, EventType::hopf);
  REQUIRE(found.size() == wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(std::abs(found[i] - wanted[i]) < 1e-10);
}

TEST_CASE("where curves of folds and of pitchforks cross") {
  // y breaks on either half of a parabola with its fold at mu = 0: x = -nu, mu = nu^2.
  const System parabola{{"x", "y"}, {"mu - x^2 - 0.3*y^2", "(nu + x)*y - y^3"}, {{"mu", 1.0}, {"nu", 0.5}}, {{"y"}}};
  // x breaks at p = 0, y at p = d
  const System two{{"x", "y"}, {"p*x - x^3 - 1.5*x*y^2", "(p-d)*y - y^3 - 0.5*y*x^2"}, {{"p", -0.5}, {"d", 0.3}}, {{"x"}, {"y"}}};
  const struct {
    const System& system;
    const char *first, *second, *type;
    double p2;
    Vector start;
  } cases[] = {{parabola, "mu", "nu", "FP", 0.5, Eigen::Vector3d(1.0, 0.0, 1.0)}, {two, "p", "d", "PP", 0.3, Eigen::Vector3d(0.0, 0.0, -0.5)}};
  for (const auto& c : cases) {
    const EquilibriumFlow f = c.system.flow({c.first}), f2 = c.system.flow({c.first, c.second});
    const Branch b = Walker(f, {.lower = -1.0, .upper = 1.0}).walk(c.start);
    REQUIRE(b.special.size() == 2);
    for (const auto& s : b.special) {
      const DefiningCurve curve = follow(f2, s, c.p2, {.range1 = {-1.0, 1.0}, .range2 = {-0.9, 0.9}});
      CAPTURE(c.type, to_string(s.type));
      REQUIRE(std::count_if(curve.special.begin(), curve.special.end(), [&](const auto& z) { return z.type == c.type; }) == 1);
      for (const auto& z : curve.special)
        if (z.type == c.type) CHECK(z.u.norm() < 1e-9);
    }
  }
}
