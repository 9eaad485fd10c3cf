// Gauss rules and Legendre families; definite pencils with their inertia count.
#include <catch2/catch.hpp>
#include <cmath>

#include "core/legendre.hpp"
#include "core/symmetric_pencil.hpp"

using namespace whirl;

TEST_CASE("gauss rules integrate polynomials of degree 2 n - 1") {
  for (const int n : {1, 2, 5, 12, 41, 128, 301}) {
    const GaussRule rule = gauss_legendre(n);
    CHECK(rule.weights.sum() == Approx(2.0).epsilon(1e-13));
    const int even = 2 * n - 2;  // the highest even degree
    CHECK(rule.weights.dot(rule.nodes.array().pow(even).matrix()) == Approx(2.0 / (even + 1.0)).epsilon(1e-11));
    CHECK((rule.nodes + rule.nodes.reverse()).cwiseAbs().maxCoeff() < 1e-15);
  }
  CHECK_THROWS_AS(gauss_legendre(0), std::invalid_argument);
}

TEST_CASE("legendre families: orthogonality, ends, integrals") {
  const int n = 12;
  const GaussRule rule = gauss_legendre(n + 4);
  const Matrix p = legendre_values(rule.nodes, n + 3), slope = dirichlet_slopes(p, n);
  CHECK((slope.transpose() * rule.weights.asDiagonal() * slope - Matrix::Identity(n, n)).cwiseAbs().maxCoeff() < 1e-13);
  Matrix gram = p.leftCols(n).transpose() * rule.weights.asDiagonal() * p.leftCols(n);
  for (int k = 0; k < n; ++k) gram(k, k) -= 2.0 / (2.0 * k + 1.0);
  CHECK(gram.cwiseAbs().maxCoeff() < 1e-14);
  const Vector ends = Eigen::Vector2d(-1.0, 1.0);
  const Matrix at_ends = legendre_values(ends, n + 3);
  CHECK(dirichlet_values(at_ends, n).cwiseAbs().maxCoeff() < 1e-15);
  CHECK(dirichlet_integrals(at_ends, n).rightCols(n - 1).cwiseAbs().maxCoeff() < 1e-15);
  CHECK(dirichlet_integrals(at_ends, n)(1, 0) == Approx(2.0 / std::sqrt(6.0)));
  // Slopes and integrals by differences.
  const double t = 0.3, d = 1e-5;
  const auto at = [&](double x) { return legendre_values(Vector::Constant(1, x), n + 3); };
  CHECK(((dirichlet_values(at(t + d), n) - dirichlet_values(at(t - d), n)) / (2 * d) - dirichlet_slopes(at(t), n)).cwiseAbs().maxCoeff() < 1e-7);
  CHECK(((dirichlet_integrals(at(t + d), n) - dirichlet_integrals(at(t - d), n)) / (2 * d) - dirichlet_values(at(t), n)).cwiseAbs().maxCoeff() <
        1e-8);
  CHECK(((legendre_integrals(at(t + d), n) - legendre_integrals(at(t - d), n)) / (2 * d) - at(t).leftCols(n)).cwiseAbs().maxCoeff() < 1e-7);
  CHECK_THROWS_AS(dirichlet_values(at(t), n + 2), std::invalid_argument);
}

TEST_CASE("symmetric pencil: inertia counts and refusals") {
  Matrix K = Matrix::Identity(3, 3), M = Matrix::Zero(3, 3);
  M.diagonal() << 1.0, 0.25, 0.0;
  const PencilModes modes = lowest_modes(K, M, 3);
  CHECK(modes.omega[0] == Approx(1.0));
  CHECK(modes.omega[1] == Approx(2.0));
  CHECK(std::isinf(modes.omega[2]));
  CHECK(frequencies_below(K, M, 0.9) == 0);
  CHECK(frequencies_below(K, M, 1.5) == 1);
  CHECK(frequencies_below(K, M, 1e6) == 2);
  CHECK(modes.vectors.col(1).dot(M * modes.vectors.col(1)) == Approx(1.0));
  CHECK_THROWS_AS(lowest_modes(-K, M, 1), std::invalid_argument);
  CHECK_THROWS_AS(lowest_modes(K, Matrix::Zero(2, 2), 1), std::invalid_argument);
}
