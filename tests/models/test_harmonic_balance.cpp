#include <catch2/catch.hpp>

#include "continuation/network.hpp"
#include "models/harmonic_balance.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;
using continuation::Branch;
using continuation::EventType;
using continuation::SpecialPoint;
using continuation::Walker;

namespace {

// Periodic motion of nk-reduced, U = 0.5 m: q1, q2, q1', q2' at cos(omega t) = 1 and multipliers over nu periods.
// AUTO-07p and a Newton on the Poincare map, agreeing to 1e-9 .. 1e-11.
struct Row {
  const char* branch;
  double omega;
  int nu;
  double state[4];
  std::complex<double> multipliers[4];
};
// clang-format off
const Row rows[] = {
    {"IP", 0.95, 1, {0, -0.887087844344, 0, -0.130183389689},
    {{-0.0630135627518, 0.809612865807}, {-0.0630135627518, -0.809612865807}, {-0.690051322537, 0.422676961698}, {-0.690051322537, -0.422676961698}}},
    {"IP", 1.15, 1, {0, -1.73515193853, 0, -11.280998595},
     {{0.639476309264, 0.547754971738}, {0.639476309264, -0.547754971738}, {0.755350254212, 0.366481148507}, {0.755350254212, -0.366481148507}}},
    {"IP", 1.15, 1, {0, 0.82987425859, 0, -11.8640254306},
     {{1.36673425778, 0}, {0.515053466813, 0.666097129177}, {0.515053466813, -0.666097129177}, {0.515727497672, 0}}},
    {"IP", 1.15, 1, {0, 0.572095213084, 0, -0.403722901968},
     {{-0.350487079658, 0.765587530049}, {-0.350487079658, -0.765587530049}, {0.232428503107, 0.806746199057}, {0.232428503107, -0.806746199057}}},
    {"IP", 1.47, 1, {0, 0.7034620501, 0, 0.398701767881},
     {{0.566729552273, 0.665509809018}, {0.566729552273, -0.665509809018}, {-0.182798449943, 0.852765401866}, {-0.182798449943, -0.852765401866}}},
    {"IP", 1.67, 1, {0, 2.07239838235, 0, 2.47516616606},
     {{1.18586438507, 0}, {0.445256333247, 0.766621279984}, {0.445256333247, -0.766621279984}, {0.665429427391, 0}}},
    {"IP", 1.89, 1, {0, 3.23575922945, 0, 12.7175908573},
     {{0.852301510511, 0.291117759938}, {0.852301510511, -0.291117759938}, {0.72722598079, 0.528630402708}, {0.72722598079, -0.528630402708}}},
    {"IP", 1.97, 1, {0, 2.11014814033, 0, 21.2488122469},
     {{0.810240117986, 0.401997043797}, {0.810240117986, -0.401997043797}, {0.85052402303, 0.303203542326}, {0.85052402303, -0.303203542326}}},
    {"IP", 1.97, 1, {0, -0.63353524139, 0, 24.142474025},
     {{1.28712174274, 0}, {0.761322493658, 0.488342843364}, {0.761322493658, -0.488342843364}, {0.633447074008, 0}}},
    {"IP", 1.89, 1, {0, -2.8694245038, 0, 18.1898053841},
     {{1.56725610634, 0}, {0.703874279766, 0.561897155408}, {0.703874279766, -0.561897155408}, {0.515747060441, 0}}},
    {"IP", 1.89, 1, {0, -1.47823869462, 0, 0.123908660125},
     {{-0.679298559582, 0.591372033429}, {-0.679298559582, -0.591372033429}, {-0.426039720561, 0.791705681619}, {-0.426039720561, -0.791705681619}}},
    {"IP", 1.97, 1, {0, -1.40726981527, 0, 0.0554309024326},
     {{-0.875077063024, 0.22875927475}, {-0.875077063024, -0.22875927475}, {-0.710043286481, 0.557818996767}, {-0.710043286481, -0.557818996767}}},
    {"IP", 2.11, 1, {0, -1.38201117117, 0, -0.0115849179128},
     {{-1.08373761814, 0}, {-0.897847982162, 0.151430595128}, {-0.897847982162, -0.151430595128}, {-0.762586534878, 0}}},
    {"IP", 2.31, 1, {0, -1.47611050668, 0, -0.0805273137035},
     {{-0.486473555362, 0.778441667871}, {-0.486473555362, -0.778441667871}, {-0.774784752673, 0.489801255336}, {-0.774784752673, -0.489801255336}}},
    {"W0", 1.67, 1, {-1.35777835586, 1.6643108898, 7.34506081228, 4.43797516744},
     {{0.777714436783, 0.428667247203}, {0.777714436783, -0.428667247203}, {0.255181172535, 0.849326761209}, {0.255181172535, -0.849326761209}}},
    {"W0", 1.77, 1, {-2.82178872269, 1.40685471443, 7.38441050095, 10.5734711884},
     {{0.810966159553, 0.375171847425}, {0.810966159553, -0.375171847425}, {0.0325146320212, 0.892742185126}, {0.0325146320212, -0.892742185126}}},
    {"W0", 1.81, 1, {-3.58003705918, 0.57342126784, 3.62496263319, 13.9787784875},
     {{-0.0531799431768, 0.894090897295}, {-0.0531799431768, -0.894090897295}, {0.858864490668, 0.254089591471}, {0.858864490668, -0.254089591471}}},
    {"W0", 1.81, 1, {-3.47319253348, -1.42597246583, -6.37581677871, 13.4742234682},
     {{1.2396812457, 0}, {0.0877980725161, 0.891461871123}, {0.0877980725161, -0.891461871123}, {0.646959574066, 0}}},
    {"W0", 1.77, 1, {-2.52145254341, -2.07084995572, -10.7524835632, 9.09295488442},
     {{1.37906431719, 0}, {0.426422438556, 0.785373283856}, {0.426422438556, -0.785373283856}, {0.578521761135, 0}}},
    {"W0", 1.77, 1, {-1.9482799618, -1.11387476757, -13.2282496031, 6.20276834498},
     {{1.28702679244, 0.477923889924}, {1.28702679244, -0.477923889924}, {0.545173471797, 0.202082168151}, {0.545173471797, -0.202082168151}}},
    {"W0", 1.81, 1, {-2.43135074679, -0.199972728225, -12.8063968196, 7.60517803852},
     {{1.24444442186, 0.414978996958}, {1.24444442186, -0.414978996958}, {0.580164124033, 0.193349943832}, {0.580164124033, -0.193349943832}}},
    {"W0", 1.81, 1, {-2.41063777337, 2.06719248788, -4.7435613836, 7.384941321},
     {{1.18062811149, 0}, {0.695945216888, 0.562782499518}, {0.695945216888, -0.562782499518}, {0.680463341103, 0}}},
    {"W0", 1.77, 1, {-0.638449112864, 2.78798695476, -0.723096932881, 5.53094157086},
     {{1.0224285475, 0}, {0.587073152229, 0.672379991485}, {0.587073152229, -0.672379991485}, {0.782175749522, 0}}},
    {"D0", 2.09, 2, {-0.423329253468, -1.25871096099, 6.4256181712, 0.107417329037},
     {{0.500777234645, 0.658853935716}, {0.500777234645, -0.658853935716}, {0.635698924718, 0.52576128641}, {0.635698924718, -0.52576128641}}},
    {"D0", 2.19, 2, {-0.861328707281, -1.13656916385, 9.75101915012, 0.241016859099},
     {{0.449151105923, 0.703611105961}, {0.449151105923, -0.703611105961}, {0.83001763113, 0.0606286511987}, {0.83001763113, -0.0606286511987}}},
    {"D0", 2.23, 2, {-1.09474089498, -1.09676236649, 10.83897412, 0.312756717453},
     {{1.20035223202, 0}, {0.47683115224, 0.688454295371}, {0.47683115224, -0.688454295371}, {0.580813767534, 0}}},
    {"D0", 2.23, 2, {-2.41640796293, -1.24522097819, 4.26669786383, 0.295141705878},
     {{2.07119335496, 0}, {1.5653338421, 0}, {0.445376894041, 0}, {0.338623598627, 0}}},
    {"D0", 2.19, 2, {-2.06543619627, -1.28648885914, 3.02924224972, 0.199426658728},
     {{2.01401996111, 0}, {1.47785322112, 0}, {0.468643411709, 0}, {0.345986811907, 0}}},
    {"D1", 2.17, 2, {0, -1.52301272679, 0, 7.69866205875},
     {{0.701439634642, 0.449987770218}, {0.701439634642, -0.449987770218}, {0.593236059703, 0.581651218292}, {0.593236059703, -0.581651218292}}},
    {"D1", 2.29, 2, {0, -1.97607047766, 0, 12.2866431975},
     {{0.593823944228, 0.596049112981}, {0.593823944228, -0.596049112981}, {0.567448531633, 0.61789067411}, {0.567448531633, -0.61789067411}}},
    {"D1", 2.29, 2, {0, -3.46268850711, 0, 6.30849435566},
     {{1.83646501681, 0}, {0.48871116595, 0.68488160882}, {0.48871116595, -0.68488160882}, {0.383229037723, 0}}},
    {"S0", 2.19, 2, {1.27678870615, -0.742792421552, -7.53386037185, 4.76449666475},
     {{1.20147747484, 0}, {0.483907996219, 0.678753412236}, {0.483907996219, -0.678753412236}, {0.578064067225, 0}}},
};
// clang-format on

constexpr double two_pi = 6.283185307179586;

// The motion through `state` over nu excitation periods, integrated: where a balance may start, stable or not.
SteadyMotion record(const ModalSystem<double>& system, const Vector& state, int nu) {
  SteadyMotion m;
  m.kind = MotionKind::periodic;
  m.multiple = m.record_periods = nu;
  m.omega = system.omega;
  m.state = state;
  m.record.resize(state.size(), 128 * nu);
  const auto flow = [&](double t, std::span<const double> y, std::span<double> d) { system.flow<double>(system.omega * t, y, d); };
  Integrator run(flow, 0.0, state, {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-12});
  m.record.col(0) = state;
  for (int j = 1; j < m.record.cols(); ++j) {
    REQUIRE(run.advance(j * two_pi / system.omega / 128));
    m.record.col(j) = run.state();
  }
  return m;
}

Vector one(double x) { return Vector::Constant(1, x); }

Orbit orbit_at(const Row& row, double tolerance) {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(0.5, row.omega), {Lens("omega")}, {.harmonics = 15 * row.nu, .nu = row.nu});
  const Vector p = one(row.omega), state = Eigen::Map<const Vector>(row.state, 4);
  Vector zero = Vector::Zero(hb.size() + 1);
  zero.tail(1) = p;
  return solve_orbit(hb, hb.from_motion(record(hb.system_at(zero), state, row.nu), p), {.tolerance = tolerance});
}

