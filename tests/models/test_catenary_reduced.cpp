// Nonlinear models on a few catenary modes: against the second-order swing in all functions, and a chain of masses integrated in time.
#include <cmath>

#include "models/catenary/backbone.hpp"
#include "models/catenary/reduced.hpp"
#include "tests/models/catenary/chain.hpp"
#include "tests/models/catenary/reference.hpp"

using namespace catenary_test;
using whirl::models::ModalModel;

TEST_CASE("catenary reduced: the swing out of plane with few modes in plane") {
  struct Case {
    double m, h, kappa;
    int in_plane;
    double tolerance;  // what was seen, and a half: modes left out count as (2 w / their frequency)^4
  };
  for (const Case& t : {Case{1.0, 0.0, 1e-2, 6, 3e-3},
                        {1.0, 0.0, 1e-4, 2, 0.03},
                        {1.0, 0.0, 1e-7, 2, 0.02},
                        {1.0, 0.0, 1e-7, 8, 1.5e-3},
                        {1.0, 0.5, 1e-2, 6, 0.01},
                        {1.0, 0.5, 1e-4, 8, 0.02},
                        {0.8, 0.6, 1e-2, 6, 5e-3},
                        {0.8, 0.6, 1e-7, 8, 6e-3},
                        {2.0, 0.3, 1e-7, 2, 5e-3},
                        {0.1, 0.0, 1e-2, 3, 1e-3},
                        {0.1, 0.0, 1e-7, 8, 3e-3}}) {
    const CoreCable cable = core(unit_geometry(t.m, t.h), t.kappa);
    const Backbone all = lateral_backbone(cable, 1);
    const ReducedModel few = reduced_model(cable, {.out_of_plane = 1, .in_plane = t.in_plane});
    INFO("b/2a " << t.m << " h/b " << t.h << " kappa " << t.kappa);
    CHECK(few.omega[0] == Approx(all.omega).epsilon(1e-12));
    CHECK(backbone_curvature(few, 0) == Approx(all.curvature).epsilon(t.tolerance));
    std::vector<int> fourth(std::size_t(1 + t.in_plane), 0);
    fourth[0] = 4;
    for (const Monomial& d : few.direct)  // projection alone: the locked one of backbone.hpp
      if (d.powers == fourth) CHECK(3.0 * d.coefficient / (2.0 * all.omega * all.omega * few.mass[0]) == Approx(all.direct).epsilon(1e-9));
  }
}

TEST_CASE("catenary reduced: finite as the cable stiffens") {
  const Geometry g = unit_geometry(1.0, 0.3);
  const ReducedModel soft = reduced_model(core(g, 1e-5), {2, 3}), stiff = reduced_model(core(g, 1e-7), {2, 3});
  REQUIRE(soft.energy.size() == stiff.energy.size());
  double largest = 0.0;
  for (const Monomial& m : stiff.energy) largest = std::max(largest, std::abs(m.coefficient));
  for (std::size_t i = 0; i < soft.energy.size(); ++i) {
    CHECK(soft.energy[i].powers == stiff.energy[i].powers);
    CHECK(std::abs(soft.energy[i].coefficient - stiff.energy[i].coefficient) < 1e-3 * largest);
  }
  const auto most = [](const ReducedModel& r) {
    double top = 0.0;
    for (const Monomial& m : r.direct) top = std::max(top, std::abs(m.coefficient));
    return top;
  };
  CHECK(most(stiff) > 90.0 * most(soft));                                              // projection alone: 1/kappa
  for (const Monomial& m : stiff.energy) CHECK((m.powers[0] + m.powers[1]) % 2 == 0);  // left and right are alike
  CHECK_THROWS_AS(reduced_model(core(g), {}), std::invalid_argument);
  CHECK_THROWS_AS(reduced_model(core(g, 1e-3), {0, 0}), std::invalid_argument);
  CHECK_THROWS_AS(reduced_model(core(g, 1e-3), {9, 9}), std::invalid_argument);
}

TEST_CASE("catenary reduced: in metres and seconds the forces are slopes of the energy") {
  const HangingCable cable{
      .shape = geometry({.span = 100.0, .height = 30.0, .length = 140.0}), .mass_per_length = 10.0, .axial_stiffness = 3e7, .drag_lateral = 0.7};
  const ReducedModel r = reduced_model(core_of(cable), {1, 2});
  const ModalModel m = in_si_units(r, cable);
  m.validate();
  const double a = cable.shape.a, force = horizontal_tension(cable);  // energies in H a, masses in mu a
  const auto energy = [&](const std::vector<double>& q) {
    double sum = 0.0;
    for (const Monomial& e : r.energy) {
      double product = e.coefficient * force * a;
      for (std::size_t i = 0; i < q.size(); ++i) product *= std::pow(q[i] / a, e.powers[i]);
      sum += product;
    }
    return sum;
  };
  const std::vector<double> q{3.0, -2.0, 1.5};
  for (std::size_t i = 0; i < 3; ++i) {
    auto up = q, down = q;
    up[i] += 1e-4;
    down[i] -= 1e-4;
    double sum = 0.0;
    for (const auto& t : m.terms)
      if (t.equation == int(i)) {
        double product = t.coefficient;
        for (std::size_t k = 0; k < 3; ++k) product *= std::pow(q[k], t.powers[k]);
        sum += product;
      }
    const double mass = r.mass[Eigen::Index(i)] * cable.mass_per_length * a;
    CHECK(sum == Approx((energy(up) - energy(down)) / 2e-4 / mass).epsilon(1e-7));
    CHECK(m.frequency[i] == Approx(r.omega[Eigen::Index(i)] * frequency_unit(cable)));
  }
  CHECK(m.damping[0] == Approx(0.07));
}

TEST_CASE("catenary reduced: a mode in plane let go on a chain of masses", "[slow]") {
  const double kappa = 5e-3;
  const CoreCable cable = core(unit_geometry(1.0, 0.0), kappa);
  const Field<double> f = in_plane_modes(cable, {.count = 1}).modes[0].field;
  const Chain chain(unit_geometry(1.0, 0.0), kappa, 100);
  const auto shape = chain.displaced([&](double x) { return std::array{f.at(x, Quantity::U), f.at(x, Quantity::V), 0.0}; });
  const auto frequency = [&](double A) {
    auto start = shape;
    for (double& u : start) u *= A;
    return chain.frequency(shape, start, 60);
  };
  const double small = 0.003, A = 0.012, measured = (frequency(A) / frequency(small) - 1.0) / (A * A - small * small);
  const ReducedModel r = reduced_model(cable, {.out_of_plane = 0, .in_plane = 10});
  INFO("measured " << measured << " predicted " << backbone_curvature(r, 0));
  CHECK(measured == Approx(backbone_curvature(r, 0)).epsilon(0.02));  // 100 sides: a percent; what oscillates freely besides: half of one
}
