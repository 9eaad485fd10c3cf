/// Equilibrium problems with known special points, walked at default options: published values, closed forms, and steps that hold two events.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "continuation/augmented.hpp"
#include "continuation/network.hpp"
#include "core/dual_problem.hpp"
#include "core/kinsol.hpp"

using namespace whirl;
using namespace whirl::continuation;

namespace {

template <class S>
using Args = std::span<const S>;
template <class S>
using Result = std::span<S>;

// --------------------------------------------------------------------------------------------------------------- the models

struct Cusp {  // u = (x, mu)
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    r[0] = u[1] + u[0] - u[0] * u[0] * u[0];
  }
};

/// u'' + p e^u = 0, u(0) = u(1) = 0, central differences on n inner points, times h^2: residuals of rounding stay near 1e-15.
struct Bratu {
  int n;
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    using std::exp;
    const auto m = static_cast<std::size_t>(n);
    const double h = 1.0 / (n + 1);
    for (std::size_t i = 0; i < m; ++i) {
      const S left = i > 0 ? u[i - 1] : S(0.0), right = i + 1 < m ? u[i + 1] : S(0.0);
      r[i] = left - 2.0 * u[i] + right + h * h * u[m] * S(exp(u[i]));
    }
  }
};

struct Lorenz {  // u = (x, y, z, rho)
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    r[0] = 10.0 * (u[1] - u[0]);
    r[1] = u[0] * (u[3] - u[2]) - u[1];
    r[2] = u[0] * u[1] - (8.0 / 3.0) * u[2];
  }
};

struct CarbonMonoxide {  // u = (x, y, s, q2)
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    const double q1 = 2.5, q3 = 10.0, q4 = 0.0675, q5 = 1.0, q6 = 0.1, k = 0.4;
    const S x = u[0], y = u[1], s = u[2], q2 = u[3], z = 1.0 - x - y - s;
    r[0] = 2.0 * q1 * z * z - 2.0 * q5 * x * x - q3 * x * y;
    r[1] = q2 * z - q6 * y - q3 * x * y;
    r[2] = q4 * (z - k * s);
  }
};

struct ConsecutiveReaction {  // A -> B -> C, u = (u1, u2, p1)
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    using std::exp;
    const double p2 = 14.0, p3 = 2.0;
    const S rate = u[2] * (1.0 - u[0]) * S(exp(u[1]));
    r[0] = rate - u[0];
    r[1] = p2 * rate - (1.0 + p3) * u[1];
  }
};

/// x'' + c x' + x + gamma x^3 = P cos wt, x = Re Z e^{iwt}, Z = a + ib, averaged:
///     2w Z' = i ((1 - w^2 + 3/4 gamma |Z|^2) Z - P) - c w Z,   |Z|^2 ((1 - w^2 + 3/4 gamma |Z|^2)^2 + (c w)^2) = P^2 at rest.
struct Duffing {
  double c, gamma, load;
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    const S a = u[0], b = u[1], w = u[2];
    const S detuning = 1.0 - w * w + 0.75 * gamma * (a * a + b * b);
    r[0] = (-detuning * b - c * w * a) / (2.0 * w);
    r[1] = (detuning * a - load - c * w * b) / (2.0 * w);
  }
};

// Z1 (1 - w^2 or the like) + 3/4 |Z1|^2 Z1 + 1/2 |Z2|^2 Z1 + 1/4 Z2^2 conj Z1, real and imaginary part: the first harmonic of y + y (y^2 + z^2).
template <class S>
void restoring(const S& detuning, const S& a1, const S& b1, const S& a2, const S& b2, S& re, S& im) {
  const S k = detuning + 0.75 * (a1 * a1 + b1 * b1) + 0.5 * (a2 * a2 + b2 * b2);
  const S sq_re = a2 * a2 - b2 * b2, sq_im = 2.0 * a2 * b2;
  re = k * a1 + 0.25 * (sq_re * a1 + sq_im * b1);
  im = k * b1 + 0.25 * (sq_im * a1 - sq_re * b1);
}

