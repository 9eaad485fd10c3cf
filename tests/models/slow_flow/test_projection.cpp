// What the generated averaged equations are: against the harmonic balance, the superharmonic flow, and the term lists derived by hand.
#include <catch2/catch.hpp>
#include <random>

#include "models/slow_flow/combinatorial_printed.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

ParametricSystem stay_over_omega(Terms terms = Terms::reduced) { return stay_system(oresund(), {Lens("omega")}, terms, Coefficients::exact); }
const std::vector<CoordinateReflection> whirling = {{{-1, 1}, "WH"}};

Vector somewhere(const Problem& f, In p, double size = 1.0) {
  Vector u(f.size() + f.parameters());
  for (int i = 0; i < f.size(); ++i) u[i] = size * std::sin(1.7 + 2.9 * i) / (1.0 + 0.2 * i);
  u.tail(f.parameters()) = p;
  return u;
}

// Fourth-order difference of f along d.
template <class F>
Matrix slope(F f, const Vector& u, const Vector& d, double h) {
  return (8.0 * (f(u + h * d) - f(u - h * d)) - (f(u + 2.0 * h * d) - f(u - 2.0 * h * d))) / (12.0 * h);
}

Matrix jacobian_of(const Problem& f, const Vector& u) {
  Matrix j(f.size(), f.size() + f.parameters());
  f.jacobian(u, j);
  return j;
}

template <class Flow>
void check_derivatives(const Flow& flow, const Vector& p) {
  const int n = flow.size(), m = n + flow.parameters();
  const Vector u = somewhere(flow, p);
  const DualProblem<std::decay_t<decltype(flow.model())>> by_duals(flow.model(), n, flow.parameters(), true);
  const Problem& dual = by_duals;
  const Matrix j = jacobian_of(flow, u);
  CHECK((j - jacobian_of(dual, u)).lpNorm<Eigen::Infinity>() < 1e-13 * j.lpNorm<Eigen::Infinity>());  // rounding
  Vector r(n), again(n);
  Matrix with(n, m);
  flow.residual(u, r);
  flow.linearise(u, again, with);
  CHECK((r - again).lpNorm<Eigen::Infinity>() < 1e-13 * r.lpNorm<Eigen::Infinity>());
  Vector v(m), w(m);
  for (int i = 0; i < m; ++i) v[i] = std::cos(0.3 + 1.3 * i), w[i] = std::sin(0.7 * i);
  v.tail(flow.parameters()).array() *= p.array().abs();
  w.tail(flow.parameters()).array() *= p.array().abs();
  Matrix s(n, m);
  flow.second(u, v, s);
  const auto second = [&](const Vector& x) {
    Matrix h(n, m);
    flow.second(x, v, h);
    return h;
  };
  // Differences of fourth order, step 1e-3 of every number.
  const Matrix differences = slope([&](const Vector& x) { return jacobian_of(flow, x); }, u, v, 1e-3);
  CHECK((s - differences).lpNorm<Eigen::Infinity>() < 1e-8 * s.lpNorm<Eigen::Infinity>());
  Vector t(n);
  flow.third(u, v, w, w, t);
  const Vector reference = slope(second, u, w, 1e-3) * w;
  CHECK((t - reference).lpNorm<Eigen::Infinity>() < 1e-8 * reference.lpNorm<Eigen::Infinity>());
}

Vector numbers(std::initializer_list<double> values) { return point(values); }

// Complex projection of the terms alone: 2 <b e^{-i k w t}>, the mean for k = 0, by undoing the linear part and the scale of the flow.
std::complex<double> projected(const SlowFlow& flow, const Vector& u, int i, int k) {
  const auto system = flow.system_at(u);
  Vector r(flow.size());
  flow.residual(u, r);
  const int row = flow.ansatz().index(i, k);
  const double K = system.stiffness[std::size_t(i)], c = system.damping[std::size_t(i)], speed = k * system.omega / flow.ansatz().nu;
  double force = 0.0;
  for (const auto& f : system.forces)
    if (f.equation == i && f.harmonic * flow.ansatz().nu == k) force += f.amplitude;
  if (k == 0) return -r[row] * mean_rate(c, system.omega) - K * u[row] + force;
  const std::complex<double> R = std::complex<double>(r[row], r[row + 1]) * 2.0 * speed / std::complex<double>(0.0, 1.0);
  return R - std::complex<double>(K - speed * speed, c * speed) * amplitude(flow.ansatz(), u, i, k) + force;
}