// Largest distance of a multiplier in `a` from the nearest in `b`.
template <class A, class B>
double distance(const A& a, const B& b) {
  double worst = 0.0;
  for (const auto& z : a) {
    double nearest = 1e9;
    for (const auto& y : b) nearest = std::min(nearest, std::abs(std::complex<double>(z) - std::complex<double>(y)));
    worst = std::max(worst, nearest);
  }
  return worst;
}

Vector somewhere(const HarmonicBalance& hb) {
  Vector u(hb.size() + hb.parameters());
  for (int i = 0; i < u.size(); ++i) u[i] = std::sin(1.7 + 2.9 * i) / (1.0 + 0.2 * (i % (2 * hb.harmonics() + 1)));
  u.tail(hb.parameters()) = hb.system().reference();
  return u;
}

// Fourth-order difference of f along d: exact for polynomials of degree 4.
template <class F>
Matrix slope(F f, const Vector& u, const Vector& d, double h) {
  return (8.0 * (f(u + h * d) - f(u - h * d)) - (f(u + 2.0 * h * d) - f(u - 2.0 * h * d))) / (12.0 * h);
}

void check_derivatives(const HarmonicBalance& hb, double h, double tolerance) {
  const int n = hb.size(), m = n + hb.parameters();
  const Vector u = somewhere(hb);
  Vector v(m), w(m), scale = Vector::Ones(m);
  for (int i = 0; i < m; ++i) v[i] = std::cos(0.3 + 1.3 * i), w[i] = std::sin(0.7 * i);
  scale.tail(hb.parameters()) = u.tail(hb.parameters()).cwiseAbs();
  v.array() *= scale.array();
  w.array() *= scale.array();
  const auto residual = [&](const Vector& x) {
    Vector r(n);
    hb.residual(x, r);
    return Matrix(r);
  };
  const auto jacobian = [&](const Vector& x) {
    Matrix j(n, m);
    hb.jacobian(x, j);
    return j;
  };
  const auto second = [&](const Vector& x) {
    Matrix s(n, m);
    hb.second(x, v, s);
    return s;
  };
  const Matrix j = jacobian(u), s = second(u);
  Matrix by_differences(n, m);
  for (int i = 0; i < m; ++i) by_differences.col(i) = slope(residual, u, Vector::Unit(m, i), h * scale[i]);
  CHECK((j - by_differences).lpNorm<Eigen::Infinity>() < tolerance * j.lpNorm<Eigen::Infinity>());
  CHECK((s - slope(jacobian, u, v, h)).lpNorm<Eigen::Infinity>() < tolerance * s.lpNorm<Eigen::Infinity>());
  Vector t(n);
  hb.third(u, v, w, w, t);
  const Vector reference = slope(second, u, w, h) * w;
  CHECK((t - reference).lpNorm<Eigen::Infinity>() < tolerance * reference.lpNorm<Eigen::Infinity>());
  Vector r(n);
  Matrix again(n, m);
  hb.linearise(u, r, again);
  CHECK((r - residual(u)).lpNorm<Eigen::Infinity>() < 1e-13 * r.lpNorm<Eigen::Infinity>());  // the same sums in another order
}

