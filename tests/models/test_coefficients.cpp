#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <catch2/catch.hpp>

#include "models/nielsen_kirkegaard.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

// Frequencies, modes and coefficients of the stay to 12 digits, computed elsewhere by quadrature in extended precision.
struct Expected {
  const char* name;
  double value;
};

double by_name(const ModalCoefficients<double>& k, const std::string& n) {
  const std::pair<const char*, double> all[] = {{"m2", k.m2}, {"a2", k.a2}, {"c1", k.c1}, {"c2", k.c2}, {"d1", k.d1},
                                                {"d2", k.d2}, {"d3", k.d3}, {"C1", k.C1}, {"C2", k.C2}, {"C3", k.C3},
                                                {"C4", k.C4}, {"G1", k.G1}, {"G2", k.G2}, {"G3", k.G3}, {"G4", k.G4}};
  for (const auto& [name, value] : all)
    if (n == name) return value;
  throw std::logic_error(n);
}

}  // namespace

TEST_CASE("statics, frequencies and exact coefficients of the Oresund stay") {
  const auto stay = oresund();
  const auto p = parabola(stay.cable);
  const auto m = modes(stay.cable);
  // Printed to 12 digits: half a unit of the last one.
  CHECK(p.sag_ratio == Approx(0.00405236620244).epsilon(2e-12));
  CHECK(p.irvine_lambda2 == Approx(0.414643984992).epsilon(2e-12));
  CHECK(m.frequency_number == Approx(3.19460717388).epsilon(2e-12));
  CHECK(m.omega1 == Approx(3.14761321417).epsilon(2e-12));
  CHECK(m.omega2 == Approx(3.2007293317).epsilon(2e-12));
  const auto k = modal_coefficients(m, Coefficients::exact);
  const Expected table[] = {{"m2", 0.498792768491}, {"a2", 0.637034099318}, {"c1", 9.86960440109}, {"c2", 9.86979216998}, {"d1", 77.9504895752},
                            {"d2", 39.0695768361},  {"d3", 116.495404761},  {"C1", 4.93480220054}, {"C2", 4.92883592054}, {"C3", 4.94076521544},
                            {"C4", 4.93489608499},  {"G1", 36.5284091378},  {"G2", 36.3370402494}, {"G3", 36.4249870335}, {"G4", 36.2366565497}};
  for (const auto& [name, value] : table) {
    INFO(name);
    CHECK(by_name(k, name) == Approx(value).epsilon(1e-11));  // 12 printed digits
  }
  CHECK(k.a1 == Approx(2.0 / pi).epsilon(1e-14));
}

TEST_CASE("closed forms with the derived modal mass equal the quadrature") {
  for (const double tension : {2.5e6, 5.5e6, 12e6}) {
    auto cable = oresund().cable;
    cable.chord_tension = tension;
    const auto m = modes(cable);
    const auto q = quadrature_coefficients(m), c = closed_form_coefficients(m.frequency_number, 3.0, false);
    for (const char* name : {"m2", "a2", "c1", "c2", "d1", "d2", "d3", "C1", "C2", "C3", "C4", "G1", "G2", "G3", "G4"}) {
      INFO(name << " at T = " << tension);
      // The closed forms divide by W^2 - pi^2, small for a taut cable: digits go with it.
      CHECK(by_name(c, name) == Approx(by_name(q, name)).epsilon(1e-10));
    }
  }
}

TEST_CASE("coefficients as printed reproduce the paper's values") {
  const auto k = modal_coefficients(modes(oresund().cable), Coefficients::as_printed);
  const Expected table[] = {{"m2", 0.4909219}, {"a2", 0.6472476}, {"c2", 10.0280328}, {"d2", 39.6959726}, {"d3", 118.363155},
                            {"C2", 4.8470419}, {"C3", 4.9366731}, {"C4", 5.0140164},  {"G3", 37.0089825}, {"G4", 36.8176326}};
  for (const auto& [name, value] : table) {
    INFO(name);
    CHECK(by_name(k, name) == Approx(value).epsilon(1e-7));  // printed to 7 digits from W rounded to 8
  }
}

TEST_CASE("order of the cubic coefficients: not as the paper says") {
  const auto k = modal_coefficients(modes(oresund().cable), Coefficients::exact);
  CHECK(k.G1 > k.G3);
  CHECK(k.G3 > k.G2);
  CHECK(k.G2 > k.G4);
}

