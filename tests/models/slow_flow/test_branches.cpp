// What the averaged equations answer: special points and thresholds against exact periodic motion, published averages, and closed forms.
#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <numbers>

#include "continuation/network.hpp"
#include "continuation/two_parameter.hpp"
#include "models/slow_flow/combinatorial_printed.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;
using continuation::Branch;
using continuation::EventType;
using continuation::Network;
using continuation::Walker;

namespace {

const std::vector<CoordinateReflection> whirling = {{{-1, 1}, "WH"}};

ParametricSystem stay_over_omega() { return stay_system(oresund(), {Lens("omega")}, Terms::reduced, Coefficients::exact); }

Vector one(double x) { return Vector::Constant(1, x); }

ModalSystem<double> oresund_system(double omega) {
  const auto stay = oresund(0.5, omega);
  return nielsen_kirkegaard(stay, stay_model(stay.cable, Coefficients::exact), Terms::reduced);
}

Branch walk(const SlowFlow& flow, double lower, double upper, double from) {
  const NewtonResult start = newton(flow, flow.linear_response(one(from)), {.max_iterations = 50});
  REQUIRE(start.ok());
  return Walker(flow, {.lower = lower, .upper = upper}).walk(start.x);
}

std::vector<double> parameters_of(const Branch& branch, EventType type, const std::string& subtype = "") {
  std::vector<double> p;
  for (const auto& s : branch.special)
    if (s.type == type && s.subtype == subtype) p.push_back(s.u[s.u.size() - 1]);
  std::sort(p.begin(), p.end());
  return p;
}

double worst(std::vector<double> found, std::vector<double> expected) {
  std::sort(expected.begin(), expected.end());
  REQUIRE(found.size() == expected.size());
  double w = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) w = std::max(w, std::abs(found[i] - expected[i]));
  return w;
}

const Branch& named(const Network& net, const std::string& born_at) {
  for (const Branch& b : net.branches())
    if (b.born_at == born_at) return b;
  FAIL("no branch born at " << born_at);
  return net.branches().front();
}

// Frequencies at which the slow flow and the Floquet multipliers of the same motion do not count as many unstable directions.
std::vector<double> disagreeing(const SlowFlow& flow, const Branch& b) {
  const Ansatz& a = flow.ansatz();
  Floquet floquet(flow.system_at(b.u(0)), a.highest(), a.nu);
  std::vector<double> where;
  for (int i = 0; i < b.points(); ++i) {
    const auto& result = floquet.compute(flow.system_at(b.u(i)), flow.balance_state(b.u(i)));
    int unstable = 0;
    for (const auto& mu : result.multipliers) unstable += std::abs(mu) > 1.0 + 1e-9 ? 1 : 0;
    if (unstable != b.n_unstable(i)) where.push_back(b.parameter(i));
  }
  return where;
}

Eigen::VectorXcd eigenvalues(const Problem& f, const Vector& u) {
  Matrix j(f.size(), f.size() + f.parameters());
  f.jacobian(u, j);
  return j.leftCols(f.size()).eigenvalues();
}

}  // namespace

TEST_CASE("slow flow: the complete ansatz tends to the exact periodic motion", "[slow]") {
  // Folds and whirling points of the exact in-plane motion, U = 0.5 m, AUTO-07p and Newton on the Poincare map. Bounds are a tenth above what is
  // measured; they fall by about 20 for each two harmonics.
  const std::vector<double> folds = {1.15867469377, 1.11215361987, 1.98244040998, 1.70366257099}, whirl = {1.58096018215, 1.76702117141};
  struct Row {
    int harmonics;
    double fold_error, whirling_error;
  };
  for (const Row& row : {Row{6, 1.3e-3, 3.1e-4}, {8, 2.3e-4, 1.2e-6}, {10, 4.1e-5, 6.8e-8}, {12, 4.2e-7, 2.0e-9}}) {
    INFO("H = " << row.harmonics);
    const SlowFlow flow(stay_over_omega(), Ansatz::complete(2, row.harmonics), whirling);
    const Branch b = walk(flow, 1.0, 2.0, 1.3);
    CHECK(worst(parameters_of(b, EventType::fold), folds) < row.fold_error);
    CHECK(worst(parameters_of(b, EventType::branch_point, "WH"), whirl) < row.whirling_error);
  }
}