std::vector<double> parameters_of(const Branch& branch, EventType type) {
  std::vector<double> p;
  for (const auto& s : branch.special)
    if (s.type == type) p.push_back(s.u[s.u.size() - 1]);
  std::sort(p.begin(), p.end());
  return p;
}

void check_values(const std::vector<double>& found, std::vector<double> expected, double margin) {
  std::sort(expected.begin(), expected.end());
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i] == Approx(expected[i]).margin(margin).epsilon(0.0));
}

ModalSystem<double> duffing(double damping, double cubic, double force, double omega) {
  ModalSystem<double> s;
  s.omega = omega;
  s.damping = {damping};
  s.stiffness = {1.0};
  s.add_term(0, cubic, {0, 0, 0});
  s.add_force(0, force, 1);
  return s;
}

}  // namespace

TEST_CASE("harmonic balance: derivatives are exact") {
  // Polynomials in the unknowns, omega and U: the difference formula is exact, what is left is rounding over the step.
  check_derivatives(stay_harmonic_balance(oresund(), {Lens("omega"), Lens("support_amplitude")}, {.harmonics = 4}, Terms::full), 0.1, 1e-11);
  check_derivatives(stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 5, .nu = 2}), 0.1, 1e-11);
  // Modes and coefficients move with the tension: fourth order in a step of 1 %, coefficients of order 10.
  check_derivatives(stay_harmonic_balance(oresund(), {Lens("chord_tension"), Lens("omega")}, {.harmonics = 3}), 0.01, 1e-6);
  check_derivatives(HarmonicBalance(ParametricSystem::over_omega(duffing(0.05, 0.1, 0.18, 1.2)), {.harmonics = 6, .nu = 3}), 0.1, 1e-11);
}