TEST_CASE("coupling terms equal the vector tensors of (24), every term") {
  // b_a = (AE / M_a) int d/dx Phi_i B_i dx with B_i of [NielsenKirkegaard2002, eq. (13)] at the strain field e + sum Phi' q, by another quadrature.
  auto stay = oresund(0.7, 1.3);
  const auto model = stay_model(stay.cable, Coefficients::exact);
  const auto full = nielsen_kirkegaard(stay, model, Terms::full);
  const double L = stay.cable.chord_length, mu = stay.cable.mass_per_length, AE = stay.cable.axial_stiffness,
               theta = stay.cable.inclination_deg * pi / 180.0;
  for (const double phase : {0.0, 0.7, 2.5}) {
    const double q[2] = {1.7, -2.3}, E = stay.support_amplitude / L * std::cos(phase), e[3] = {E * std::cos(theta), E * std::sin(theta), 0.0};
    for (int a = 0; a < 2; ++a) {
      const auto integrand = [&](double xi) {
        const double t[3] = {1.0, model.shape.sag_ratio * 4.0 * (1.0 - 2.0 * xi), 0.0};
        const double f = model.modes.phi1_slope(xi) / L, g = model.modes.phi2_slope(xi) / L;
        const double s[3] = {e[0], e[1] + g * q[1], e[2] + f * q[0]};
        const double phi[3] = {0.0, a == 1 ? g : 0.0, a == 0 ? f : 0.0};
        double ss = 0.0, st = 0.0, b = 0.0;
        for (int i = 0; i < 3; ++i) {
          ss += s[i] * s[i];
          st += s[i] * t[i];
        }
        for (int i = 0; i < 3; ++i) b += phi[i] * 0.5 * AE * (ss * t[i] + 2.0 * st * s[i] + ss * s[i]);
        // (13) holds quadratic and cubic terms; the linear stiffness is no part of b, nor is what is linear in e alone (the load)
        return b;
      };
      const double M = mu * L * (a == 0 ? model.coefficients.m1 : model.coefficients.m2);
      const double b = boost::math::quadrature::gauss_kronrod<double, 61>::integrate(integrand, 0.0, 1.0, 10, 1e-13) * L / M;
      std::array<double, 2> ours;
      full.coupling<double>(std::array<double, 2>{q[0], q[1]}, phase, ours);
      double load = 0.0;  // the static and second-harmonic part stands among the forces
      for (const auto& force : full.forces)
        if (force.equation == a && force.harmonic != 1) load -= force.amplitude * std::cos(force.harmonic * phase);
      INFO("mode " << a + 1 << ", phase " << phase);
      CHECK(ours[std::size_t(a)] + load == Approx(b).epsilon(1e-11));
    }
  }
}

TEST_CASE("undamped and unforced, both models derive from a potential") {
  auto stay = oresund(0.0);
  const auto model = stay_model(stay.cable, Coefficients::exact);
  for (const Terms terms : {Terms::reduced, Terms::full}) {
    const auto s = nielsen_kirkegaard(stay, model, terms);
    // M_1 d b_1/d q_2 = M_2 d b_2/d q_1 at any q.
    using D = Dual<double, 2>;
    for (const auto& [q1, q2] : {std::pair{1.3, -0.4}, {-2.0, 3.0}, {0.1, 0.2}}) {
      const std::array<D, 2> q{seed<D>(q1, 0), seed<D>(q2, 1)};
      std::array<D, 2> b;
      s.coupling<D>(q, 0.0, b);
      CHECK(model.coefficients.m1 * b[0].d[1] == Approx(model.coefficients.m2 * b[1].d[0]).epsilon(1e-12));
    }
  }
}

TEST_CASE("taut and sagging limits of the symmetric root") {
  CHECK(symmetric_root(0.0) == pi);
  CHECK(symmetric_root(1e-12) == Approx(pi).epsilon(1e-12));
  // [IrvineCaughey1974, eq. (19)]: first roots to the 7 digits tabulated, cross-over exactly 2 pi at 4 pi^2.
  CHECK(symmetric_root(1.0) == Approx(3.267886).epsilon(2e-7));
  CHECK(symmetric_root(pi * pi) == Approx(4.213685).epsilon(2e-7));
  CHECK(symmetric_root(4.0 * pi * pi) == Approx(2.0 * pi).epsilon(1e-14));
  CHECK(symmetric_root(100.0) == Approx(8.159296).epsilon(2e-7));
  CHECK(symmetric_root(1e9) == Approx(8.986819).epsilon(2e-7));
  CHECK_THROWS_AS(symmetric_root(-1.0), std::invalid_argument);
}

TEST_CASE("the root's slope in duals is the slope of the root") {
  using D = Dual<double, 1>;
  const double l = 0.4146, h = 1e-5;
  const double difference = (symmetric_root(l + h) - symmetric_root(l - h)) / (2.0 * h);
  CHECK(symmetric_root_in(seed<D>(l, 0)).d[0] == Approx(difference).epsilon(1e-8));  // central difference: h^2 and rounding/h
  using DD = Dual<D, 1>;
  DD x(seed<D>(l, 0));
  x.d[0].v = 1.0;
  const double second = (symmetric_root_in(seed<D>(l + h, 0)).d[0] - symmetric_root_in(seed<D>(l - h, 0)).d[0]) / (2.0 * h);
  CHECK(symmetric_root_in(x).d[0].d[0] == Approx(second).epsilon(1e-7));
}

TEST_CASE("a cable out of range is refused, one at the edge is warned of") {
  auto cable = oresund().cable;
  CHECK(check(cable).empty());
  cable.chord_tension = 0.9e6;
  CHECK(check(cable).size() >= 1);
  cable.chord_tension = 2e5;
  CHECK_THROWS_WITH(check(cable), Catch::Contains("beyond the parabola's range"));
  cable.chord_tension = -1.0;
  CHECK_THROWS_WITH(check(cable), Catch::Contains("cable.chord_tension"));
}