/// y'' + c y' + y + y (y^2 + z^2) = F cos wt and z the same unforced: 2w Z1' = i (restoring(Z1, Z2) - F) - c w Z1.  u = (Z1, Z2, w)
struct WhirlingString {
  double c, load;
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    const S w = u[4], detuning = 1.0 - w * w;
    S re, im;
    for (std::size_t k = 0; k < 4; k += 2) {
      restoring(detuning, u[k], u[k + 1], u[2 - k], u[3 - k], re, im);
      r[k] = (-im - c * w * u[k]) / (2.0 * w);
      r[k + 1] = (re - (k == 0 ? load : 0.0) - c * w * u[k + 1]) / (2.0 * w);
    }
  }
};

/// The same in units of the damping: a1' = -a1 + i (restoring(a1, a2) - f), u = (a1, a2, delta) or, with f free, (a1, a2, delta, f).
struct ScaledString {
  double load;
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    const S f = u.size() > 5 ? u[5] : S(load);
    S re, im;
    for (std::size_t k = 0; k < 4; k += 2) {
      restoring(u[4], u[k], u[k + 1], u[2 - k], u[3 - k], re, im);
      r[k] = -u[k] - im;
      r[k + 1] = -u[k + 1] + re - (k == 0 ? f : S(0.0));
    }
  }
};

/// r = (f(x, p), alpha y - 3 z, 3 y + alpha z): a curve of rest points with an oscillator of growth rate alpha(x, p).
template <class Curve, class Alpha>
struct CurveAndOscillator {
  Curve curve;
  Alpha alpha;
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    const S a = alpha(u[0], u[3]);
    r[0] = curve(u[0], u[3]);
    r[1] = a * u[1] - 3.0 * u[2];
    r[2] = 3.0 * u[1] + a * u[2];
  }
};

/// r = (f(x, p), alpha y - y^3): the same with a pitchfork of y -> -y where alpha(x, p) = 0.
template <class Curve, class Alpha>
struct CurveAndPitchfork {
  Curve curve;
  Alpha alpha;
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    r[0] = curve(u[0], u[2]);
    r[1] = alpha(u[0], u[2]) * u[1] - u[1] * u[1] * u[1];
  }
};

/// r = f(x, p)
template <class Curve>
struct Scalar {
  Curve curve;
  template <class S>
  void residual(Args<S> u, Result<S> r) const {
    r[0] = curve(u[0], u[1]);
  }
};

template <class Model>
class Mirrored : public DualProblem<Model> {
 public:
  Mirrored(Model model, int n, Reflection r) : DualProblem<Model>(std::move(model), n, 1, true) { this->add_reflection(std::move(r)); }
};

template <class Model>
DualProblem<Model> flow(Model model, int n, int k = 1) {
  return DualProblem<Model>(std::move(model), n, k, true);
}

Vector vec(std::initializer_list<double> values) {
  Vector v(static_cast<int>(values.size()));
  std::copy(values.begin(), values.end(), v.data());
  return v;
}

Reflection whirl_reflection() { return {vec({1, 1, -1, -1}), "WH"}; }

// ------------------------------------------------------------------------------------------------------------- the questions

/// Root of f between lo and hi to the last bit of a double.
double root(const std::function<long double(long double)>& f, long double lo, long double hi) {
  const bool rising = f(lo) < 0.0L;
  REQUIRE(rising == (f(hi) > 0.0L));
  for (int i = 0; i < 100; ++i) {
    const long double middle = 0.5L * (lo + hi);
    (((f(middle) < 0.0L) == rising) ? lo : hi) = middle;
  }
  return static_cast<double>(0.5L * (lo + hi));
}

std::vector<SpecialPoint> events(const Branch& b, EventType type) {
  std::vector<SpecialPoint> list;
  for (const auto& s : b.special)
    if (s.type == type) list.push_back(s);
  std::sort(list.begin(), list.end(), [](const auto& s, const auto& t) { return s.u[s.u.size() - 1] < t.u[t.u.size() - 1]; });
  return list;
}

double parameter(const SpecialPoint& s) { return s.u[s.u.size() - 1]; }

/// Parameter values of the events of a type, increasing.
std::vector<double> at(const Branch& b, EventType type) {
  std::vector<double> values;
  for (const auto& s : events(b, type)) values.push_back(parameter(s));
  return values;
}