TEST_CASE("harmonic balance: the residual is the equation of motion's, harmonic by harmonic") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 4, .nu = 2}, Terms::full);
  const Vector u = somewhere(hb);
  const auto system = hb.system_at(u);
  Vector r(hb.size());
  hb.residual(u, r);
  const int samples = 400;  // far beyond the 30 harmonics there are
  Vector projected = Vector::Zero(hb.size());
  for (int m = 0; m < samples; ++m) {
    const double theta = two_pi * m / samples, t = theta * hb.nu() / system.omega, step = 1e-3;
    const Vector y = hb.state_at(u, t);
    std::vector<double> d(4), state(y.data(), y.data() + 4);
    system.flow<double>(system.omega * t, state, d);
    const Vector acceleration =
        (8.0 * (hb.state_at(u, t + step) - hb.state_at(u, t - step)) - hb.state_at(u, t + 2.0 * step) + hb.state_at(u, t - 2.0 * step)) /
        (12.0 * step);
    for (int i = 0; i < 2; ++i) {
      const double defect = acceleration[2 + i] - d[std::size_t(2 + i)];
      projected[hb.index(i, 0)] += defect / samples;
      for (int k = 1; k <= 4; ++k) {
        projected[hb.index(i, k)] += 2.0 * defect * std::cos(k * theta) / samples;
        projected[hb.index(i, k) + 1] += 2.0 * defect * std::sin(k * theta) / samples;
      }
    }
  }
  CHECK((projected - r).lpNorm<Eigen::Infinity>() < 1e-9 * r.lpNorm<Eigen::Infinity>());  // differences of fourth order, step 1e-3 s
}

