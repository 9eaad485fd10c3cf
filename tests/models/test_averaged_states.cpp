// All steady states of averaged equations: numbers known in closed form, and those of the stay's own closed forms.
#include <algorithm>
#include <catch2/catch.hpp>

#include "core/polynomial.hpp"
#include "models/averaged_states.hpp"
#include "models/closed_forms.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

ModalSystem<double> oscillator(double omega, double damping, double cubic) {
  ModalSystem<double> s;
  s.omega = omega;
  s.damping = {damping};
  s.stiffness = {1.0};
  s.add_term(0, cubic, {0, 0, 0});
  return s;
}

}  // namespace

TEST_CASE("averaged Duffing oscillator: one or three states, the roots of the cubic in the amplitude's square") {
  for (const double omega : {0.9, 1.02, 1.1, 1.3}) {
    ModalSystem<double> s = oscillator(omega, 0.02, 0.3);
    s.add_force(0, 0.03, 1);
    const auto states = AveragedStates(1, {1}).solve(s);
    // |D + 3/4 c A^2|^2 A^2 = F^2
    const double d = 1.0 - omega * omega, e = omega * 0.02, g = 0.75 * 0.3;
    int real = 0;
    for (const auto& y : polynomial_roots({-0.03 * 0.03, d * d + e * e, 2.0 * d * g, g * g})) {
      if (std::abs(y.imag()) > 1e-9 || y.real() < 0.0) continue;
      ++real;
      const auto matches = [&](const Eigen::MatrixXcd& z) { return std::abs(std::norm(z(0, 1)) - y.real()) < 1e-9; };
      CHECK(std::count_if(states.begin(), states.end(), matches) == 1);
    }
    CHECK(static_cast<int>(states.size()) == real);
  }
}

TEST_CASE("averaged parametric oscillator: rest and two pairs beside the tongue, one pair in it") {
  // x'' + c x' + (1 - p cos 2 w t) x + x^3: 3/4 A^2 = w^2 - 1 +- sqrt(p^2/4 - c^2 w^2)
  for (const auto& [omega, count] : {std::pair{0.99, 1}, std::pair{1.0, 3}, std::pair{1.01, 5}}) {
    ModalSystem<double> s = oscillator(omega, 0.005, 1.0);
    s.add_term(0, -0.011, {0}, 2);
    const auto states = AveragedStates(1, {1}).solve(s);
    REQUIRE(static_cast<int>(states.size()) == count);
    const double root = std::sqrt(0.25 * 0.011 * 0.011 - 0.005 * 0.005 * omega * omega);
    for (const auto& z : states) {
      const double y = 0.75 * std::norm(z(0, 1));
      CHECK((y < 1e-12 || std::abs(y - (omega * omega - 1.0 + root)) < 1e-4 || std::abs(y - (omega * omega - 1.0 - root)) < 1e-4));
    }
  }
}

TEST_CASE("two parametric oscillators: nothing between them, the states are all pairs, coupled ones as many") {
  ModalSystem<double> s;
  s.omega = 1.015;
  s.damping = {0.007, 0.007};
  s.stiffness = {0.99708026 * 0.99708026, 1.00291124 * 1.00291124};
  for (const int i : {0, 1}) {
    s.add_term(i, -0.02, {i}, 2);
    s.add_term(i, 0.6323529, {i, i, i});
  }
  AveragedStates averaged(1, {1, 1});
  CHECK(averaged.solve(s).size() == 25);
  s.add_term(0, 1.1029412, {0, 1, 1});
  s.add_term(0, 0.2205882, {1, 1, 1});
  s.add_term(0, -0.6617647, {0, 0, 1});
  s.add_term(1, 1.1029412, {0, 0, 1});
  s.add_term(1, -0.2205882, {0, 0, 0});
  s.add_term(1, 0.6617647, {0, 1, 1});
  const auto states = averaged.solve(s);
  CHECK(averaged.roots() == 25);
  CHECK(states.size() == 25);  // rest and twelve pairs +-
}

TEST_CASE("averaged stay, order 2: the closed forms' states, each once with its mirror image") {
  const auto p = oresund(0.5, 1.8);
  SuperharmonicFlow flow(p, {.order = 2}, {Lens("omega")});
  const auto c = flow.model().coefficients<double>(std::array<double, 1>{1.8});
  const auto planar = in_plane_states(c), coupled = coupled_states(c);
  const auto system = nielsen_kirkegaard(p, stay_model(p.cable, Coefficients::exact), Terms::reduced);
  const auto states = AveragedStates(1, {2, 2}, {.second_order = false}).solve(system);
  CHECK(states.size() == planar.size() + 2 * coupled.size());
  // u + i v is the amplitude of cos(n w t + phase); the closed forms are roots of a polynomial of degree eight, good to some 1e-9 m.
  const auto listed = [&](const Eigen::Vector4d& x) {
    return std::any_of(states.begin(), states.end(), [&](const Eigen::MatrixXcd& z) {
      return std::abs(z(0, 2) - std::complex<double>(x[0], x[1])) + std::abs(z(1, 2) - std::complex<double>(x[2], x[3])) < 1e-7;
    });
  };
  for (const auto& x : planar) CHECK(listed(x));
  for (const auto& x : coupled) CHECK((listed(x) && listed(Eigen::Vector4d(-x[0], -x[1], x[2], x[3]))));
}

TEST_CASE("quadratic terms shift the averaged frequency by what second-order averaging gives") {
  // x'' + x + a x^2 free: w^2 = 1 - 5/6 a^2 A^2.
  ModalSystem<double> s = oscillator(0.999, 1e-9, 0.0);
  s.terms.clear();
  s.add_term(0, 0.4, {0, 0});
  s.add_force(0, 1e-6, 1);
  const auto states = AveragedStates(1, {1}).solve(s);
  double largest = 0.0;
  Eigen::MatrixXcd z;
  for (const auto& each : states)
    if (std::abs(each(0, 1)) > largest) {
      largest = std::abs(each(0, 1));
      z = each;
    }
  CHECK(largest * largest == Approx((1.0 - 0.999 * 0.999) * 6.0 / (5.0 * 0.16)).epsilon(0.01));  // force and w near 1 count in the third digit
  CHECK(z(0, 0).real() == Approx(-0.5 * 0.4 * largest * largest).epsilon(1e-6));
}

TEST_CASE("resonances in reach: orders near each coordinate's frequency, and the mixed one") {
  ModalSystem<double> s;
  s.omega = 2.0;
  s.damping = {0.1, 0.1};
  s.stiffness = {1.0, 16.0};  // w1 = 1: omega/2; w2 = 4: 2 omega
  const auto sets = likely_resonances(s, 2);
  const auto has = [&](std::vector<int> set) { return std::find(sets.begin(), sets.end(), set) != sets.end(); };
  CHECK(has({1, 0}));
  CHECK(has({2, 2}));
  CHECK(has({1, 4}));  // each at its own
  CHECK_FALSE(has({6, 0}));
  CHECK_THROWS_AS(AveragedStates(1, {0, 0}), std::invalid_argument);
  CHECK_THROWS_AS(AveragedStates(1, {1}).solve(s), std::invalid_argument);
}