TEST_CASE("slow flow: whirling threshold, frozen linear part and complete ansatz", "[slow]") {
  const auto two = stay_system(oresund(), {Lens("omega"), Lens("support_amplitude")}, Terms::reduced, Coefficients::exact);
  const auto threshold = [&](const Ansatz& a) {
    const SlowFlow flow(stay_over_omega(), a, whirling), flow2(two, a, whirling);
    const Branch b = walk(flow, 1.4, 2.0, 1.4);
    for (const auto& s : b.special) {
      if (s.type != EventType::branch_point) continue;
      const continuation::WalkOptions options{.lower = 1.4, .upper = 2.0};
      const auto curve = follow(flow2, s, 0.5, {.range1 = {1.4, 2.0}, .range2 = {0.1, 0.55}, .walk = options});
      for (const auto& z : curve.special)
        if (z.type == "MIN") return Eigen::Vector2d(z.u.tail(2));
    }
    return Eigen::Vector2d(0.0, 0.0);
  };
  const auto frozen = threshold(Ansatz::superharmonic(2, 2));
  CHECK(frozen[0] == Approx(1.6187487888).epsilon(1e-9));  // the superharmonic flow's, walked independently
  CHECK(frozen[1] == Approx(0.3225487668).epsilon(1e-9));
  const auto complete = threshold(Ansatz::complete(2, 10));
  // Limit of 10, 12, 14 harmonics. The point 0.318111237 at 1.6003780 found by AUTO-07p lies on the same curve, 2.2e-5 rad/s beside its minimum:
  // U rises there by 3.4e-8 m.
  CHECK(complete[0] == Approx(1.6003560996).epsilon(0).margin(1e-9));
  CHECK(complete[1] == Approx(0.318111203383).epsilon(0).margin(8e-10));  // H = 10 is 6.5e-10 off
  CHECK(complete[1] < 0.318111237);
}

TEST_CASE("slow flow: stability against Floquet multipliers of the same motion", "[slow]") {
  // Whirling: all points agree but such as lie between a torus point of the one and of the other, 2.2e-4 apart: there the exponents' frequency is
  // 0.05 omega, and the slow flow is of first order in it.
  const SlowFlow flow(stay_over_omega(), Ansatz::complete(2, 8), whirling);
  Network net(flow, {.walk = {.lower = 1.2, .upper = 2.0}, .depth = 1});
  REQUIRE(net.add_seed(newton(flow, flow.linear_response(one(1.2))).x, "linear response"));
  net.switch_branches();
  const Branch& whirl = named(net, "B1:BP1");
  const std::vector<double> torus = {1.74827864899, 1.82943396851};
  for (const double omega : disagreeing(flow, whirl)) CHECK(std::min(std::abs(omega - torus[0]), std::abs(omega - torus[1])) < 2.5e-4);
  CHECK(worst(parameters_of(whirl, EventType::hopf), torus) < 2.5e-4);
  CHECK(worst(parameters_of(whirl, EventType::fold), {1.82142291407, 1.74819639879, 1.82961925092}) < 1e-5);
}

TEST_CASE("slow flow: growth of whirling out of the plane against the Floquet exponent") {
  const SlowFlow flow(stay_over_omega(), Ansatz::complete(2, 10), whirling);
  const Branch b = walk(flow, 1.4, 1.75, 1.4);
  Floquet floquet(flow.system_at(b.u(0)), flow.balance_harmonics(), 1);
  int compared = 0;
  for (int i = 0; i < b.points(); ++i) {
    if (b.n_unstable(i) == 0) continue;
    const Vector u = b.u(i);
    const double averaged = eigenvalues(flow, u).real().maxCoeff(), period = 2.0 * std::numbers::pi / u[flow.size()];
    const double exact = std::log(floquet.compute(flow.system_at(u), flow.balance_state(u)).multipliers.cwiseAbs().maxCoeff()) / period;
    CHECK(averaged == Approx(exact).epsilon(0.04));  // rates are of first order: 1.4 % off up to 1.67 rad/s, 3.2 % at 1.75
    ++compared;
  }
  CHECK(compared > 10);
}