struct HandTerm {
  double amplitude;  // coefficient times amplitudes [m/s^2]
  double phase;      // x of cos(x) in 2 <b cos theta>, sign so that 2 <b sin theta> has -sin(x)
};

// sum of amplitude e^{i x} is 2 <b e^{-i theta}>, theta the phase of the harmonic with its own phase in it.
std::complex<double> sum(const std::vector<HandTerm>& terms, double own_phase) {
  std::complex<double> s = 0.0;
  for (const auto& t : terms) s += std::polar(t.amplitude, t.phase);
  return s * std::polar(1.0, own_phase);
}

struct Couplings {
  double b1, b2, g1, g2, g3, g4;
};
Couplings couplings() {
  const auto stay = oresund();
  const auto m = stay_model(stay.cable, Coefficients::exact);
  const double K = stiffness_rate(stay.cable), L = stay.cable.chord_length, e = stay.support_amplitude / L * std::cos(30.4 * pi / 180.0);
  const auto& k = m.coefficients;
  return {0.5 * K * e * k.c1, 0.5 * K * e * k.c2, 0.75 * K * k.G1 / L / L, 0.25 * K * k.G2 / L / L, 0.25 * K * k.G3 / L / L, 0.75 * K * k.G4 / L / L};
}

constexpr double rounding = 1e-12;  // of sums of some twenty terms

void check_same(std::complex<double> a, std::complex<double> b) { CHECK(std::abs(a - b) < rounding * (1.0 + std::abs(a))); }

}  // namespace

TEST_CASE("slow flow: an ansatz from fractions of omega") {
  const Ansatz a = Ansatz::list({{1.5, 0.5}, {0, 2, 1}});
  CHECK(a.nu == 2);
  CHECK(a.harmonics == std::vector<std::vector<int>>{{1, 3}, {0, 2, 4}});
  CHECK(a.size() == 9);
  CHECK(a.index(1, 0) == 4);
  CHECK(a.index(1, 4) == 7);
  CHECK(a.index(0, 2) == -1);
  CHECK(Ansatz::list({{1.0 / 3.0}, {2.0 / 3.0, 0.5}}).nu == 6);
  CHECK(Ansatz::complete(2, 4, 2).size() == 18);
  CHECK_THROWS_AS(Ansatz::list({{}, {}}), std::invalid_argument);
  CHECK_THROWS_AS(Ansatz::list({{1, 1}}), std::invalid_argument);
  CHECK_THROWS_AS(Ansatz::list({{-1}}), std::invalid_argument);
  CHECK_THROWS_AS(Ansatz::list({{0.123456789}}), std::invalid_argument);
  CHECK_THROWS_AS(SlowFlow(stay_over_omega(), Ansatz::list({{1}})), std::invalid_argument);
  CHECK_THROWS_AS(SlowFlow(stay_over_omega(), Ansatz::complete(2, 2), {{{-1, -1}, "??"}}), std::invalid_argument);
}

