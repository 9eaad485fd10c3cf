#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <numbers>

#include "core/newton.hpp"
#include "models/closed_forms.hpp"
#include "models/steady_motion.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

// The harmonic balance of the ansatz done by brute force: project the reduced modal equations on cos(n w t), sin(n w t).
Eigen::Vector4d projected(const StayParameters<double>& stay, int n, const Vector& u) {
  const auto model = stay_model(stay.cable, Coefficients::exact);
  const auto s = nielsen_kirkegaard(stay, model, Terms::reduced);
  const SuperharmonicFlow flow(stay, {.order = n}, {Lens("omega")});
  const double w = stay.omega;
  const int samples = 64 * n;
  Eigen::Vector4d sums = Eigen::Vector4d::Zero();
  for (int i = 0; i < samples; ++i) {
    const double phase = 2.0 * std::numbers::pi * i / samples;
    const Vector y = flow.motion(u, phase / w);
    std::array<double, 2> b;
    s.coupling<double>(std::array<double, 2>{y[0], y[1]}, phase, b);
    for (int a = 0; a < 2; ++a) {
      sums[2 * a] += 2.0 / samples * b[std::size_t(a)] * std::cos(n * phase);
      sums[2 * a + 1] += 2.0 / samples * b[std::size_t(a)] * std::sin(n * phase);
    }
  }
  // q = u cos - v sin: 2 n w v' = (k - n^2 w^2) u + d v.. in the slowly varying limit; see superharmonic.hpp
  Eigen::Vector4d r;
  for (int a = 0; a < 2; ++a) {
    const double k = s.stiffness[std::size_t(a)], nw = n * w, d = s.damping[std::size_t(a)] * nw, U = u[2 * a], V = u[2 * a + 1];
    r[2 * a] = (-d * U - (k - nw * nw) * V + sums[2 * a + 1]) / (2.0 * nw);
    r[2 * a + 1] = (-d * V + (k - nw * nw) * U + sums[2 * a]) / (2.0 * nw);
  }
  return r;
}

}  // namespace

TEST_CASE("the slow flow is the harmonic projection of the modal equations") {
  // Orders 2 and 3 carry the forcing of (45). From n = 4 on there is none at this order.
  for (const int n : {2, 3, 4, 5}) {
    const auto stay = oresund(0.5, 3.17 / n);
    const SuperharmonicFlow flow(stay, {.order = n}, {Lens("omega")});
    for (const auto& u : {point({0.3, -0.7, 1.1, 0.4, stay.omega}), point({-2.0, 1.0, 3.0, -2.5, stay.omega})}) {
      Vector r(4);
      flow.residual(u, r);
      const Eigen::Vector4d p = projected(stay, n, u);
      for (int i = 0; i < 4; ++i) {
        INFO("n = " << n << ", component " << i);
        CHECK(r[i] == Approx(p[i]).epsilon(1e-11).margin(1e-12));  // sums of 128 and more samples
      }
    }
  }
}

TEST_CASE("hand-written Jacobian and second derivative equal the dual ones, in every lens") {
  for (const auto& name : Lens::names()) {
    const Lens lens(name);
    const auto stay = oresund();
    const SuperharmonicFlow flow(stay, {.order = 2}, {lens});
    const DualProblem<SuperharmonicModel> dual(SuperharmonicModel(stay, {.order = 2}, {lens}), 4, 1, true);
    const Vector u = point({0.3, -0.7, 1.1, 0.4, lens.get(stay)});
    Matrix j(4, 5), k(4, 5);
    Vector r(4), s(4);
    flow.linearise(u, r, j);
    dual.linearise(u, s, k);
    INFO(name);
    CHECK((j - k).lpNorm<Eigen::Infinity>() < 1e-12 * (1.0 + k.lpNorm<Eigen::Infinity>()));
    CHECK((r - s).norm() < 1e-13 * (1.0 + s.norm()));
    const Vector along = point({0.5, 1.3, -0.8, 0.9, 0.7});
    Matrix h2(4, 5), k2(4, 5);
    flow.second(u, along, h2);
    dual.second(u, along, k2);
    CHECK((h2 - k2).lpNorm<Eigen::Infinity>() < 1e-12 * (1.0 + k2.lpNorm<Eigen::Infinity>()));
    // and the column of the parameter equals a central difference
    const double p = u[4], h = 1e-5 * (std::abs(p) + 1e-3);
    Vector up = u, down = u, rp(4), rm(4);
    up[4] = p + h;
    down[4] = p - h;
    flow.residual(up, rp);
    flow.residual(down, rm);
    CHECK((j.col(4) - (rp - rm) / (2.0 * h)).norm() < 1e-7 * (1.0 + j.col(4).norm()));
  }
  CHECK_THROWS_WITH(Lens("tensoin"), Catch::Contains("no parameter 'tensoin'"));
}