void check_values(const std::vector<double>& found, const std::vector<double>& expected, double tolerance) {
  CAPTURE(found, expected);
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(std::abs(found[i] - expected[i]) <= tolerance * (1.0 + std::abs(expected[i])));
}

/// What every branch owes: solutions, honest counts of unstable directions, brackets that hold the event, a chain of counts without a gap.
void check_honest(const Problem& f, const Branch& b) {
  const int n = f.size();
  Vector r(n);
  REQUIRE(b.points() > 1);
  for (int i = 0; i < b.points(); ++i) {
    f.residual(b.u(i), r);
    REQUIRE(r.lpNorm<Eigen::Infinity>() < 1e-10);  // the corrector leaves quadratic remainders of 1e-11 in the metric
    const bool end = i == 0 || i == b.points() - 1;
    int count = 0;
    for (int k = 0; k < n; ++k) count += b.eigenvalues(i)[k].real() > 0.0 ? 1 : 0;
    if (!end) REQUIRE(b.n_unstable(i) == count);  // the end may be a branch point, where an eigenvalue is zero up to rounding
    if (i > 0) REQUIRE(b.arclength(i) > b.arclength(i - 1));
  }
  std::size_t next = 0;
  for (int i = 0; i + 1 < b.points(); ++i) {
    int count = b.n_unstable(i);
    double last = -1e300;
    for (; next < b.special.size() && b.special[next].arclength <= b.arclength(i + 1); ++next) {
      const SpecialPoint& s = b.special[next];
      CAPTURE(to_string(s.type), parameter(s), s.arclength, i, b.parameter(i), b.parameter(i + 1));
      REQUIRE(s.type != EventType::unresolved);
      REQUIRE(s.arclength >= b.arclength(i));
      f.residual(s.u, r);
      REQUIRE(r.lpNorm<Eigen::Infinity>() < 1e-10);
      REQUIRE(s.residual < 1e-10);
      REQUIRE(s.bracket[0] <= parameter(s));
      REQUIRE(parameter(s) <= s.bracket[1]);
      if (s.arclength - last > 2e-6) REQUIRE(s.unstable_before == count);  // nearer than the 1e-6 of the bracket they share their counts
      count = s.unstable_after;
      last = s.arclength;
    }
    CAPTURE(i, b.parameter(i), b.parameter(i + 1), b.points());
    REQUIRE(count == b.n_unstable(i + 1));
  }
  REQUIRE(next == b.special.size());
}

WalkOptions range(double lower, double upper) {
  WalkOptions options;  // all else at its default
  options.lower = lower;
  options.upper = upper;
  return options;
}

Branch walked(const Problem& f, const Vector& u0, double lower, double upper) {
  Walker walker(f, range(lower, upper));
  Branch b = walker.walk(u0);
  check_honest(f, b);
  return b;
}

// Newton meets 1e-13 relative in the unknowns of the located systems; three digits are left for their conditioning.
constexpr double located = 1e-10;

}  // namespace

TEST_CASE("cusp normal form: two folds by closed form", "[published]") {
  const auto f = flow(Cusp{}, 1);
  const Branch b = walked(f, vec({-1.3, -0.9}), -1.0, 1.0);
  const double mu = 2.0 / (3.0 * std::sqrt(3.0));
  check_values(at(b, EventType::fold), {-mu, mu}, located);
  REQUIRE(b.special.size() == 2);
  CHECK(b.start_reason == StopReason::parameter_bound);
  CHECK(b.stop_reason == StopReason::parameter_bound);
  CHECK(b.parameter(0) == -1.0);
  CHECK(b.parameter(b.points() - 1) == 1.0);
}