TEST_CASE("harmonic balance: reflections") {
  const auto names = [](const HarmonicBalance& hb) {
    std::vector<std::string> list;
    for (const auto& r : hb.reflections()) list.push_back(r.subtype);
    return list;
  };
  using Names = std::vector<std::string>;
  CHECK(names(stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 3})) == Names{"WH"});
  CHECK(names(stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 3, .nu = 2})) == Names{"PD", "WH", "SB"});
  CHECK(names(stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 3, .nu = 3})) == Names{"WH"});
  const auto system = ParametricSystem::over_omega(duffing(0.05, 0.1, 0.18, 1.0));
  CHECK(names(HarmonicBalance(system, {.harmonics = 3})) == Names{"SB"});
  CHECK_THROWS_AS(HarmonicBalance(system, {.harmonics = 3, .reflections = {{{-1}, "WH"}}}), std::invalid_argument);  // the force breaks it
  CHECK_THROWS_AS(HarmonicBalance(system, {.harmonics = 3, .reflections = {{{-1, 1}, "WH"}}}), std::invalid_argument);
  CHECK_THROWS_AS(HarmonicBalance(system, {.harmonics = 0}), std::invalid_argument);
}

TEST_CASE("harmonic balance: what a symmetry forbids stays zero to the last bit") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 24, .nu = 2});
  const NewtonResult at = newton(hb, hb.linear_response(one(2.15)));
  REQUIRE(at.ok());
  for (int k = 0; k <= hb.harmonics(); ++k) {
    CHECK(at.x[hb.index(0, k)] == 0.0);  // planar
    if (k % 2 == 1) CHECK(at.x[hb.index(1, k)] == 0.0);
  }
  Matrix j(hb.size(), hb.size() + 1);
  hb.jacobian(at.x, j);
  for (const auto& r : hb.reflections())
    for (int a = 0; a < hb.size(); ++a)
      for (int b = 0; b < hb.size(); ++b)
        if (r.signs[a] != r.signs[b] && r.subtype != "SB") REQUIRE(j(a, b) == 0.0);
}

TEST_CASE("harmonic balance: periodic motions of the Oresund stay, states and multipliers") {
  for (const Row& row : rows) {
    INFO(row.branch << " at omega = " << row.omega);
    const Orbit orbit = orbit_at(row, 1e-12);  // far below what is compared
    REQUIRE(orbit.ok);
    const Vector state = orbit.problem->state_at(orbit.u, 0.0);
    for (int i = 0; i < 4; ++i) CHECK(state[i] == Approx(row.state[i]).margin(1e-9).epsilon(0.0));  // agreement of the references
    const FloquetResult& floquet = orbit.problem->floquet(orbit.u);
    CHECK(floquet.converged);
    CHECK(distance(floquet.multipliers, row.multipliers) < 1e-8);  // the references agree to 1e-9, a multiplier moves ten times as much
    CHECK(floquet.blocks.size() == (row.state[0] == 0.0 ? 2u : 1u));
    CHECK(floquet.multipliers.prod().real() == Approx(std::exp(-two_pi * row.nu / row.omega * 2.0 * 0.01 * (3.14761321417 + 3.2007293317))));
  }
}