TEST_CASE("slow flow: period doubling and the coupled period-two motion on a complete ansatz", "[slow]") {
  const SlowFlow flow(stay_over_omega(), Ansatz::complete(2, 12, 2), whirling);
  Network net(flow, {.walk = {.lower = 1.9, .upper = 2.4}, .depth = 1});
  REQUIRE(net.add_seed(newton(flow, flow.linear_response(one(1.9)), {.max_iterations = 50}).x, "linear response"));
  net.switch_branches();
  const Branch &planar = net.branches()[0], &coupled = named(net, "B1:BP1"), &halved = named(net, "B1:BP2");
  // Exact: AUTO-07p and Newton on the Poincare map.
  CHECK(worst(parameters_of(planar, EventType::branch_point, "WH"), {1.99835488392, 2.09239906453}) < 1.5e-6);
  CHECK(worst(parameters_of(planar, EventType::branch_point, "PD"), {2.0896029917, 2.18158882051}) < 1.5e-6);
  CHECK(parameters_of(coupled, EventType::branch_point, "SB").at(0) == Approx(2.20058902236).epsilon(0).margin(5e-6));
  CHECK(worst(parameters_of(coupled, EventType::fold), {2.35252829193}) < 2.5e-5);
  CHECK(parameters_of(halved, EventType::branch_point, "WH").at(0) == Approx(2.09280869517).epsilon(0).margin(2e-6));
  CHECK(worst(parameters_of(halved, EventType::fold), {2.37183171078}) < 2e-5);
  CHECK(disagreeing(flow, coupled).empty());
  // Limits: on the two others the averaged equations have Hopf points with a frequency beyond omega/4, half the distance between two copies of one
  // Floquet exponent. None of them is a torus point of the motion.
  for (const Branch* b : {&planar, &halved})
    for (const auto& s : b->special)
      if (s.type == EventType::hopf) CHECK(s.frequency > 0.25 * s.u[flow.size()]);
}