TEST_CASE("a lens reads what it sets") {
  auto stay = oresund();
  for (const auto& name : Lens::names()) {
    const Lens lens(name);
    lens.set(stay, 0.123);
    CHECK(lens.get(stay) == 0.123);
  }
}

TEST_CASE("the field is mirror symmetric in q1") {
  const SuperharmonicFlow flow(oresund(), {.order = 2}, {Lens("omega")});
  Vector a(4), b(4);
  flow.residual(point({0.3, -0.7, 1.1, 0.4, 1.8}), a);
  flow.residual(point({-0.3, 0.7, 1.1, 0.4, 1.8}), b);
  CHECK(a.head(2) == -b.head(2));
  CHECK(a.tail(2) == b.tail(2));
}

TEST_CASE("closed forms give all steady states") {
  const SuperharmonicFlow flow(oresund(), {.order = 2}, {Lens("omega")});
  const auto at = [&](double w) { return flow.model().coefficients<double>(std::array<double, 1>{w}); };
  std::vector<double> B;
  for (const auto& x : in_plane_states(at(1.8))) B.push_back(x.norm());
  std::sort(B.rbegin(), B.rend());
  REQUIRE(B.size() == 3);
  CHECK(B[0] == Approx(4.401911427).epsilon(2e-10));    // half a unit of the last printed digit
  CHECK(B[1] == Approx(3.03928378421).epsilon(2e-11));  // AUTO-07p and an independent Newton agree to these digits
  CHECK(B[2] == Approx(1.419078420).epsilon(4e-10));
  for (int i = 0; i <= 60; ++i) {
    const double w = 1.2 + 0.02 * i;
    for (const auto& states : {in_plane_states(at(w)), coupled_states(at(w))})
      for (const auto& x : states) {
        Vector u(5), r(4);
        u << x, w;
        flow.residual(u, r);
        CHECK(r.norm() < 1e-10);  // rounding of a polynomial of degree 8, polished
      }
  }
}

TEST_CASE("no steady state is missed by the closed forms") {
  // Newton from 4000 scattered starts finds nothing that is not listed.
  const SuperharmonicFlow flow(oresund(), {.order = 2}, {Lens("omega")});
  for (const double w : {1.7, 1.95, 2.1}) {
    const auto c = flow.model().coefficients<double>(std::array<double, 1>{w});
    auto states = in_plane_states(c);
    for (const auto& x : coupled_states(c)) {
      states.push_back(x);
      states.emplace_back(-x[0], -x[1], x[2], x[3]);
    }
    std::srand(7);
    std::size_t hits = 0;
    for (int i = 0; i < 4000; ++i) {
      Vector u(5);
      u << 9.0 * Eigen::Vector4d::Random(), w;
      const auto r = newton(flow, u);
      if (!r.ok()) continue;
      ++hits;
      const bool listed = std::any_of(states.begin(), states.end(), [&](const auto& x) { return (x - r.x.head(4)).norm() < 1e-7; });
      CHECK(listed);
    }
    CHECK(hits > 1000);
  }
}