TEST_CASE("Floquet: collocation agrees with CVODE on integrated motions", "[slow]") {
  for (const Row& row : rows) {
    if (std::string(row.branch) == "IP" && row.omega != 1.97) continue;
    INFO(row.branch << " at omega = " << row.omega);
    const Orbit orbit = orbit_at(row, 1e-12);
    const auto system = orbit.problem->system_at(orbit.u);
    const IntegratedPeriod period = monodromy_by_integration(system, orbit.problem->state_at(orbit.u, 0.0), row.nu);
    REQUIRE(period.ok);
    const FloquetResult& floquet = orbit.problem->floquet(orbit.u);
    // CVODE at a relative tolerance of 1e-13 a step
    CHECK((floquet.monodromy - period.monodromy).lpNorm<Eigen::Infinity>() < 1e-9 * period.monodromy.lpNorm<Eigen::Infinity>());
    CHECK(distance(floquet.multipliers, period.monodromy.eigenvalues()) < 1e-9);
    CHECK(floquet.error < 1e-11);
    if (floquet.blocks.size() == 1) CHECK_THROWS_AS(orbit.problem->floquet(orbit.u, {{0}, {1}}), std::invalid_argument);
    else CHECK(distance(orbit.problem->floquet(orbit.u, {{0, 1}}).multipliers, period.monodromy.eigenvalues()) < 1e-9);
  }
}

TEST_CASE("harmonic balance: the limit of many harmonics is the periodic orbit") {
  for (const Row& row : rows) {
    if (!(row.omega == 1.77 || row.omega == 2.19)) continue;
    INFO(row.branch << " at omega = " << row.omega);
    const Orbit orbit = orbit_at(row, 1e-13);
    REQUIRE(orbit.ok);
    const IntegratedOrbit exact = periodic_by_integration(orbit.problem->system_at(orbit.u), Eigen::Map<const Vector>(row.state, 4), row.nu);
    REQUIRE(exact.ok);
    const double error = (exact.state - orbit.problem->state_at(orbit.u, 0.0)).lpNorm<Eigen::Infinity>() / exact.state.norm();
    CHECK(error < 1e-10);  // what CVODE at 1e-13 a step leaves after the periods
  }
}

TEST_CASE("harmonic balance: the truncation estimate tells the error") {
  for (const Row& row : rows) {
    if (row.omega != 1.77 && row.omega != 2.17 && row.omega != 1.47) continue;
    const Orbit exact = orbit_at(row, 1e-14);
    for (int H : {8, 12, 16}) {
      const HarmonicBalance coarse = exact.problem->with_harmonics(H * row.nu);
      const NewtonResult at = newton(coarse, coarse.carry(*exact.problem, exact.u));
      REQUIRE(at.ok());
      const Truncation estimate = coarse.truncation(at.x);
      const Eigen::MatrixXd a = exact.problem->observe(exact.u).cwiseAbs();
      double error = 0.0;  // largest sum of changes over the coordinates, like the estimate
      const Eigen::MatrixXcd e = exact.problem->observe(exact.u - exact.problem->carry(coarse, at.x));
      for (int i = 0; i < 2; ++i) error = std::max(error, e.row(i).cwiseAbs().sum());
      error /= a.maxCoeff();
      INFO(row.branch << " at omega = " << row.omega << ", H = " << H << ": error " << error << ", estimate " << estimate.error);
      if (error < 1e-12) continue;          // rounding
      CHECK(estimate.error > 0.5 * error);  // first order in the harmonics left out
      CHECK(estimate.error < 2.0 * error);
      CHECK(coarse.tail(at.x) < 1.0);
    }
  }
}

TEST_CASE("harmonic balance: from a settled motion") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(0.5, 1.65), {Lens("omega")}, {.harmonics = 20});
  Vector start(4), zero = Vector::Zero(hb.size() + 1);
  start << 1.0, 1.0, 0.0, 0.0;
  zero.tail(1) = one(1.65);
  const SteadyMotion motion = settle(hb.system_at(zero), start);
  REQUIRE(motion.multiple == 1);
  const Vector u = hb.from_motion(motion, one(1.65));
  const NewtonResult at = newton(hb, u);
  REQUIRE(at.ok());
  CHECK((at.x - u).lpNorm<Eigen::Infinity>() < 1e-6);  // settled to 1e-8 of the state
  const Eigen::MatrixXd a = hb.observe(at.x).cwiseAbs();
  // physics page, section 5: three digits
  CHECK(a(0, 1) == Approx(0.756).epsilon(0).margin(5e-4));
  CHECK(a(0, 2) == Approx(2.059).epsilon(0).margin(5e-4));
  CHECK(a(1, 1) == Approx(1.567).epsilon(0).margin(5e-4));
  CHECK(a(1, 2) == Approx(2.459).epsilon(0).margin(5e-4));
}