TEST_CASE("Bratu: the fold of the discretised problem extrapolates to the exact one", "[published][slow]") {
  double fold[2], h[2];
  const int grids[2] = {200, 240};
  for (int g = 0; g < 2; ++g) {
    const auto f = flow(Bratu{grids[g]}, grids[g]);
    Vector start = Vector::Zero(grids[g] + 1);
    start[grids[g]] = 3.0;  // the walk starts on a bound, passes the fold and ends on the same bound
    const Branch b = walked(f, start, 3.0, 4.0);
    CHECK(b.parameter(0) == 3.0);
    CHECK(b.parameter(b.points() - 1) == 3.0);
    const auto folds = at(b, EventType::fold);
    REQUIRE(folds.size() == 1);
    REQUIRE(b.special.size() == 1);
    fold[g] = folds[0];
    h[g] = 1.0 / (grids[g] + 1);
  }
  const double ratio = h[0] * h[0] / (h[1] * h[1]);
  const double extrapolated = (ratio * fold[1] - fold[0]) / (ratio - 1.0);
  CAPTURE(fold[0], fold[1], extrapolated);
  CHECK(std::abs(extrapolated - 3.513830719) < 1e-8);  // h^4 is 4e-10 and the printed value has nine decimals
}

TEST_CASE("Lorenz without a declared symmetry: simple branch point, both senses, Hopf at 470/19", "[published]") {
  const auto f = flow(Lorenz{}, 3);
  Network net(f, {.walk = range(0.0, 30.0)});
  REQUIRE(net.add_seed(Vector::Zero(4), "start"));
  net.switch_branches();
  REQUIRE(net.branches().size() == 2);
  for (const Branch& b : net.branches()) check_honest(f, b);
  const auto bp = events(net.branches()[0], EventType::branch_point);
  REQUIRE(bp.size() == 1);
  CHECK(bp[0].subtype == "PF");
  CHECK(std::abs(parameter(bp[0]) - 1.0) < located);
  const Branch& wings = net.branches()[1];
  const double rho = 470.0 / 19.0;  // sigma (sigma + beta + 3) / (sigma - beta - 1)
  check_values(at(wings, EventType::hopf), {rho, rho}, located);
  const auto hopf = events(wings, EventType::hopf);
  CHECK(hopf[0].u[0] * hopf[1].u[0] < 0.0);
  for (const auto& s : hopf) CHECK(s.frequency == Approx(std::sqrt(8.0 / 3.0 * (10.0 + rho))).epsilon(located));
}

TEST_CASE("Lorenz with its reflection: the mirror branch is followed once", "[published]") {
  const Mirrored<Lorenz> f({}, 3, {vec({-1, -1, 1}), "PF"});
  Network net(f, {.walk = range(0.0, 30.0)});
  REQUIRE(net.add_seed(Vector::Zero(4), "start"));
  net.switch_branches();
  REQUIRE(net.branches().size() == 2);
  for (const Branch& b : net.branches()) check_honest(f, b);
  const auto bp = events(net.branches()[0], EventType::branch_point);
  REQUIRE(bp.size() == 1);
  CHECK(bp[0].subtype == "PF");
  CHECK(bp[0].block == 1);
  CHECK(std::abs(parameter(bp[0]) - 1.0) < located);
  check_values(at(net.branches()[1], EventType::hopf), {470.0 / 19.0}, located);
  Vector mirrored = net.branches()[1].u(net.branches()[1].points() / 2);
  mirrored.head(2) *= -1.0;
  CHECK_FALSE(net.add_seed(mirrored, "mirror image"));
}

TEST_CASE("CO oxidation: two Hopf points and two folds", "[published]") {
  const auto f = flow(CarbonMonoxide{}, 3);
  const NewtonResult start = line_search_solve(f, vec({0.1, 0.1, 0.5, 0.5}));
  REQUIRE(start.ok());
  const Branch b = walked(f, start.x, 0.5, 2.0);
  check_values(at(b, EventType::hopf), {1.04099156953261, 1.05155746245773}, 1e-9);
  check_values(at(b, EventType::fold), {1.04204850537852, 1.05220028786995}, 1e-9);
}