TEST_CASE("slow flow: derivatives are exact") {
  check_derivatives(SlowFlow(stay_over_omega(), Ansatz::combinatorial_coupled()), numbers({2.1}));
  check_derivatives(
      SlowFlow(stay_system(oresund(), {Lens("omega"), Lens("support_amplitude")}, Terms::full, Coefficients::exact), Ansatz::complete(2, 3, 2)),
      numbers({2.1, 0.5}));
  check_derivatives(
      SlowFlow(stay_system(oresund(), {Lens("damping.in_plane"), Lens("omega")}, Terms::reduced, Coefficients::exact), Ansatz::superharmonic(2, 2)),
      numbers({0.01, 1.6}));
  check_derivatives(SlowFlow(stay_system(oresund(), {Lens("omega")}, Terms::full, Coefficients::exact), Ansatz::list({{0, 2}, {0, 2}}, true)),
                    numbers({1.6}));
  const auto two = stay_system(oresund(), {Lens("support_amplitude"), Lens("omega")}, Terms::reduced, Coefficients::exact);
  check_derivatives(PrintedCombinatorialFlow(two, CombinatorialMotion::coupled), numbers({0.5, 2.1}));
  check_derivatives(PrintedCombinatorialFlow(two, CombinatorialMotion::in_plane), numbers({0.5, 2.1}));
}

TEST_CASE("slow flow: the complete ansatz is the harmonic balance, row by row") {
  for (const Terms terms : {Terms::reduced, Terms::full}) {
    const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 5, .nu = 2}, terms);
    const SlowFlow flow(stay_over_omega(terms), Ansatz::complete(2, 5, 2));
    const Vector u = somewhere(flow, numbers({2.1}));
    Vector x(hb.size() + 1), balance(hb.size()), r(flow.size());
    x.tail(1) = u.tail(1);
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k <= 5; ++k) {
        x[hb.index(i, k)] = u[flow.ansatz().index(i, k)];
        if (k > 0) x[hb.index(i, k) + 1] = -u[flow.ansatz().index(i, k) + 1];
      }
    hb.residual(x, balance);
    flow.residual(u, r);
    const auto system = flow.system_at(u);
    for (int i = 0; i < 2; ++i) {
      CHECK(-r[flow.ansatz().index(i, 0)] * mean_rate(system.damping[std::size_t(i)], 2.1) == Approx(balance[hb.index(i, 0)]).epsilon(rounding));
      for (int k = 1; k <= 5; ++k) {  // u' = sine row / 2kw, v' = cosine row / 2kw
        CHECK(r[flow.ansatz().index(i, k)] * k * 2.1 == Approx(balance[hb.index(i, k) + 1]).epsilon(rounding).margin(1e-12));
        CHECK(r[flow.ansatz().index(i, k) + 1] * k * 2.1 == Approx(balance[hb.index(i, k)]).epsilon(rounding).margin(1e-12));
      }
    }
    for (const double t : {0.0, 0.7, 2.9}) CHECK((hb.state_at(x, t) - flow.motion(u, t)).norm() < 1e-12);
  }
}

TEST_CASE("slow flow: n omega with the linear response frozen is the superharmonic flow (41)") {
  for (const int order : {2, 3, 4}) {
    const auto stay = oresund(0.5, 3.3 / order);
    const std::vector<Lens> lenses = {Lens("omega"), Lens("support_amplitude")};
    const SuperharmonicFlow known(stay, {.order = order}, lenses);
    const SlowFlow flow(stay_system(stay, lenses, Terms::reduced, Coefficients::exact), Ansatz::superharmonic(2, order), whirling);
    REQUIRE(flow.size() == 4);
    REQUIRE(flow.reflections().size() == 1);
    CHECK(flow.reflections()[0].subtype == "WH");
    CHECK(flow.reflections()[0].signs == known.reflections()[0].signs);
    const Vector u = somewhere(flow, numbers({3.3 / order, 0.5}), 4.0);
    Vector a(4), b(4);
    known.residual(u, a);
    flow.residual(u, b);
    CHECK((a - b).norm() < rounding * a.norm());
    CHECK((jacobian_of(known, u) - jacobian_of(flow, u)).norm() < rounding * jacobian_of(known, u).norm());
    for (const double t : {0.0, 1.3}) CHECK((known.motion(u, t) - flow.motion(u, t)).norm() < rounding * 10.0);
  }
}

