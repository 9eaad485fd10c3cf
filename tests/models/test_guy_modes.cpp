// Transverse modes of guys against Table I and II of [Sarvi1968] and their recomputation in high precision.
#include <Eigen/Eigenvalues>
#include <boost/math/special_functions/bessel.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/complex_bessel.hpp"
#include "core/quadrature.hpp"
#include "models/guy/transverse_modes.hpp"
#include "tests/models/csv_table.hpp"
#include "tests/models/guy_cases.hpp"

using namespace whirl::models::guy;
using namespace guy_cases;
using std::numbers::pi;

namespace {

TransverseModes with_ratio(double k) { return {1e4, 1e4 * k * k, 100.0, 2.0}; }

// Frequency equation by an independent means: the sine-series Galerkin form of (T Y')' + m w^2 Y = 0, T = 1 + (k^2 - 1) sigma, whose eigenvalues lie
// above the true ones. Entries: int T cos i pi s cos j pi s ds in closed form.
double galerkin_frequency(double k, int i, int n) {
  Eigen::MatrixXd A(n, n);
  for (int a = 1; a <= n; ++a)
    for (int b = 1; b <= n; ++b) {
      const auto half = [](int d) { return d == 0 ? 0.5 : (d % 2 == 0 ? 0.0 : -2.0 / (d * d * pi * pi)); };  // int s cos(d pi s) ds
      const double constant = a == b ? 0.5 : 0.0, linear = 0.5 * (half(a - b) + half(a + b));
      A(a - 1, b - 1) = 2.0 * a * b * pi * pi * (constant + (k * k - 1.0) * linear);
    }
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).eigenvalues()[i - 1]);
}

}  // namespace

TEST_CASE("Oklahoma City guy: frequencies and roots of Table I", "[published]") {
  const Statics s = oklahoma_rest(Form::first_order);
  const TransverseModes modes(s);
  const double exact[] = {0.892016074145, 1.78419734527, 2.67634196385, 3.56847739898, 4.46060915869, 5.3527390803, 6.24486795144, 7.13699616598};
  const double string[] = {0.893936770554, 1.78787354111, 2.68181031166, 3.57574708222, 4.46968385277, 5.36362062332, 6.25755739388, 7.15149416443};
  const double X[] = {3.1412046921344, 6.2829911198775, 9.4246484769461, 12.566273494759,
                      15.707885569775, 18.849491171932, 21.991093074882, 25.132692665671};
  const double three[] = {30.25692779703, 60.51945897278, 90.78074693139, 121.0417233903,
                          151.3025751808, 181.5633646229, 211.8241184333, 242.0848499724};
  const double four[] = {30.25692776878, 60.51945897189, 90.78074693128, 121.0417233903,
                         151.3025751807, 181.5633646229, 211.8241184333, 242.0848499724};
  for (int i = 1; i <= 8; ++i) {
    CHECK(modes.frequency(i) == Approx(exact[i - 1]).epsilon(5e-12));  // 12 printed digits
    CHECK(string_frequency(s, i) == Approx(string[i - 1]).epsilon(5e-12));
    CHECK(modes.phase_number(i) == Approx(X[i - 1]).epsilon(1e-13));
    CHECK(mcmahon_root(i, modes.k(), 3) == Approx(three[i - 1]).epsilon(1e-12));
    CHECK(mcmahon_root(i, modes.k(), 4) == Approx(four[i - 1]).epsilon(1e-12));
  }
  CHECK(modes.mode(1).root() == Approx(30.256927769088).epsilon(1e-13));
}

TEST_CASE("Oklahoma City guy: normalised modes of Table I, norms and end slopes", "[published]") {
  const CsvTable table("guy_modes_oklahoma.csv");
  const TransverseModes modes(oklahoma_rest(Form::first_order));
  REQUIRE(table.rows == 328);
  double printed = 0.0, string = 0.0;
  for (std::size_t row = 0; row < table.rows; ++row) {
    const int i = static_cast<int>(table("mode", row));
    const double sigma = table("sigma", row), value = modes.mode(i).value(sigma);
    CHECK(value == Approx(table("guy", row)).epsilon(0).margin(2e-11));  // 12 digits, of a phase up to 242
    printed = std::max(printed, std::abs(value - table("guy_printed", row)));
    string = std::max(string, std::abs(std::sqrt(2.0) * std::sin(i * pi * sigma) - table("string_printed", row)));
  }
  CHECK(printed < 1.3e-5);
  CHECK(string < 5e-6);
  const double norms[] = {0.014504237636406,  0.0072521523620488, 0.0048347725026785, 0.0036260805023162,
                          0.0029008648194829, 0.0024173875386,    0.0020720465597,    0.0018130407954};
  const double low[] = {4.79330136252, 9.58655838351, 14.379824901, 19.1730939179, 23.9663639471, 28.7596344848, 33.5529053141, 38.3461763257};
  const double top[] = {-4.13317130124, 8.26637994175, -12.399580032, 16.5327780732, -20.6659753037, 24.7991721306, -28.9323687274, 33.0655651807};
  for (int i = 1; i <= 8; ++i) {
    const TransverseMode m = modes.mode(i);
    CHECK(m.printed_norm() == Approx(norms[i - 1]).epsilon(1e-10));
    CHECK(m.slope(0.0) == Approx(low[i - 1]).epsilon(1e-10));
    CHECK(m.slope(1.0) == Approx(top[i - 1]).epsilon(1e-10));
  }
}