TEST_CASE("A -> B -> C: folds and Hopf by elimination", "[published]") {
  // At rest u2 = 14 u1 / 3 and p1 = u1 e^{-u2} / (1 - u1).
  const auto p1 = [](double u1) { return u1 / (1.0 - u1) * std::exp(-14.0 * u1 / 3.0); };
  const double s7 = std::sqrt(1.0 / 7.0);                  // dp1/du1 = 0: u1 (1 - u1) = 3/14
  const double u1_hopf = (17.0 + std::sqrt(65.0)) / 28.0;  // trace (14 u1 - 3) - 1 / (1 - u1) = 0; the other root has det < 0
  const auto f = flow(ConsecutiveReaction{}, 2);
  const Branch b = walked(f, Vector::Zero(3), 0.0, 0.2);
  check_values(at(b, EventType::fold), {p1(0.5 * (1.0 + s7)), p1(0.5 * (1.0 - s7))}, located);
  check_values(at(b, EventType::hopf), {p1(u1_hopf)}, located);
  check_values(at(b, EventType::fold), {0.0889318, 0.105739}, 5e-7);  // as printed
  check_values(at(b, EventType::hopf), {0.1309}, 5e-7);
}

namespace {

// Discriminant of the amplitude cubic k^2 A^3 + 2 k d A^2 + (d^2 + e^2) A - P^2, d = 1 - w^2, e = c w, k = 3/4 gamma.
long double amplitude_discriminant(const Duffing& m, long double w) {
  const long double k = 0.75L * m.gamma, detuning = 1.0L - w * w, damping = m.c * w;
  const long double a = k * k, b = 2.0L * k * detuning, c = detuning * detuning + damping * damping, d = -1.0L * m.load * m.load;
  return 18.0L * a * b * c * d - 4.0L * b * b * b * d + b * b * c * c - 4.0L * a * c * c * c - 27.0L * a * a * d * d;
}

// Sign changes of f on a fine grid, each refined.
std::vector<double> roots(const std::function<long double(long double)>& f, double lower, double upper, int cells) {
  std::vector<double> list;
  for (int i = 0; i < cells; ++i) {
    const long double lo = lower + (upper - lower) * i / cells, hi = lower + (upper - lower) * (i + 1) / cells;
    if ((f(lo) < 0.0L) != (f(hi) < 0.0L)) list.push_back(root(f, lo, hi));
  }
  return list;
}

}  // namespace

TEST_CASE("Duffing, one averaged term: folds where the discriminant of the amplitude cubic vanishes", "[published]") {
  for (const Duffing& m : {Duffing{0.05, 0.1, 0.18}, Duffing{0.04, 1.0, 0.015}}) {
    CAPTURE(m.c, m.gamma, m.load);
    const auto f = flow(m, 2);
    const Branch b = walked(f, vec({m.load / 0.75, 0.0, 0.5}), 0.5, 2.5);
    const auto expected = roots([&](long double w) { return amplitude_discriminant(m, w); }, 0.5, 2.5, 4000);
    REQUIRE(expected.size() == 2);
    check_values(at(b, EventType::fold), expected, located);
    CHECK(b.special.size() == 2);
  }
}

TEST_CASE("whirling string: onset of whirling and planar folds", "[published]") {
  const WhirlingString m{0.02, 0.01};
  const Mirrored<WhirlingString> f(m, 4, whirl_reflection());
  const Branch b = walked(f, vec({m.load / 0.19, 0.0, 0.0, 0.0, 0.9}), 0.9, 1.2);
  const auto folds = roots([&](long double w) { return amplitude_discriminant({m.c, 1.0, m.load}, w); }, 0.9, 1.2, 3000);
  // Onset: d = 2 F^2 / A^2 - 3 A / 4 from the planar equation less the singular odd block (d + A/2)^2 + e^2 = A^2 / 16.
  const auto detuning = [&](long double A) { return 2.0L * m.load * m.load / (A * A) - 0.75L * A; };
  const auto onset = [&](long double A) {
    const long double d = detuning(A), e2 = m.c * m.c * (1.0L - d);
    return (d + A / 2.0L) * (d + A / 2.0L) + e2 - A * A / 16.0L;
  };
  std::vector<double> onsets;
  for (const double A : roots(onset, 1e-3, 1.0, 10000)) onsets.push_back(static_cast<double>(std::sqrt(1.0L - detuning(A))));
  std::sort(onsets.begin(), onsets.end());
  check_values(at(b, EventType::fold), folds, located);
  check_values(at(b, EventType::branch_point), onsets, located);
  check_values(at(b, EventType::fold), {1.0370229451, 1.0779949255}, 1e-10);  // ten decimals are given
  check_values(at(b, EventType::branch_point), {1.0180097647, 1.0728304789}, 1e-10);
  for (const auto& s : events(b, EventType::branch_point)) CHECK(s.subtype == "WH");
}

