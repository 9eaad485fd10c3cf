#include <catch2/catch.hpp>

#include "continuation/deflation.hpp"
#include "core/dual_problem.hpp"
#include "models/closed_forms.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;
using namespace whirl::continuation;

namespace {
struct Five {  // x (x^2 - 1)(x^2 - 4) = p
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    r[0] = u[0] * (u[0] * u[0] - 1.0) * (u[0] * u[0] - 4.0) - u[1];
  }
};
}  // namespace

TEST_CASE("deflation finds the other roots from one start") {
  const DualProblem<Five> f({}, 1, 1, true);
  const auto all = deflated_solutions(f, {Eigen::Vector2d(0.0, 0.0)}, {Eigen::Vector2d(0.4, 0.0)});
  REQUIRE(all.size() == 5);
  for (const double x : {-2.0, -1.0, 0.0, 1.0, 2.0})
    CHECK(std::any_of(all.begin(), all.end(), [&](const Vector& u) { return std::abs(u[0] - x) < 1e-10; }));
}

TEST_CASE("deflation finds what the closed forms list on the Oresund stay") {
  const SuperharmonicFlow f(oresund(0.5), {.order = 2}, {Lens("omega")});
  const double w = 1.8;
  const auto c = f.model().coefficients<double>(std::array<double, 1>{w});
  const auto planar = in_plane_states(c), coupled = coupled_states(c);
  std::vector<Vector> starts;
  for (const double a : {0.5, 3.0, 6.0})
    for (const double b : {-4.0, -1.0, 2.0, 5.0}) starts.push_back(point({a, a, b, 1.0, w}));
  Vector first(5);
  first << planar.front(), w;
  const auto all = deflated_solutions(f, {first}, starts);
  CHECK(all.size() == planar.size() + coupled.size());  // mirror images are not listed twice
}