TEST_CASE("steady states and stability agree with AUTO-07p on the Oresund stay") {
  // omega, u1, v1, u2, v2, unstable directions, first eigenvalue: U = 0.5 m, zeta = 0.01 (X, Y of the averaged equations, 12 digits)
  const double rows[][7] = {
      {1.6, 0, 0, 2.34913227276, -0.449577632, 0, -0.0314761321417},
      {1.7, 0, 0, 3.30442260447, -0.932508681874, 1, 0.0485582792458},
      {2.0, 0, 0, 5.3191231596, -2.96262821178, 0, -0.0314761321417},
      {1.7, 1.44765566603, 2.03461762177, 2.87167621365, -1.23578902982, 0, -0.0315123237614},
      {1.9, 3.54632910508, 2.83930587002, 3.20349438033, -3.20254250101, 0, -0.0316803893251},
      {2.1, 5.41652551437, -2.82733760044, -2.11828641972, -5.04292580102, 1, 0.121435314268},
  };
  const SuperharmonicFlow flow(oresund(), {.order = 2}, {Lens("omega")});
  for (const auto& row : rows) {
    const auto r = newton(flow, point({row[1], row[2], row[3], row[4], row[0]}));
    REQUIRE(r.ok());
    for (int i = 0; i < 4; ++i) CHECK(r.x[i] == Approx(row[1 + i]).epsilon(1e-9).margin(1e-12));  // AUTO's polished to 1e-10
    Matrix j(4, 5);
    flow.jacobian(r.x, j);
    const Eigen::VectorXcd e = Eigen::EigenSolver<Matrix>(j.leftCols(4), false).eigenvalues();
    int unstable = 0;
    double nearest = 1e9;
    for (const auto& z : e) {
      unstable += z.real() > 0.0 ? 1 : 0;
      nearest = std::min(nearest, std::abs(z.real() - row[6]));
    }
    CHECK(unstable == static_cast<int>(row[5]));
    CHECK(nearest < 1e-9);
  }
}

TEST_CASE("the settled whirling motion at omega = 1.65 has the published harmonics") {
  const auto stay = oresund(0.5, 1.65);
  const auto system = nielsen_kirkegaard(stay, stay_model(stay.cable, Coefficients::exact), Terms::reduced);
  const auto m = settle(system, point({1.0, 1.0, 0.0, 0.0}));
  REQUIRE(m.kind == MotionKind::periodic);
  CHECK(m.multiple == 1);
  const double expected[2][4] = {{0.10, 0.756, 2.059, 0.437}, {0.33, 1.567, 2.459, 0.511}};
  for (int i = 0; i < 2; ++i) {
    CHECK(std::abs(m.harmonic(i, 0)) == Approx(expected[i][0]).epsilon(0).margin(0.005));                              // given to two digits
    for (int k = 1; k <= 3; ++k) CHECK(std::abs(m.harmonic(i, k)) == Approx(expected[i][k]).epsilon(0).margin(5e-4));  // given to three decimals
  }
}

TEST_CASE("in-plane starts stay in plane and period doubling is told") {
  const auto stay = oresund(0.5, 2.1);
  const auto system = nielsen_kirkegaard(stay, stay_model(stay.cable, Coefficients::exact), Terms::reduced);
  const auto coupled = settle(system, point({10.0, 10.0, 0.0, 0.0}));
  CHECK(coupled.kind == MotionKind::periodic);
  CHECK(coupled.multiple == 2);  // coupled (3,2) response: q1 at w/2 and 3w/2
  CHECK(std::abs(coupled.harmonic(0, 0.5)) > 0.5);
  CHECK(std::abs(coupled.harmonic(0, 1.5)) > 1.5);
  const auto plane = settle(system, point({0.0, 1.0, 0.0, 0.0}));
  CHECK(plane.record.row(0).norm() == 0.0);
}