TEST_CASE("scaled string: folds, whirling and Hopf points of the whirling branch", "[published]") {
  const auto planar_start = [](double f, double delta) { return vec({f * delta / (delta * delta + 1.0), -f / (delta * delta + 1.0), 0, 0, delta}); };
  const auto string = [](double load) { return Mirrored<ScaledString>({load}, 4, whirl_reflection()); };
  SECTION("two folds from f^2 = 32 / (9 sqrt 3) on") {
    const double critical = std::sqrt(32.0 / (9.0 * std::sqrt(3.0)));
    for (const double f : {critical * (1.0 - 1e-3), critical * (1.0 + 1e-3)}) {
      const auto p = string(f);
      const Branch b = walked(p, planar_start(f, 5.0), -15.0, 5.0);
      CHECK(events(b, EventType::fold).size() == (f < critical ? 0 : 2));
      CHECK(events(b, EventType::branch_point).empty());
    }
  }
  SECTION("two whirling points from f^2 = 32 / (3 sqrt 3) on") {
    const double critical = std::sqrt(32.0 / (3.0 * std::sqrt(3.0)));
    for (const double f : {critical * (1.0 - 1e-3), critical * (1.0 + 1e-3)}) {
      const auto p = string(f);
      const Branch b = walked(p, planar_start(f, 5.0), -15.0, 5.0);
      CHECK(events(b, EventType::branch_point).size() == (f < critical ? 0 : 2));
    }
  }
  SECTION("f = 2.5") {
    const double f = 2.5;
    const auto p = string(f);
    const Branch b = walked(p, planar_start(f, 5.0), -15.0, 5.0);
    const auto bp = events(b, EventType::branch_point);
    // 4 f^4 - f^2 u^3 + u^4 = 0 and delta = -3u/4 + sqrt(f^2 / u - 1); u = 5 is one root
    const auto quartic = [&](long double u) { return 4.0L * f * f * f * f - f * f * u * u * u + u * u * u * u; };
    const double u2 = root(quartic, 4.0, 4.6), delta2 = -0.75 * u2 + std::sqrt(f * f / u2 - 1.0);
    check_values(at(b, EventType::branch_point), {-3.25, delta2}, located);
    CHECK(bp[0].u.head(2).squaredNorm() == Approx(5.0).epsilon(located));
    CHECK(bp[1].u.head(2).squaredNorm() == Approx(u2).epsilon(located));
    CHECK(std::abs(u2 - 4.34438) < 5e-6);  // as printed
    CHECK(std::abs(delta2 + 2.59599) < 5e-6);
  }
  SECTION("f = 4: Hopf points of the whirling branch") {
    const double f = 4.0;
    const auto p = string(f);
    Network net(p, {.walk = range(-20.0, 5.0)});
    REQUIRE(net.add_seed(planar_start(f, 5.0), "start"));
    net.switch_branches();
    REQUIRE(net.branches().size() == 2);
    for (const Branch& b : net.branches()) check_honest(p, b);
    const auto hopf = at(net.branches()[1], EventType::hopf);
    REQUIRE(hopf.size() == 2);
    CHECK(std::abs(hopf[0] + 10.768) < 5e-4);  // as printed
    CHECK(std::abs(hopf[1] + 5.299) < 2e-3);   // printed to three decimals; -5.30006 has a pair on the axis, -5.299 one at -1.1e-3
    CHECK(net.branches()[1].stop_reason == StopReason::symmetric_branch);
  }
  SECTION("the first Hopf point is a fold of the curve of Hopf points in f") {
    const double f = 4.0;
    const auto p = string(f);
    Network net(p, {.walk = range(-20.0, 5.0)});
    REQUIRE(net.add_seed(planar_start(f, 5.0), "start"));
    net.switch_branches();
    const auto hopf = events(net.branches().at(1), EventType::hopf);
    REQUIRE(hopf.size() == 2);
    const auto base = flow(ScaledString{}, 4, 2);
    Vector u(6);
    u << hopf[1].u, f;
    const Indices all = {0, 1, 2, 3};
    HopfSystem curve(base, all, all, u);
    Walker walker(curve, range(3.0, 4.5));
    const Branch b = walker.walk(curve.unknowns(u));
    const auto folds = events(b, EventType::fold);
    REQUIRE(folds.size() == 1);
    const Vector first = curve.base_point(folds[0].u);
    CHECK(std::abs(first[5] - 3.3860) < 6e-5);  // as printed
    CHECK(std::abs(first[4] + 5.781) < 2e-3);   // at a fold in f, delta carries the square root of the error in f
  }
}