TEST_CASE("harmonic balance: in-plane folds and whirling points of the Oresund stay by the walker", "[slow]") {
  const HarmonicBalance hb = stay_harmonic_balance(oresund(), {Lens("omega")}, {.harmonics = 40});
  Walker walker(hb, {.lower = 1.0, .upper = 2.3});
  const Branch branch = walker.walk(hb.linear_response(one(2.3)));
  CHECK(branch.stop_reason == continuation::StopReason::parameter_bound);
  check_values(parameters_of(branch, EventType::fold), {1.15867469377, 1.11215361987, 1.98244040998, 1.70366257099}, 1e-9);  // as referenced
  check_values(parameters_of(branch, EventType::branch_point), {1.58096018215, 1.76702117141}, 1e-9);
  CHECK(parameters_of(branch, EventType::unresolved).empty());
  double worst = 0.0;
  for (int i = 0; i < branch.points(); i += 8) {
    worst = std::max(worst, hb.truncation(branch.u(i)).error);
    for (int k = 0; k <= hb.harmonics(); ++k) REQUIRE(branch.u(i)[hb.index(0, k)] == 0.0);
  }
  for (const SpecialPoint& s : branch.special) {
    if (s.type != EventType::fold && s.type != EventType::branch_point) continue;
    if (s.type == EventType::branch_point) CHECK(s.subtype == "WH");
    CHECK(hb.tail(s.u) < 1e-10);
    const auto& mu = hb.floquet(s.u).multipliers;
    CHECK(distance(std::vector<double>{1.0}, mu) < 1e-6);  // a multiplier at a fold moves with the root of the parameter's error
  }
  CHECK(worst < 1e-10);
}

TEST_CASE("harmonic balance: Duffing's folds") {
  const auto folds = [](const ModalSystem<double>& system, double lower, double upper) {
    const HarmonicBalance hb(ParametricSystem::over_omega(system), {.harmonics = 15});
    const Branch branch = Walker(hb, {.lower = lower, .upper = upper}).walk(hb.linear_response(one(lower)));
    for (const SpecialPoint& s : branch.special) CHECK(hb.tail(s.u) < 1e-12);
    return parameters_of(branch, EventType::fold);
  };
  check_values(folds(duffing(0.05, 0.1, 0.18, 1.0), 0.6, 1.6), {1.269601956, 1.115700252}, 1e-9);  // digits given
  check_values(folds(duffing(0.04, 1.0, 0.015, 1.0), 0.6, 1.6), {1.049262399, 1.043913709}, 1e-9);
}

TEST_CASE("harmonic balance: the 1:2 pair x1'' + .005 x1' + x1 + x1 x2 = .01 cos Wt, x2'' + .01 x2' + 4 x2 + x1^2 = 0") {
  ModalSystem<double> s;
  s.omega = 1.0;
  s.damping = {0.005, 0.01};
  s.stiffness = {1.0, 4.0};
  s.add_term(0, 1.0, {0, 1});
  s.add_term(1, 1.0, {0, 0});
  s.add_force(0, 0.01, 1);
  const HarmonicBalance hb(ParametricSystem::over_omega(s), {.harmonics = 16});
  REQUIRE(hb.reflections().size() == 1);  // x1(t + T/2) = -x1(t), x2(t + T/2) = x2(t)
  const Branch branch = Walker(hb, {.lower = 0.55, .upper = 1.3}).walk(hb.linear_response(one(1.3)));
  check_values(parameters_of(branch, EventType::fold), {0.957464503, 1.037806516, 1.078209077, 0.608382792}, 1e-9);  // digits given
  // The published torus points are good to 2.4e-9: at theirs the integrated multipliers are off the unit circle by 5e-8, at these by 1e-12.
  check_values(parameters_of(branch, EventType::torus), {0.987743367, 1.009666608}, 2.5e-9);
  check_values(parameters_of(branch, EventType::torus), {0.9877433646379, 1.0096666087761}, 1e-11);
  for (const SpecialPoint& p : branch.special) {
    if (p.type != EventType::torus) continue;
    const IntegratedPeriod period = monodromy_by_integration(hb.system_at(p.u), hb.state_at(p.u, 0.0), 1);
    double nearest = 1.0;
    for (const auto& mu : Eigen::VectorXcd(period.monodromy.eigenvalues())) nearest = std::min(nearest, std::abs(std::abs(mu) - 1.0));
    CHECK(nearest < 1e-10);  // CVODE at 1e-13 a step
  }
  // The published branch points are good to 2e-8; the integrated multiplier below and 12 to 32 harmonics hold these.
  check_values(parameters_of(branch, EventType::branch_point), {0.723512355, 0.724072490}, 2e-8);
  check_values(parameters_of(branch, EventType::branch_point), {0.7235123569968, 0.7240724751716}, 1e-11);
  for (const SpecialPoint& p : branch.special) {
    if (p.type != EventType::branch_point) continue;
    CHECK(p.subtype == "SB");
    const IntegratedPeriod period = monodromy_by_integration(hb.system_at(p.u), hb.state_at(p.u, 0.0), 1);
    CHECK(distance(std::vector<double>{1.0}, period.monodromy.eigenvalues()) < 1e-9);  // CVODE at 1e-13 a step
  }
}