TEST_CASE("orthonormality by Simpson's rule on forty intervals: Table II", "[published]") {
  // Recomputed with exact modes, normalised by the same rule: i < j row by row. The print differs by the rounding of its modes, up to 1.1e-6.
  const double table[] = {2.144488861e-07, 8.047487928e-08, 4.488862806e-07, 1.457111199e-07, 7.264598039e-07, 2.307852446e-07, 1.077443106e-06,
                          6.633343792e-07, 2.261818232e-07, 1.175344727e-06, 3.764896528e-07, 1.803900952e-06, 5.801102150e-07, 1.389793054e-06,
                          4.569614924e-07, 2.252786460e-06, 7.258164906e-07, 3.349034996e-06, 2.467234998e-06, 8.062887509e-07, 3.797921436e-06,
                          1.248707424e-06, 4.012370409e-06, 1.329180109e-06, 5.993545438e-06, 6.207995498e-06, 2.116679488e-06, 9.343113529e-06};
  const TransverseModes modes(oklahoma_rest(Form::first_order));
  double m[8][41], norm[8];
  const auto simpson = [&](int i, int j) {
    double sum = 0.0;
    for (int s = 0; s <= 40; ++s) sum += (s == 0 || s == 40 ? 1.0 : s % 2 == 1 ? 4.0 : 2.0) / 120.0 * m[i][s] * m[j][s];
    return sum;
  };
  for (int i = 0; i < 8; ++i) {
    const TransverseMode mode = modes.mode(i + 1);
    for (int s = 0; s <= 40; ++s) m[i][s] = mode.value(s / 40.0);
    norm[i] = std::sqrt(simpson(i, i));
  }
  int k = 0;
  for (int i = 0; i < 8; ++i)
    for (int j = i + 1; j < 8; ++j)
      CHECK(simpson(i, j) / (norm[i] * norm[j]) == Approx(table[k++]).epsilon(0).margin(2e-12));  // of sums of order one
}

TEST_CASE("modes are orthonormal, also near the level guy and upside down") {
  for (const double k : {1.0, 1.0 + 1e-9, 1.0019999, 1.0020001, 1.1, 3.0, 50.0}) {
    INFO("k = " << k);
    for (const bool flip : {false, true}) {
      const double T0 = 1e4, TL = 1e4 * k * k;
      const TransverseModes modes = flip ? TransverseModes(TL, T0, 100.0, 2.0) : TransverseModes(T0, TL, 100.0, 2.0);
      std::vector<TransverseMode> mode;
      for (int i = 1; i <= 8; ++i) mode.push_back(modes.mode(i));
      for (int i = 0; i < 8; ++i) {
        CHECK(mode[i].value(0.0) == Approx(0.0).epsilon(0).margin(1e-10));
        CHECK(mode[i].value(1.0) == Approx(0.0).epsilon(0).margin(1e-10));
        CHECK(mode[i].slope(0.0) > 0.0);
        for (int j = 0; j <= i; ++j) {
          const auto inner = [&](auto&& f) {  // s = (1 - cos pi t)/2 gathers nodes at the ends
            return whirl::integrate<double, 80>([&](double t) { return 0.5 * pi * std::sin(pi * t) * f(0.5 * (1.0 - std::cos(pi * t))); });
          };
          const double product = inner([&](double s) { return mode[i].value(s) * mode[j].value(s); });
          // k = 50: the quadrature's own error; k near 1: Bessel functions of nearly equal arguments cancel six digits before the series takes over
          CHECK(product == Approx(i == j ? 1.0 : 0.0).epsilon(0).margin(k > 10.0 ? 1e-6 : k < 1.05 ? 1e-9 : 2e-10));
        }
        const double h = k > 10.0 ? 4e-8 : 1e-4;
        for (const double s : {0.0, 0.31, 0.5, 1.0}) {
          const double a = std::clamp(s, 2 * h, 1.0 - 2 * h);
          const double slope =
              (8.0 * (mode[i].value(a + h) - mode[i].value(a - h)) - (mode[i].value(a + 2 * h) - mode[i].value(a - 2 * h))) / (12.0 * h);
          CHECK(mode[i].slope(a) == Approx(slope).epsilon(k > 10.0 ? 1e-6 : 1e-9).margin(k > 10.0 ? 1e-5 : 1e-7));
        }
      }
    }
  }
}