TEST_CASE("slow flow: the coupled combinatorial response, every projected term") {
  const SlowFlow flow(stay_over_omega(), Ansatz::combinatorial_coupled(), whirling);
  const auto [b1, b2, g1, g2, g3, g4] = couplings();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> length(-3.0, 3.0), angle(-pi, pi);
  for (int trial = 0; trial < 20; ++trial) {
    const double A1 = std::abs(length(random)), A2 = std::abs(length(random)), B0 = length(random), B1 = std::abs(length(random)),
                 B2 = std::abs(length(random));
    const double F1 = angle(random), F2 = angle(random), P1 = angle(random), P2 = angle(random);
    Vector u(10);
    u << A1 * std::cos(F1), A1 * std::sin(F1), A2 * std::cos(F2), A2 * std::sin(F2), B0, B1 * std::cos(P1), B1 * std::sin(P1), B2 * std::cos(P2),
        B2 * std::sin(P2), 2.1;
    // First the terms the paper keeps, then those it drops.
    const std::vector<HandTerm> kept[5] = {
        {{g1 * A1 * A1 * A1, 0},
         {2 * g1 * A1 * A2 * A2, 0},
         {4 * g2 * A1 * B0 * B0, 0},
         {2 * g2 * A1 * B1 * B1, 0},
         {2 * g2 * A1 * B2 * B2, 0},
         {b1 * A1, -2 * F1},
         {b1 * A2, F2 - F1}},
        {{g1 * A2 * A2 * A2, 0},
         {2 * g1 * A1 * A1 * A2, 0},
         {4 * g2 * A2 * B0 * B0, 0},
         {2 * g2 * A2 * B1 * B1, 0},
         {2 * g2 * A2 * B2 * B2, 0},
         {b1 * A1, F1 - F2}},
        {{2 * b2 * B1, P1},
         {8.0 / 3.0 * g4 * B0 * B0 * B0, 0},
         {4 * g4 * B0 * B1 * B1, 0},
         {4 * g4 * B0 * B2 * B2, 0},
         {4 * g3 * B0 * (A1 * A1 + A2 * A2), 0}},
        {{g4 * B1 * B1 * B1, 0},
         {4 * g4 * B0 * B0 * B1, 0},
         {2 * g4 * B1 * B2 * B2, 0},
         {2 * g3 * B1 * (A1 * A1 + A2 * A2), 0},
         {2 * b2 * B0, -P1},
         {b2 * B2, P2 - P1}},
        {{g4 * B2 * B2 * B2, 0}, {4 * g4 * B0 * B0 * B2, 0}, {2 * g4 * B1 * B1 * B2, 0}, {2 * g3 * B2 * (A1 * A1 + A2 * A2), 0}, {b2 * B1, P1 - P2}}};
    const std::vector<HandTerm> dropped[5] = {{{g1 * A1 * A1 * A2, F2 - 3 * F1},
                                               {4 * g2 * A1 * B0 * B1, P1 - 2 * F1},
                                               {2 * g2 * A1 * B1 * B2, P2 - P1 - 2 * F1},
                                               {4 * g2 * A2 * B0 * B1, F2 - F1 - P1},
                                               {4 * g2 * A2 * B0 * B2, P2 - F1 - F2},
                                               {g2 * A2 * B1 * B1, 2 * P1 - F1 - F2},
                                               {2 * g2 * A2 * B1 * B2, F2 - F1 + P1 - P2}},
                                              {{g1 / 3 * A1 * A1 * A1, 3 * F1 - F2},
                                               {4 * g2 * A1 * B0 * B1, F1 - F2 + P1},
                                               {4 * g2 * A1 * B0 * B2, P2 - F1 - F2},
                                               {g2 * A1 * B1 * B1, 2 * P1 - F1 - F2},
                                               {2 * g2 * A1 * B1 * B2, F1 - F2 - P1 + P2},
                                               {2 * g2 * A2 * B1 * B2, P1 + P2 - 2 * F2}},
                                              {{2 * g3 * A1 * A1 * B1, 2 * F1 - P1},
                                               {4 * g3 * A1 * A2 * B1, F2 - F1 - P1},
                                               {4 * g3 * A1 * A2 * B2, F1 + F2 - P2},
                                               {2 * g4 * B1 * B1 * B2, 2 * P1 - P2}},
                                              {{4 * g4 * B0 * B1 * B2, P2 - 2 * P1},
                                               {2 * g3 * A1 * A1 * B0, 2 * F1 - P1},
                                               {g3 * A1 * A1 * B2, P2 - P1 - 2 * F1},
                                               {4 * g3 * A1 * A2 * B0, F2 - F1 - P1},
                                               {2 * g3 * A1 * A2 * B1, F1 + F2 - 2 * P1},
                                               {2 * g3 * A1 * A2 * B2, F1 - F2 - P1 + P2},
                                               {g3 * A2 * A2 * B2, 2 * F2 - P1 - P2}},
                                              {{2 * g4 * B0 * B1 * B1, 2 * P1 - P2},
                                               {g3 * A1 * A1 * B1, 2 * F1 + P1 - P2},
                                               {4 * g3 * A1 * A2 * B0, F1 + F2 - P2},
                                               {2 * g3 * A1 * A2 * B1, F2 - F1 + P1 - P2},
                                               {g3 * A2 * A2 * B1, 2 * F2 - P1 - P2}}};
    const double phase[5] = {F1, F2, 0, P1, P2};
    const int coordinate[5] = {0, 0, 1, 1, 1}, harmonic[5] = {1, 3, 0, 2, 4};
    for (int h = 0; h < 5; ++h) {
      INFO("harmonic " << h << " of trial " << trial);
      std::complex<double> whole = sum(kept[h], phase[h]) + sum(dropped[h], phase[h]);
      if (harmonic[h] == 0) whole = 0.5 * whole.real();  // the list holds 2 <b>
      check_same(projected(flow, u, coordinate[h], harmonic[h]), whole);
    }
    // The printed equations are the kept terms: what they lack of the full flow are the dropped ones.
    const PrintedCombinatorialFlow printed(stay_over_omega(), CombinatorialMotion::coupled);
    Vector full(9), truncated(9);
    flow.residual(u, full);
    printed.residual(u, truncated);
    const Vector lacking = full - truncated;
    for (int h = 0; h < 5; ++h) {
      const int row = flow.ansatz().index(coordinate[h], harmonic[h]);
      const std::complex<double> d = sum(dropped[h], phase[h]);
      if (harmonic[h] == 0) {
        CHECK(lacking[row] == Approx(-0.5 * d.real() / mean_rate(0.02 * 3.2007293317, 2.1)).epsilon(1e-10));  // w2 to its printed digits
      } else {
        const std::complex<double> rate = std::complex<double>(0.0, 1.0) * d / (harmonic[h] * 2.1);
        check_same({lacking[row], lacking[row + 1]}, rate);
      }
    }
  }
}