TEST_CASE("Floquet: threshold of parametric resonance at twice the natural frequency") {
  const double w = 3.0;
  for (const auto& [zeta, expected] : {std::pair{0.001, 0.004}, {0.002, 0.008}, {0.005, 0.02}}) {
    const auto largest = [&](double e) {
      ModalSystem<double> s;
      s.omega = 2.0 * w;
      s.damping = {2.0 * zeta * w};
      s.stiffness = {w * w};
      s.add_term(0, w * w * e, {0}, 1);
      Floquet floquet(s, 0, 1);
      return floquet.compute(s, Vector::Zero(1)).multipliers[0].real();
    };
    double low = 0.5 * expected, high = 2.0 * expected;
    for (int i = 0; i < 50; ++i) (largest(0.5 * (low + high)) > -1.0 ? low : high) = 0.5 * (low + high);
    CHECK(low == Approx(expected).epsilon(0).margin(5e-7));  // six decimals given
    CHECK(largest(low) == Approx(-1.0).epsilon(0).margin(1e-11));
  }
}

namespace {

// z'' + c z' + k z + s(t) g z = 0 of many coordinates, g symmetric, entries up to `strength` times the least stiffness, with cos t and cos 2 t.
ModalSystem<double> parametric(int n, double strength) {
  ModalSystem<double> s;
  s.omega = 1.3;
  for (int i = 0; i < n; ++i) {
    s.damping.push_back(0.01 * (1 + i));
    s.stiffness.push_back((1.0 + i) * (1.0 + i));
  }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) {
      const double g = strength * std::sin(1.0 + 3.0 * i + 7.0 * j);
      s.add_term(i, g, {j}, 1 + (i + j) % 2);
      if (i != j) s.add_term(j, g, {i}, 1 + (i + j) % 2);
    }
  return s;
}

}  // namespace

TEST_CASE("Floquet: many coupled coordinates, swept where the coupling is weak and eliminated where it is not, against CVODE") {
  for (const double strength : {0.05, 0.8, 60.0}) {
    INFO("coupling " << strength);
    const auto system = parametric(7, strength);
    Floquet floquet(system, 0, 1);
    const FloquetResult& f = floquet.compute(system, Vector::Zero(7));
    REQUIRE(f.converged);
    REQUIRE(f.blocks.size() == 1);
    const IntegratedPeriod period = monodromy_by_integration(system, Vector::Zero(14), 1);
    REQUIRE(period.ok);
    // CVODE at 1e-13 a step
    CHECK((f.monodromy - period.monodromy).lpNorm<Eigen::Infinity>() < 1e-9 * period.monodromy.lpNorm<Eigen::Infinity>());
    if (strength > 1.0) continue;  // grows by e^40: the determinant of the matrix is rounding
    CHECK(f.eliminated == 0);
    double trace = 0.0;
    for (const double c : system.damping) trace += c;
    CHECK(std::log(f.monodromy.determinant()) == Approx(-trace * two_pi / system.omega).epsilon(1e-6));  // Liouville
  }
}