TEST_CASE("slow flow: combinatorial response (3,2), exact projection on (60) and (70)") {
  // The coupled response is born at period doublings of the in-plane motion, where an independent determinant vanishes.
  const SlowFlow flow(stay_over_omega(), Ansatz::combinatorial_coupled(), whirling);
  Network net(flow, {.walk = {.lower = 1.9, .upper = 2.3}, .depth = 1});
  REQUIRE(net.add_seed(newton(flow, flow.linear_response(one(2.0)), {.max_iterations = 50}).x, "linear response"));
  net.switch_branches();
  const auto births = parameters_of(net.branches()[0], EventType::branch_point, "WH");
  REQUIRE(births.size() == 2);
  for (const double w : births) {
    // [D/K + ..] of q1 at w/2 and 3w/2 about (B0, Y1, Y2): Mathieu determinant by direct quadrature.
    Vector u(10);
    for (const auto& s : net.branches()[0].special)
      if (s.type == EventType::branch_point && s.u[9] == w) u = s.u;
    const auto system = flow.system_at(u);
    Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
    const int samples = 64;
    for (int m = 0; m < samples; ++m) {
      const double theta = 2.0 * std::numbers::pi * m / samples;  // w t / 2
      const double q2 = motion_at(flow.ansatz(), u.head(9), 2.0, theta)[1];
      const double g = system.terms[0].coefficient * std::cos(2.0 * theta) + system.terms[3].coefficient * q2 * q2;
      const Eigen::Vector4d shape(std::cos(theta), std::sin(theta), std::cos(3.0 * theta), std::sin(3.0 * theta));
      M += 2.0 / samples * g * shape * shape.transpose();
    }
    for (const int k : {1, 3}) {
      const int at = k - 1;
      const double speed = 0.5 * k * w, D = system.stiffness[0] - speed * speed, E = system.damping[0] * speed;
      M(at, at) += D;
      M(at + 1, at + 1) += D;
      M(at, at + 1) += E;
      M(at + 1, at) -= E;
    }
    const Eigen::JacobiSVD<Eigen::Matrix4d> svd(M);
    CHECK(svd.singularValues()[3] < 1e-9 * svd.singularValues()[0]);
  }
  // Against the settled motion at 2.1 and 2.15 rad/s from q1 = 3 m (harmonics of q1 at w/2, 3w/2, of q2 at 0, w, 2w): a quarter off at worst.
  struct Row {
    double omega;
    double integrated[5];
  };
  for (const Row& row : {Row{2.1, {0.8529, 1.8874, 0.2976, 1.0247, 0.4621}}, {2.15, {0.9797, 2.3753, 0.2866, 1.0270, 0.3974}}}) {
    const SteadyMotion m = settle(oresund_system(row.omega), Eigen::Vector4d(3.0, 0.0, 0.0, 0.0));
    REQUIRE(m.kind == MotionKind::periodic);
    REQUIRE(m.multiple == 2);
    const Vector exact = state_of(flow.ansatz(), m);
    bool stable_found = false;
    for (const auto& [branch, u] : net.solutions_at(row.omega)) {
      if (std::abs(amplitude(flow.ansatz(), u, 0, 3)) < 0.1 || net.unstable_at(branch, u) != 0) continue;
      stable_found = true;
      const int coordinate[5] = {0, 0, 1, 1, 1}, harmonic[5] = {1, 3, 0, 2, 4};
      for (int h = 0; h < 5; ++h) {
        const double integrated = std::abs(amplitude(flow.ansatz(), exact, coordinate[h], harmonic[h]));
        CHECK(integrated == Approx(row.integrated[h]).epsilon(0).margin(1e-4));  // printed digits
        CHECK(std::abs(amplitude(flow.ansatz(), u, coordinate[h], harmonic[h])) == Approx(integrated).epsilon(0.25));
      }
    }
    CHECK(stable_found);
  }
}

TEST_CASE("slow flow: 5/2 in q1 and 3 in q2 bring the births of the coupled response to the exact ones") {
  const std::vector<double> exact = {1.99835488392, 2.09239906453};  // period doublings out of plane, AUTO-07p and Newton on the Poincare map
  const auto error = [&](const std::vector<std::vector<double>>& lists) {
    const Branch b = walk(SlowFlow(stay_over_omega(), Ansatz::list(lists), whirling), 1.9, 2.3, 2.0);
    return worst(parameters_of(b, EventType::branch_point, "WH"), exact);
  };
  CHECK(error({{0.5, 1.5}, {0, 1, 2}}) == Approx(0.0860).epsilon(0).margin(1e-4));            // the paper's list
  CHECK(error({{0.5, 1.5, 2.5}, {0, 1, 2, 3}}) == Approx(1.346e-3).epsilon(0).margin(1e-6));  // as measured
  CHECK(error({{0.5, 1.5, 2.5, 3.5}, {0, 1, 2, 3, 4}}) == Approx(2.28e-5).epsilon(0).margin(1e-7));
  // With the printed terms only, the print's misprint of (64) corrected.
  const PrintedCombinatorialFlow printed(stay_over_omega(), CombinatorialMotion::coupled);
  Vector start(10);
  start << linear_state(printed.ansatz(), oresund_system(1.9)), 1.9;
  const NewtonResult at = newton(printed, start, {.max_iterations = 50});
  REQUIRE(at.ok());
  const Branch b = Walker(printed, {.lower = 1.9, .upper = 2.3}).walk(at.x);
  // Births in closed form: (61) and (62) with small A1, A2 leave |d1 - beta1^2 / d3| = beta1, d_k = w1^2 - k^2 w^2 + i k w c + g2 (4 B0^2 + 2 B1^2 +
  // 2 B2^2).
  int births = 0;
  for (const auto& s : b.special) {
    if (s.type != EventType::branch_point) continue;
    ++births;
    const auto system = oresund_system(s.u[9]);
    const double beta = 0.5 * system.terms[0].coefficient, g2 = 0.25 * system.terms[3].coefficient, w = system.omega;
    const double across = g2 * (4.0 * s.u[4] * s.u[4] + 2.0 * s.u.segment(5, 4).squaredNorm());
    const auto d = [&](double k) { return std::complex<double>(system.stiffness[0] - k * k * w * w + across, k * w * system.damping[0]); };
    CHECK(std::abs(d(0.5) - beta * beta / d(1.5)) == Approx(beta).epsilon(1e-9));  // events are located to 1e-10
  }
  CHECK(births == 2);
}

