#include <catch2/catch.hpp>

#include "core/cvode.hpp"
#include "core/dual_problem.hpp"
#include "core/kinsol.hpp"
#include "core/parallel.hpp"

using namespace whirl;

namespace {
struct Circle {  // x^2 + y^2 = p, x = y^3
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    r[0] = u[0] * u[0] + u[1] * u[1] - u[2];
    r[1] = u[0] - u[1] * u[1] * u[1];
  }
};
struct Steep {  // plain Newton from 3 diverges
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    using std::atan;
    r[0] = atan(u[0]);
  }
};
struct None {  // no real root
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    r[0] = u[0] * u[0] + 1.0;
  }
};
}  // namespace

TEST_CASE("Newton converges on a square system and tells when it does not") {
  const DualProblem<Circle> f({}, 2, 1, false);
  const auto r = newton(f, Eigen::Vector3d(1.2, 0.9, 2.0));
  REQUIRE(r.ok());
  CHECK(r.x[0] == Approx(1.0).epsilon(1e-14));
  CHECK(r.x[1] == Approx(1.0).epsilon(1e-14));
  CHECK(r.x[2] == 2.0);
  CHECK_FALSE(newton(DualProblem<None>({}, 1, 0, false), Vector::Constant(1, 0.3)).ok());
  CHECK(newton(DualProblem<None>({}, 1, 0, false), Vector::Zero(1)).outcome == Outcome::singular);
  CHECK_THROWS_AS(newton(f, Eigen::Vector3d(1, 1, 2), {.tolerance = 0.0}), std::invalid_argument);
}

TEST_CASE("KINSOL's line search succeeds where plain Newton diverges") {
  const DualProblem<Steep> f({}, 1, 0, false);
  CHECK_FALSE(newton(f, Vector::Constant(1, 3.0)).ok());
  const auto r = line_search_solve(f, Vector::Constant(1, 3.0));
  REQUIRE(r.ok());
  CHECK(std::abs(r.x[0]) < 1e-12);
  CHECK_FALSE(line_search_solve(DualProblem<None>({}, 1, 0, false), Vector::Constant(1, 0.5)).ok());
}

TEST_CASE("CVODE integrates an oscillator to its tolerance, both methods") {
  for (const bool stiff : {false, true}) {
    Integrator run(
        [](double, std::span<const double> y, std::span<double> d) {
          d[0] = y[1];
          d[1] = -y[0];
        },
        0.0, Eigen::Vector2d(1.0, 0.0), {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12, .stiff = stiff});
    REQUIRE(run.advance(20.0));
    CHECK(run.state()[0] == Approx(std::cos(20.0)).epsilon(0).margin(1e-6));  // global error: local tolerance times some hundred steps
    run.restart(0.0, Eigen::Vector2d(0.0, 1.0));
    REQUIRE(run.advance(1.0));
    CHECK(run.state()[0] == Approx(std::sin(1.0)).epsilon(0).margin(1e-8));
  }
}

TEST_CASE("an integration that blows up says so, exceptions pass through") {
  Integrator run([](double, std::span<const double> y, std::span<double> d) { d[0] = y[0] * y[0]; }, 0.0, Vector::Ones(1), {.max_steps = 2000});
  CHECK_FALSE(run.advance(2.0));
  CHECK_THAT(run.why(), Catch::Contains("CVODE stopped"));
  Integrator throwing([](double, std::span<const double>, std::span<double>) { throw std::domain_error("outside"); }, 0.0, Vector::Ones(1), {});
  CHECK_THROWS_AS((void)throwing.advance(1.0), std::domain_error);
  CHECK_THROWS_AS(Integrator([](double, std::span<const double>, std::span<double>) {}, 0.0, Vector::Ones(1), {.relative_tolerance = -1.0}),
                  std::invalid_argument);
}

TEST_CASE("parallel jobs are all done and errors come back") {
  std::vector<int> done(100, 0);
  parallel_for(done.size(), [&](std::size_t i) { done[i] += static_cast<int>(i); });
  for (int i = 0; i < 100; ++i) CHECK(done[static_cast<std::size_t>(i)] == i);
  CHECK_THROWS_AS(parallel_for(10,
                               [](std::size_t i) {
                                 if (i == 3) throw std::runtime_error("three");
                               }),
                  std::runtime_error);
}