TEST_CASE("slow flow: the in-plane combinatorial response, every projected term") {
  const SlowFlow flow(stay_over_omega(), Ansatz::combinatorial_in_plane(), whirling);
  const PrintedCombinatorialFlow printed(stay_over_omega(), CombinatorialMotion::in_plane);
  const auto [b1, b2, g1, g2, g3, g4] = couplings();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> length(0.1, 3.0), angle(-pi, pi);
  for (int trial = 0; trial < 20; ++trial) {
    const double B1 = length(random), B2 = length(random), B3 = length(random), P1 = angle(random), P2 = angle(random), P3 = angle(random);
    Vector u(7);
    u << B1 * std::cos(P1), B1 * std::sin(P1), B2 * std::cos(P2), B2 * std::sin(P2), B3 * std::cos(P3), B3 * std::sin(P3), 2.1;
    const std::vector<HandTerm> kept[3] = {
        {{g4 * B1 * B1 * B1, 0}, {2 * g4 * B1 * B2 * B2, 0}, {2 * g4 * B1 * B3 * B3, 0}, {b2 * B1, -2 * P1}, {b2 * B3, P3 - P1}},
        {{g4 * B2 * B2 * B2, 0}, {2 * g4 * B1 * B1 * B2, 0}, {2 * g4 * B2 * B3 * B3, 0}, {2 * g4 * B1 * B2 * B3, P1 - 2 * P2 + P3}},
        {{g4 * B3 * B3 * B3, 0}, {2 * g4 * B1 * B1 * B3, 0}, {2 * g4 * B2 * B2 * B3, 0}, {b2 * B1, P1 - P3}}};
    const std::vector<HandTerm> dropped[3] = {{{g4 * B1 * B1 * B3, P3 - 3 * P1}, {g4 * B2 * B2 * B3, 2 * P2 - P1 - P3}},
                                              {},
                                              {{g4 / 3 * B1 * B1 * B1, 3 * P1 - P3}, {g4 * B1 * B2 * B2, 2 * P2 - P1 - P3}}};
    const double phase[3] = {P1, P2, P3};
    Vector full(6), truncated(6);
    flow.residual(u, full);
    printed.residual(u, truncated);
    const Vector lacking = full - truncated;
    for (int h = 0; h < 3; ++h) {
      INFO("harmonic " << h << " of trial " << trial);
      check_same(projected(flow, u, 1, h + 1), sum(kept[h], phase[h]) + sum(dropped[h], phase[h]));
      check_same({lacking[2 * h], lacking[2 * h + 1]}, std::complex<double>(0.0, 1.0) * sum(dropped[h], phase[h]) / ((h + 1) * 2.1));
    }
  }
  CHECK_THROWS_AS(PrintedCombinatorialFlow(stay_over_omega(Terms::full), CombinatorialMotion::coupled), std::invalid_argument);
}

