#include <catch2/catch.hpp>
#include <map>
#include <random>

#include "core/quadrature.hpp"
#include "models/multimode/potential_terms.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

CableModel cable(int out, int in, Longitudinal longitudinal = Longitudinal::galerkin, Terms terms = Terms::full) {
  CableModel m{.stay = oresund(0.5, 1.65)};
  m.out_of_plane = lowest_half_waves(out);
  m.in_plane = lowest_half_waves(in);
  m.longitudinal = longitudinal;
  m.terms = terms;
  return m;
}

Vector somewhere(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-3.0, 3.0);
  Vector q(n);
  for (int i = 0; i < n; ++i) q[i] = value(random);
  return q;
}

// Left-hand terms less forces, at one phase.
Vector pull(const ModalSystem<double>& s, const Vector& q, double phase) {
  Vector b(s.size());
  s.coupling<double>(std::span<const double>(q.data(), static_cast<std::size_t>(q.size())), phase,
                     std::span<double>(b.data(), static_cast<std::size_t>(b.size())));
  for (const auto& f : s.forces) b[f.equation] -= f.amplitude * std::cos(f.harmonic * phase);
  return b;
}

// Terms by equation, factors and harmonic: like ones added up.
std::map<std::vector<int>, double> sorted_terms(const ModalSystem<double>& s) {
  std::map<std::vector<int>, double> all;
  for (const auto& t : s.terms) {
    std::vector<int> factors(t.factor.begin(), t.factor.begin() + t.degree);
    std::sort(factors.begin(), factors.end());
    factors.insert(factors.begin(), {t.equation, t.cos_harmonic});
    all[factors] += t.coefficient;
  }
  for (const auto& f : s.forces) all[{f.equation, f.harmonic, -1}] += f.amplitude;
  return all;
}

// The stretching energy from its definition, in duals: r carries a slope so that the part to first order in r can be read off.
using R = Dual<double, 1>;  // slope in r
using Q = Dual<R, 1>;       // slope in one coordinate
template <class S>
S strain_energy(const CableModel& m, const std::vector<BasisMode<double>>& modes, const Vector& p, int along, const std::array<double, 3>& e,
                double r) {
  R ratio(r);
  ratio.d[0] = 1.0;
  const auto strain_at = [&](double xi) {
    Q in(0.0), out(0.0);
    for (int a = 0; a < m.size(); ++a) {
      Q x(p[a]);
      if (a == along) x.d[0] = R(1.0);
      const auto& mode = modes[static_cast<std::size_t>(a)];
      (mode.in_plane ? in : out) += x * mode.slope(xi);
    }
    const Q sag = Q(ratio) * (4.0 * (1.0 - 2.0 * xi)), u1(e[0]), u2 = in + e[1], u3 = out + e[2];
    return std::array<Q, 4>{u1, u2, u3, u1 + sag * u2 + (u1 * u1 + u2 * u2 + u3 * u3) * 0.5};
  };
  if (m.longitudinal == Longitudinal::galerkin)
    return integrate<Q, 100>([&](double xi) {
      const Q eps = strain_at(xi)[3];
      return eps * eps * 0.5;
    });
  const Q mean = integrate<Q, 100>([&](double xi) { return strain_at(xi)[3]; }) - 0.5 * e[0] * e[0];
  return mean * mean * 0.5;
}

}  // namespace

TEST_CASE("one mode in each plane is the two-mode stay", "[published]") {
  for (const Terms terms : {Terms::reduced, Terms::full})
    for (double theta : {30.4, 0.0, -20.0}) {
      CableModel m = cable(1, 1, Longitudinal::galerkin, terms);
      m.stay.cable.inclination_deg = theta;
      const auto ours = sorted_terms(cable_equations(m));
      const auto& stay = m.stay;
      const auto two = nielsen_kirkegaard(stay, stay_model(stay.cable, Coefficients::exact), terms);
      const auto theirs = sorted_terms(two);
      for (const auto& [key, value] : theirs) {
        INFO(key.size() << " of equation " << key[0] << ", harmonic " << key[1]);
        if (std::abs(value) < 1e-14) continue;  // no vertical component at theta = 0
        REQUIRE(ours.contains(key));
        CHECK(ours.at(key) == Approx(value).epsilon(1e-12));
      }
      for (const auto& [key, value] : ours) CHECK((theirs.contains(key) || std::abs(value) < 1e-15));
      const auto system = cable_equations(m);
      for (std::size_t i = 0; i < 2; ++i) {
        CHECK(system.stiffness[i] == Approx(two.stiffness[i]).epsilon(1e-13));
        CHECK(system.damping[i] == Approx(two.damping[i]).epsilon(1e-13));
      }
    }
}