TEST_CASE("the root of mode i lies in its bracket for any ratio of tensions, and tends to i pi for the level guy") {
  for (const double k : {1.0 + 1e-12, 1.0 + 1e-6, 1.001, 1.0019999, 1.0020001, 1.01, 1.1, 2.0, 10.0, 1e3, 1e5})
    for (const int i : {1, 2, 3, 8, 40}) {
      INFO("k = " << k << ", i = " << i);
      const double X = with_ratio(k).phase_number(i);
      CHECK(X > (i - 0.5) * pi);
      CHECK(X <= i * pi);
    }
  CHECK(with_ratio(1.0).phase_number(3) == Approx(3.0 * pi).epsilon(1e-15));
  // both sides of the switch: X - i pi = -(k - 1)^2/(8 k i pi) + ...
  for (const double k : {1.0019999, 1.0020001})
    for (int i = 1; i <= 4; ++i)
      CHECK(with_ratio(k).phase_number(i) - i * pi == Approx(-(k - 1.0) * (k - 1.0) / (8.0 * k * i * pi)).epsilon(1e-5).margin(4e-13 * i));
}

TEST_CASE("frequencies against a Galerkin solution that knows no Bessel function") {
  for (const double k : {1.1, 2.0, 4.0})
    for (int i = 1; i <= 3; ++i) {
      // w L sqrt(m/T0) = X (1 + k)/2
      const double w = with_ratio(k).phase_number(i) * 0.5 * (1.0 + k), g60 = galerkin_frequency(k, i, 60), g120 = galerkin_frequency(k, i, 120);
      CHECK(g120 > w * (1.0 - 1e-13));
      CHECK(g120 == Approx(w).epsilon(5e-6));         // k = 4
      CHECK(g120 - w < 0.2 * (g60 - w) + 1e-12 * w);  // third order
    }
}

TEST_CASE("Bessel functions of complex argument") {
  using C = std::complex<double>;
  for (const double x : {0.01, 1.0, 7.3, 24.9, 25.1, 400.0}) {
    const auto f = whirl::cylinder_functions(x);
    const double size = std::sqrt(2.0 / (pi * x));
    CHECK(f.j0.real() == Approx(boost::math::cyl_bessel_j(0, x)).epsilon(0).margin(1e-12 * size));
    CHECK(f.j1.real() == Approx(boost::math::cyl_bessel_j(1, x)).epsilon(0).margin(1e-12 * size));
    CHECK(f.y0.real() == Approx(boost::math::cyl_neumann(0, x)).epsilon(1e-12).margin(1e-12 * size));
    CHECK(f.y1.real() == Approx(boost::math::cyl_neumann(1, x)).epsilon(1e-12).margin(1e-12 * size));
  }
  for (const C x : {C(0.3, -0.2), C(5.0, 2.0), C(20.0, -4.0), C(24.0, -6.9), C(25.0, -6.9), C(60.0, 3.0)}) {
    const auto f = whirl::cylinder_functions(x);
    CHECK(std::abs(f.j1 * f.y0 - f.j0 * f.y1 - 2.0 / (pi * x)) < 1e-12 * (std::abs(f.j1 * f.y0) + std::abs(2.0 / (pi * x))));
    const C h(1e-4, 0.0);  // J0' = -J1 by differences
    const C slope = (8.0 * (whirl::cylinder_functions(x + h).j0 - whirl::cylinder_functions(x - h).j0) -
                     (whirl::cylinder_functions(x + 2.0 * h).j0 - whirl::cylinder_functions(x - 2.0 * h).j0)) /
                    (12.0 * h);
    CHECK(std::abs(slope + f.j1) < 1e-9 * std::abs(f.j1) + 1e-11 * std::abs(f.j0));
  }
  CHECK_THROWS_AS(whirl::cylinder_functions({-1.0, 0.0}), std::invalid_argument);
}

TEST_CASE("mode numbers, tensions and expansions out of range are refused") {
  CHECK_THROWS_AS(TransverseModes(0.0, 1.0, 1.0, 1.0), std::invalid_argument);
  CHECK_THROWS_AS(TransverseModes(1.0, 1.0, 1.0, -1.0), std::invalid_argument);
  CHECK_THROWS_AS(with_ratio(1.1).frequency(0), std::invalid_argument);
  CHECK_THROWS_AS(mcmahon_root(1, 1.0, 3), std::invalid_argument);
  CHECK_THROWS_AS(mcmahon_root(1, 1.1, 5), std::invalid_argument);
}