// ----------------------------------------------------------------------------------------------------------- nothing is missed

namespace {

const auto slope_one = [](auto x, auto p) { return decltype(x)(p - x); };  // x = p

// Positive between c - half and c + half only, and no parabola.
auto hump(double c, double half) {
  return [c, half](auto, auto p) {
    const decltype(p) d = p - c;
    return decltype(p)((half * half - d * d) * (1.0 + 2.0 * d + 5.0 * d * d));
  };
}

}  // namespace

TEST_CASE("two events that cancel within one step are both found", "[published][slow]") {
  // Steps are 0.04 of the range here; the centres move through all positions within a step.
  const double half = GENERATE(5e-4, 5e-5, 5e-6, 5e-7, 1.5e-7);
  for (int i = 0; i < 100; ++i) {
    const double c = 0.4 + 0.000853 * i;
    CAPTURE(half, c);
    const CurveAndOscillator hopf{slope_one, hump(c, half)};
    check_values(at(walked(flow(hopf, 3), Vector::Zero(4), 0.0, 1.0), EventType::hopf), {c - half, c + half}, located);
    const CurveAndPitchfork pitchfork{slope_one, hump(c, half)};
    check_values(at(walked(flow(pitchfork, 2), Vector::Zero(3), 0.0, 1.0), EventType::branch_point), {c - half, c + half}, located);
    const Mirrored declared(pitchfork, 2, {vec({1, -1}), "PF"});
    check_values(at(walked(declared, Vector::Zero(3), 0.0, 1.0), EventType::branch_point), {c - half, c + half}, located);
  }
}

TEST_CASE("two folds 1e-4 and less of the range apart", "[published]") {
  // p = c + x^3 - e x folds at p = c -+ 2 (e/3)^(3/2)
  const double half = GENERATE(1e-4, 1e-6, 1e-8);
  const double e = 3.0 * std::pow(0.5 * half, 2.0 / 3.0);
  for (int i = 0; i < 40; ++i) {
    const double c = -0.2 + 0.0107 * i;
    CAPTURE(half, c);
    const Scalar m{[c, e](auto x, auto p) { return decltype(x)(p - c - x * x * x + e * x); }};
    check_values(at(walked(flow(m, 1), vec({-std::cbrt(1.0 + c), -1.0}), -1.0, 1.0), EventType::fold), {c - half, c + half}, located);
  }
}

TEST_CASE("a fold and another event as near as may be", "[published]") {
  // p = c + x^2 folds at x = 0, the other event lies at x = gap, p = c + gap^2.
  const double gap = GENERATE(3.2e-3, 1e-5, -1e-5, 1e-7, -1e-7, 1e-9, 0.0);
  for (int i = 0; i < 20; ++i) {
    const double c = 0.1 + 0.0213 * i;
    CAPTURE(gap, c);
    const auto curve = [c](auto x, auto p) { return decltype(x)(p - c - x * x); };
    const auto alpha = [gap](auto x, auto) { return decltype(x)(x - gap); };
    {
      const CurveAndOscillator m{curve, alpha};
      const Branch b = walked(flow(m, 3), vec({-std::sqrt(1.0 - c), 0, 0, 1}), 0.0, 1.0);
      check_values(at(b, EventType::fold), {c}, located);
      check_values(at(b, EventType::hopf), {c + gap * gap}, located);
      CHECK(b.special.size() == 2);
      CHECK(std::abs(events(b, EventType::hopf)[0].u[0] - gap) < 1e-12);  // regular in x: rounding only
    }
    {
      const CurveAndPitchfork m{curve, alpha};
      const Mirrored f(m, 2, {vec({1, -1}), "PF"});
      const Branch b = walked(f, vec({-std::sqrt(1.0 - c), 0, 1}), 0.0, 1.0);
      check_values(at(b, EventType::fold), {c}, located);
      check_values(at(b, EventType::branch_point), {c + gap * gap}, located);
      CHECK(b.special.size() == 2);
      CHECK(std::abs(events(b, EventType::branch_point)[0].u[0] - gap) < 1e-12);
    }
  }
}