TEST_CASE("slow flow: published first-order averages of the 1:2 pair", "[published]") {
  // x1'' + .005 x1' + x1 + x1 x2 = .01 cos Wt, x2'' + .01 x2' + 4 x2 + x1^2 = 0 with x1 at W and x2 at 2 W.
  ModalSystem<double> s;
  s.omega = 1.0;
  s.damping = {0.005, 0.01};
  s.stiffness = {1.0, 4.0};
  s.add_term(0, 1.0, {0, 1});
  s.add_term(1, 1.0, {0, 0});
  s.add_force(0, 0.01, 1);
  const auto system = ParametricSystem::over_omega(s);
  const Branch b = walk(SlowFlow(system, Ansatz::list({{1}, {2}})), 0.55, 1.3, 1.3);
  CHECK(worst(parameters_of(b, EventType::hopf), {0.989120601, 1.010742306}) < 2e-9);  // digits given
  CHECK(worst(parameters_of(b, EventType::fold), {0.959044953, 1.039311937, 1.107244033, 0.837498625}) < 2e-9);
  CHECK(parameters_of(b, EventType::branch_point).empty());
}

TEST_CASE("slow flow: threshold of the principal parametric resonance") {
  // q'' + 2 z w q' + w^2 (1 + e cos Wt) q + k q^3 = 0 at W = 2 w, q at W/2: zero loses stability at e = 4 z.
  for (const double z : {0.001, 0.002, 0.005}) {
    const auto make = [z]<class S>(std::span<const S> p) {
      ModalSystem<S> s;
      s.omega = S(2.0);
      s.damping = {S(2.0 * z)};
      s.stiffness = {S(1.0)};
      s.add_term(0, p[0], {0}, 1);
      s.add_term(0, S(1.0), {0, 0, 0});
      return s;
    };
    const SlowFlow flow(ParametricSystem(make, {"e"}, one(0.01)), Ansatz::list({{0.5}}));
    REQUIRE(flow.reflections().size() == 1);
    CHECK(flow.reflections()[0].subtype == "PD");
    Vector u = Vector::Zero(3);
    u[2] = 1e-4;
    const Branch b = Walker(flow, {.lower = 1e-4, .upper = 0.1}).walk(u);
    CHECK(worst(parameters_of(b, EventType::branch_point, "PD"), {4.0 * z}) < 1e-12);
  }
}

TEST_CASE("slow flow: the mean follows its statics") {
  // q'' + c q' - q + q^3 = 0 with a mean alone: 0 is unstable, +-1 are stable, at any damping.
  for (const double c : {0.0, 0.1, -0.1}) {
    ModalSystem<double> s;
    s.omega = 1.0;
    s.damping = {c};
    s.stiffness = {-1.0};
    s.add_term(0, 1.0, {0, 0, 0});
    const SlowFlow flow(ParametricSystem::over_omega(s), Ansatz::list({{0}}));
    const double rate = 1.0 / std::sqrt(c * c + 1e-6);
    CHECK(eigenvalues(flow, point({0.0, 1.0}))[0].real() == Approx(rate));
    CHECK(eigenvalues(flow, point({1.0, 1.0}))[0].real() == Approx(-2.0 * rate));
  }
}