// Section 3 of the source: 12 digits by quadrature, read off the terms of the N-mode model.
TEST_CASE("coefficients of the Oresund stay", "[published]") {
  const CableModel m = cable(1, 1);
  const auto terms = sorted_terms(cable_equations(m));
  const auto& c = m.stay.cable;
  const double L = c.chord_length, K = stiffness_rate(c), r = parabola(c).sag_ratio, e1 = 0.5 / L * std::cos(c.inclination_deg * pi / 180.0);
  const auto ratio = [&](std::vector<int> key, double unit) { return terms.at(key) / unit; };
  // given to 12 digits
  CHECK(ratio({0, 0, 0, 0, 0}, K / (L * L)) == Approx(36.5284091378).epsilon(2e-12));
  CHECK(ratio({0, 0, 0, 1, 1}, K / (L * L)) == Approx(36.3370402494).epsilon(2e-12));
  CHECK(ratio({1, 0, 0, 0, 1}, K / (L * L)) == Approx(36.4249870335).epsilon(2e-12));
  CHECK(ratio({1, 0, 1, 1, 1}, K / (L * L)) == Approx(36.2366565497).epsilon(2e-12));
  CHECK(ratio({0, 0, 0, 1}, K * r / L) == Approx(77.9504895752).epsilon(2e-12));
  CHECK(ratio({1, 0, 0, 0}, K * r / L) == Approx(39.0695768361).epsilon(2e-12));
  CHECK(ratio({1, 0, 1, 1}, K * r / L) == Approx(116.495404761).epsilon(5e-12));
  CHECK(ratio({0, 1, 0}, K * e1) == Approx(9.86960440109).epsilon(2e-12));
  CHECK(ratio({1, 1, 1}, K * e1) == Approx(9.86979216998).epsilon(2e-12));
}

TEST_CASE("out-of-plane motion of the support: the tensors of section 2") {
  CableModel m = cable(1, 1);
  m.direction = Direction::out_of_plane;
  const auto terms = sorted_terms(cable_equations(m));
  const auto& c = m.stay.cable;
  const double L = c.chord_length, K = stiffness_rate(c), e = 0.5 / L;
  const auto k = stay_model(c, Coefficients::exact).coefficients;
  // (e.e + 2 e3^2) C1 q1 and e.e C4 q2, half of each in harmonic 0, half in 2
  for (int h : {0, 2}) {
    CHECK(terms.at({0, h, 0}) == Approx(K * 1.5 * e * e * k.C1).epsilon(1e-12));
    CHECK(terms.at({1, h, 1}) == Approx(K * 0.5 * e * e * k.C4).epsilon(1e-12));
  }
  CHECK(terms.at({0, 1, -1}) == Approx(0.5 * m.stay.omega * m.stay.omega * (1.0 / pi) / 0.5).epsilon(1e-12));
  CHECK(cable_reflections(m).empty());
}