TEST_CASE("slow flow: symmetries") {
  const auto names = [](const Problem& f) {
    std::vector<std::string> list;
    for (const auto& r : f.reflections()) list.push_back(r.subtype);
    return list;
  };
  using Names = std::vector<std::string>;
  CHECK(names(SlowFlow(stay_over_omega(), Ansatz::complete(2, 3), whirling)) == Names{"WH"});
  CHECK(names(SlowFlow(stay_over_omega(), Ansatz::complete(2, 3, 2), whirling)) == Names{"WH", "PD", "SB"});
  CHECK(names(SlowFlow(stay_over_omega(), Ansatz::combinatorial_coupled(), whirling)) == Names{"WH"});  // the shift does the same
  CHECK(names(SlowFlow(stay_over_omega(), Ansatz::combinatorial_in_plane(), whirling)) == Names{"PD"});
  CHECK(names(PrintedCombinatorialFlow(stay_over_omega(), CombinatorialMotion::coupled)) == Names{"WH"});
  CHECK(names(PrintedCombinatorialFlow(stay_over_omega(), CombinatorialMotion::in_plane)) == Names{"PD"});
  // r(S x) = S r(x), and what a symmetry forbids stays zero to the last bit.
  for (const auto& ansatz : {Ansatz::complete(2, 4, 2), Ansatz::combinatorial_coupled(), Ansatz::combinatorial_in_plane()}) {
    const SlowFlow flow(stay_over_omega(), ansatz, whirling);
    for (const auto& reflection : flow.reflections()) {
      const int n = flow.size();
      Vector u = somewhere(flow, numbers({2.1})), mirrored = u, r(n), s(n);
      mirrored.head(n).array() *= reflection.signs.array();
      flow.residual(u, r);
      flow.residual(mirrored, s);
      CHECK((s.array() - r.array() * reflection.signs.array()).abs().maxCoeff() < rounding * r.lpNorm<Eigen::Infinity>());
      for (int i = 0; i < n; ++i)
        if (reflection.signs[i] < 0.0) u[i] = 0.0;
      const Matrix j = jacobian_of(flow, u);
      flow.residual(u, r);
      for (int a = 0; a < n; ++a) {
        if (reflection.signs[a] < 0.0 && reflection.subtype != "SB") REQUIRE(r[a] == 0.0);
        for (int b = 0; b < n; ++b)
          if (reflection.signs[a] != reflection.signs[b] && reflection.subtype != "SB") REQUIRE(j(a, b) == 0.0);
      }
    }
  }
}