TEST_CASE("closed curves end where they began, bounds are hit exactly", "[published][slow]") {
  const Scalar circle{[](auto x, auto p) { return decltype(x)(1.0 - p * p - x * x); }};
  const auto f = flow(circle, 1);
  SECTION("an isola from any of its points") {
    for (int i = 0; i < 1000; ++i) {  // some starts have a fold within the first step: it must not be told twice
      const double angle = 2.0 * std::numbers::pi * (i + 0.5) / 1000;
      CAPTURE(angle);
      const Branch b = walked(f, vec({std::sin(angle), std::cos(angle)}), -2.0, 2.0);
      CHECK(b.stop_reason == StopReason::closed_loop);
      check_values(at(b, EventType::fold), {-1.0, 1.0}, located);
      CHECK((b.u(0) - b.u(b.points() - 1)).norm() < 1e-12);  // the last point is the first
    }
  }
  SECTION("cut by a bound") {
    const Branch b = walked(f, vec({1, 0}), -0.5, 2.0);
    CHECK(b.start_reason == StopReason::parameter_bound);
    CHECK(b.stop_reason == StopReason::parameter_bound);
    CHECK(b.parameter(0) == -0.5);
    CHECK(b.parameter(b.points() - 1) == -0.5);
    CHECK(std::abs(b.u(b.points() - 1)[0] + std::sqrt(0.75)) < 1e-12);
    check_values(at(b, EventType::fold), {1.0}, located);
  }
  SECTION("from a start on a bound") {
    const double lower = GENERATE(0.0, -2.0);  // the start is the lower bound, or the upper
    const Branch b = walked(f, vec({1, 0}), lower, lower + 2.0);
    CHECK(b.parameter(0) == 0.0);
    CHECK(b.parameter(b.points() - 1) == 0.0);
    CHECK(b.start_reason == StopReason::parameter_bound);
    CHECK(b.stop_reason == StopReason::parameter_bound);
    check_values(at(b, EventType::fold), {lower + 1.0 > 0.0 ? 1.0 : -1.0}, located);
  }
}

TEST_CASE("second and third derivatives against differences", "[published]") {
  const auto f = flow(ConsecutiveReaction{}, 2);
  const Vector u = vec({0.6, 1.7, 0.11}), a = vec({0.3, -0.7, 0.4}), b = vec({-0.2, 0.5, 0.9}), c = vec({0.8, 0.1, -0.6});
  const double h = 1e-5;  // central differences: h^2 = 1e-10 against rounding 1e-16 / h = 1e-11
  Matrix h2(2, 3), plus(2, 3), minus(2, 3);
  Vector t(2);
  f.second(u, a, h2);
  f.jacobian(u + h * a, plus);
  f.jacobian(u - h * a, minus);
  CHECK((h2 - (plus - minus) / (2.0 * h)).cwiseAbs().maxCoeff() < 1e-8);
  f.third(u, a, b, c, t);
  f.second(u + h * b, a, plus);
  f.second(u - h * b, a, minus);
  CHECK((t - (plus - minus) * c / (2.0 * h)).cwiseAbs().maxCoeff() < 1e-8);
  // The mixed third derivative is symmetric.
  Vector permuted(2);
  f.third(u, c, a, b, permuted);
  CHECK((t - permuted).cwiseAbs().maxCoeff() < 1e-12);
}