TEST_CASE("every term derives from the strain energy of its definition") {
  for (const Longitudinal longitudinal : {Longitudinal::galerkin, Longitudinal::quasi_static})
    for (const End end : {End::lower, End::upper})
      for (const Direction direction : {Direction::horizontal, Direction::vertical, Direction::chord, Direction::normal, Direction::out_of_plane}) {
        CableModel m = cable(3, 4, longitudinal);
        m.stay.cable.chord_tension = 2.0e6;  // a sag that matters
        m.stay.support_amplitude = 4.0;
        m.end = end;
        m.direction = direction;
        const auto& c = m.stay.cable;
        const double L = c.chord_length, th = c.inclination_deg * pi / 180.0, omega = m.stay.omega, sign = end == End::upper ? 1.0 : -1.0;
        const std::map<Direction, std::array<double, 3>> towards = {{Direction::horizontal, {std::cos(th), std::sin(th), 0.0}},
                                                                    {Direction::vertical, {std::sin(th), -std::cos(th), 0.0}},
                                                                    {Direction::chord, {1.0, 0.0, 0.0}},
                                                                    {Direction::normal, {0.0, 1.0, 0.0}},
                                                                    {Direction::out_of_plane, {0.0, 0.0, 1.0}}};
        const auto modes = basis_modes(m, parabola(c).irvine_lambda2);
        const auto system = cable_equations(m);
        for (const double phase : {0.3, 2.0}) {
          const Vector q = somewhere(m.size(), 7);
          const Vector b = pull(system, q, phase);
          std::array<double, 3> e = towards.at(direction);
          for (double& x : e) x *= sign * m.stay.support_amplitude / L * std::cos(phase);
          const double r = parabola(c).sag_ratio,
                       rate = stiffness_rate(c) * L / (longitudinal == Longitudinal::galerkin ? 1.0 : 1.0 + 8.0 / 3.0 * r * r);
          for (int a = 0; a < m.size(); ++a) {
            const auto& mode = modes[static_cast<std::size_t>(a)];
            const double mass = integrate<double, 60>([&](double xi) { return mode.shape(xi) * mode.shape(xi); });
            // dV/dp at r = 0 and its slope there: V to first order in r. Second order (the linear theory's part) drops out.
            const R slope = strain_energy<Q>(m, modes, q / L, a, e, 0.0).d[0];
            double expected = rate / mass * (slope.v + r * slope.d[0]);
            const double moment = integrate<double, 60>([&](double xi) { return mode.shape(xi) * (end == End::upper ? xi : 1.0 - xi); }) / mass;
            expected -= omega * omega * m.stay.support_amplitude * towards.at(direction)[mode.in_plane ? 1 : 2] * moment * std::cos(phase);
            CHECK(b[a] == Approx(expected).epsilon(1e-11).margin(1e-11 * b.norm()));
          }
        }
      }
}

TEST_CASE("a potential exists: mass-weighted stiffness is symmetric", "[slow]") {
  for (const Longitudinal longitudinal : {Longitudinal::galerkin, Longitudinal::quasi_static})
    for (const Shapes shapes : {Shapes::linear_modes, Shapes::sines}) {
      CableModel m = cable(4, 5, longitudinal);
      m.shapes = shapes;
      m.direction = Direction::vertical;
      const auto modes = basis_modes(m, parabola(m.stay.cable).irvine_lambda2);
      const auto system = cable_equations(m);
      const Vector q = somewhere(m.size(), 3);
      Matrix g(m.size(), m.size());
      for (int j = 0; j < m.size(); ++j) {
        std::vector<R> x, b(static_cast<std::size_t>(m.size()));
        for (int i = 0; i < m.size(); ++i) x.emplace_back(q[i]);
        x[static_cast<std::size_t>(j)].d[0] = 1.0;
        system.coupling<R>(x, 0.7, b);
        for (int i = 0; i < m.size(); ++i) g(i, j) = modes[static_cast<std::size_t>(i)].mass * b[static_cast<std::size_t>(i)].d[0];
      }
      CHECK((g - g.transpose()).lpNorm<Eigen::Infinity>() < 1e-14 * g.lpNorm<Eigen::Infinity>());
    }
}

