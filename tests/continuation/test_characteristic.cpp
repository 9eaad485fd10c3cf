#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <random>

#include "continuation/characteristic.hpp"
#include "continuation/spectrum.hpp"

using namespace whirl;
using namespace whirl::continuation;

namespace {

// Largest distance of an eigenvalue from the nearest of the other set.
double apart(const std::complex<double>* z, const Eigen::VectorXcd& w) {
  double most = 0.0;
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    double least = 1e300;
    for (Eigen::Index k = 0; k < w.size(); ++k) least = std::min(least, std::abs(z[i] - w[k]));
    most = std::max(most, least);
  }
  return most;
}

}  // namespace

TEST_CASE("eigenvalues of small matrices by their factors follow those of the general solver", "[slow]") {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const int m : {3, 4}) {
    int settled = 0, asked = 0;
    for (int path = 0; path < 60; ++path) {  // from one random matrix to another
      const auto draw = [&] {
        Matrix a(m, m);
        for (auto& x : a.reshaped()) x = normal(random);
        return a;
      };
      const Matrix from = draw(), to = draw();
      RealFactors factors;
      for (int i = 0; i <= 200; ++i) {
        const Matrix a = from + (to - from) * (i / 200.0);
        const Eigen::VectorXcd w = Eigen::EigenSolver<Matrix>(a, false).eigenvalues();
        std::complex<double> z[4];
        if (factors.eigenvalues(a, z)) {
          CAPTURE(m, path, i);
          // Near a double eigenvalue both lose half of the digits.
          double gap = 1e300;
          for (int k = 0; k < m; ++k)
            for (int l = 0; l < k; ++l) gap = std::min(gap, std::abs(w[k] - w[l]));
          CHECK(apart(z, w) < 1e-12 * a.norm() * (1.0 + a.norm() / gap));
          ++settled;
        } else {
          factors.restart(w.data(), m);
        }
        ++asked;
      }
    }
    CAPTURE(m, settled, asked);
    CHECK(settled > 0.9 * asked);  // of rather long steps: a walk's are shorter
  }
}

TEST_CASE("a zero eigenvalue keeps its sign to rounding") {
  const Blocks blocks{.active = {}, .indices = {{0, 1, 2, 3}}, .subtype = {""}};
  Spectrum spectrum(blocks);
  for (const double small : {1e-3, 1e-9, -1e-9, 1e-13, -1e-13}) {
    Matrix a(4, 4), basis(4, 4);
    basis << 1, 2, 0, 1, 0, 1, 3, -1, 2, 0, 1, 1, 1, 1, 1, 4;
    a = basis * Eigen::Vector4d(small, -1.0, -2.0, -3.0).asDiagonal() * basis.inverse();
    for (int pass = 0; pass < 2; ++pass) {  // the second time from where the first one stood
      REQUIRE(spectrum.compute(a));
      double least = 1e300;
      for (const auto& x : spectrum.eigenvalues()) least = std::abs(x) < std::abs(least) ? x.real() : least;
      CHECK(least == Approx(small).epsilon(0).margin(3e-14));
    }
  }
}

TEST_CASE("slow eigenvalues beside a fast one keep their digits along a walk") {
  const Blocks three{.active = {}, .indices = {{0, 1, 2}}, .subtype = {""}}, four{.active = {}, .indices = {{0, 1, 2, 3}}, .subtype = {""}};
  for (const double fast : {1e4, 1e7, 1e10}) {
    Spectrum a(three), b(four);
    for (double x = 0.4; x < 0.7; x += 0.003) {
      Matrix j(3, 3), k(4, 4);
      j << 1 - 3 * x * x, 0.1, 0, 1, -1, 0, 2 * fast * x, 0, -fast;
      k << x - 0.5, -2, 0, 0, 2, x - 0.5, 0, 0, 2 * fast * x, 0, -fast, 0, 1, 1, 1, -0.3;
      REQUIRE(a.compute(j));
      REQUIRE(b.compute(k));
      const double half = -1.5 * x * x, root = std::sqrt(half * half + (1 - 3 * x * x) + 0.1);  // of the upper two by two
      double high = -1e300, pair = 0.0;
      for (const auto& z : a.eigenvalues()) high = std::max(high, z.real());
      for (const auto& z : b.eigenvalues()) pair = z.imag() > 0.0 ? z.real() : pair;
      CAPTURE(fast, x);
      CHECK(high == Approx(half + root).epsilon(0).margin(1e-14 * fast + 1e-11));
      CHECK(pair == Approx(x - 0.5).epsilon(0).margin(1e-14 * fast + 1e-11));
    }
  }
}