TEST_CASE("with plain sines the linear frequencies tend to those of the linear theory") {
  double last = 1.0;
  for (const int count : {2, 6, 18}) {
    CableModel m = cable(0, count, Longitudinal::quasi_static);
    m.shapes = Shapes::sines;
    m.stay.cable.chord_tension = 1.4e6;  // lambda2 = 25
    m.stay.support_amplitude = 0.0;
    const auto s = cable_equations(m);
    Matrix k = Matrix::Zero(count, count);
    for (int i = 0; i < count; ++i) k(i, i) = s.stiffness[static_cast<std::size_t>(i)];
    for (const auto& t : s.terms)
      if (t.degree == 1 && t.cos_harmonic == 0) k(t.equation, t.factor[0]) += t.coefficient;
    const double lowest = std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix>(k).eigenvalues()[0]);
    const double exact = modes(m.stay.cable).omega2, error = lowest / exact - 1.0;
    CHECK(error > 0.0);                         // from above, as every Ritz value
    if (count > 2) CHECK(error < 0.06 * last);  // the rest falls as count^-3
    last = error;
  }
  CHECK(last < 3e-5);
}

TEST_CASE("uniform against uneven tension: one mode's cubic coefficient") {
  CableModel m = cable(1, 0);
  const double unit = stiffness_rate(m.stay.cable) / std::pow(m.stay.cable.chord_length, 2);
  CHECK(sorted_terms(cable_equations(m)).at({0, 0, 0, 0, 0}) / unit == Approx(3.0 / 8.0 * std::pow(pi, 4)).epsilon(1e-13));
  m.longitudinal = Longitudinal::quasi_static;
  const double r = parabola(m.stay.cable).sag_ratio;
  CHECK(sorted_terms(cable_equations(m)).at({0, 0, 0, 0, 0}) / unit * (1.0 + 8.0 / 3.0 * r * r) == Approx(0.25 * std::pow(pi, 4)).epsilon(1e-13));
}

TEST_CASE("entries that symmetry forbids are not stored, and none is missing") {
  CableModel m = cable(5, 5);
  m.direction = Direction::vertical;
  const auto s = cable_equations(m);
  double largest = 0.0;
  for (const auto& t : s.terms)
    if (t.degree == 3) largest = std::max(largest, std::abs(t.coefficient));
  int tiny = 0, cubic = 0;
  for (const auto& t : s.terms)
    if (t.degree == 3) {
      ++cubic;
      tiny += std::abs(t.coefficient) < 1e-13 * largest;
    }
  CHECK(tiny == 0);
  CHECK(cubic < 10 * 220 / 2);  // of the 10 * 220 of a full tensor
}

TEST_CASE("lenses: the same list of terms, slopes against differences") {
  CableModel m = cable(2, 3, Longitudinal::galerkin);
  m.end = End::lower;
  m.direction = Direction::vertical;
  for (const char* name : {"omega", "support_amplitude", "chord_tension", "inclination_deg", "damping", "chord_length"}) {
    INFO(name);
    const auto system = cable_system(m, {Lens(name)});
    const double p = system.reference()[0], h = 1e-5 * p;
    ModalSystem<ParametricSystem::Slopes> s;
    const ParametricSystem::Slopes at = seed<ParametricSystem::Slopes>(p, 0);
    for (int again = 0; again < 2; ++again) {  // also into the list of the first time
      system.at(std::span<const ParametricSystem::Slopes>(&at, 1), s);
      ModalSystem<double> up, down;
      const double above = p + h, below = p - h;
      system.at(std::span<const double>(&above, 1), up);
      system.at(std::span<const double>(&below, 1), down);
      REQUIRE(up.terms.size() == s.terms.size());
      REQUIRE(up.forces.size() == s.forces.size());
      for (std::size_t i = 0; i < s.terms.size(); ++i) {
        const double slope = (up.terms[i].coefficient - down.terms[i].coefficient) / (2.0 * h), scale = std::abs(up.terms[i].coefficient / p);
        CHECK(s.terms[i].coefficient.d[0] == Approx(slope).epsilon(1e-7).margin(1e-7 * scale));
      }
      for (std::size_t i = 0; i < s.forces.size(); ++i)
        CHECK(s.forces[i].amplitude.d[0] == Approx((up.forces[i].amplitude - down.forces[i].amplitude) / (2.0 * h)).epsilon(1e-7).margin(1e-7));
      for (std::size_t i = 0; i < s.stiffness.size(); ++i)
        CHECK(s.stiffness[i].d[0] == Approx((up.stiffness[i] - down.stiffness[i]) / (2.0 * h)).epsilon(1e-7).margin(1e-9));
    }
  }
}

TEST_CASE("mean tension is the energy's slope with the stretching of the chord") {
  CableModel m = cable(2, 3, Longitudinal::quasi_static);
  m.direction = Direction::chord;
  const Vector q = somewhere(5, 11);
  const double T = mean_tension(m, q, 0.4), a = m.stay.cable.axial_stiffness, r = parabola(m.stay.cable).sag_ratio;
  const auto modes = basis_modes(m, parabola(m.stay.cable).irvine_lambda2);
  const double e = 0.5 / m.stay.cable.chord_length * std::cos(0.4);
  const double mean = integrate<double, 100>([&](double xi) {
    double v = 0.0, w = 0.0;
    for (int i = 0; i < 5; ++i) (i < 2 ? w : v) += modes[static_cast<std::size_t>(i)].slope(xi) * q[i] / m.stay.cable.chord_length;
    return e + r * 4.0 * (1.0 - 2.0 * xi) * v + 0.5 * (v * v + w * w);
  });
  CHECK(T == Approx(m.stay.cable.chord_tension + a / (1.0 + 8.0 / 3.0 * r * r) * mean).epsilon(1e-13));
}

TEST_CASE("model options that make no sense are refused") {
  CableModel m = cable(1, 1);
  m.in_plane = {1, 1};
  CHECK_THROWS_AS(cable_system(m, {}), std::invalid_argument);
  m.in_plane = {0};
  CHECK_THROWS_AS(cable_system(m, {}), std::invalid_argument);
  m.in_plane.clear();
  m.out_of_plane.clear();
  CHECK_THROWS_AS(cable_system(m, {}), std::invalid_argument);
}

TEST_CASE("harmonic balance knows the symmetries of many modes") {
  // Planar motion under chord motion has no shift symmetry; a string driven across has: odd half waves change sign, even ones too.
  for (const int count : {2, 20}) {
    CableModel m = cable(count, count);
    m.stay.cable.gravity = 0.0;
    m.direction = Direction::normal;
    m.terms = Terms::reduced;
    const HarmonicBalance hb(cable_system(m, {Lens("omega")}), {.harmonics = 2, .reflections = cable_reflections(m)});
    std::vector<std::string> names;
    for (const auto& r : hb.reflections()) names.push_back(r.subtype);
    CHECK(names == std::vector<std::string>{"WH", "SB", "SB"});  // and those two: in plane shifted, all shifted
  }
  CableModel m = cable(1, 2);
  const HarmonicBalance hb(cable_system(m, {Lens("omega")}), {.harmonics = 2, .reflections = cable_reflections(m)});
  REQUIRE(hb.reflections().size() == 1);
  CHECK(hb.reflections()[0].subtype == "WH");
}

TEST_CASE("integrated motion of many modes is the balanced one", "[slow]") {
  CableModel m = cable(2, 3, Longitudinal::quasi_static);
  m.stay.support_amplitude = 0.15;
  m.stay.omega = 1.65;
  const HarmonicBalance hb(cable_system(m, {Lens("omega")}), {.harmonics = 18, .reflections = cable_reflections(m)});
  const auto at = newton(hb, hb.linear_response(Vector::Constant(1, 1.65)), {.max_iterations = 30});
  REQUIRE(at.ok());
  const Vector orbit = hb.state_at(at.x, 0.0);
  Vector start = orbit;
  start[0] += 1e-3;  // out of plane too
  const SteadyMotion motion = settle(cable_equations(m), start, {.tolerance = 1e-9});
  REQUIRE(motion.kind == MotionKind::periodic);
  REQUIRE(motion.multiple == 1);
  CHECK((motion.state - orbit).lpNorm<Eigen::Infinity>() < 1e-7);  // settled to 1e-9 of the state, integrated to 1e-10
}
