// Gauss rules and Legendre families; definite pencils with their inertia count.
#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/legendre.hpp"
#include "core/symmetric_pencil.hpp"
#include "core/tridiagonal_vectors.hpp"

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

TEST_CASE("symmetric pencil: a few modes are those of all") {
  std::srand(7);
  for (const int n : {6, 25, 80}) {
    const Matrix a = Matrix::Random(n, n), b = Matrix::Random(n, n);
    const Matrix K = a * a.transpose() + Matrix::Identity(n, n), M = b * b.transpose();
    const PencilModes few = lowest_modes(K, M, 5, true, 3);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> all(M, K);
    REQUIRE(few.vectors.cols() == std::min(5, n));
    REQUIRE(few.omega.size() == std::min(8, n));
    for (Eigen::Index i = 0; i < few.omega.size(); ++i) CHECK(few.omega[i] == Approx(1.0 / std::sqrt(all.eigenvalues()[n - 1 - i])).epsilon(1e-11));
    const Matrix& q = few.vectors;
    CHECK((q.transpose() * M * q - Matrix::Identity(q.cols(), q.cols())).cwiseAbs().maxCoeff() < 1e-10);
    for (Eigen::Index i = 0; i < q.cols(); ++i)
      CHECK((K * q.col(i) - few.omega[i] * few.omega[i] * M * q.col(i)).norm() < 1e-9 * (K * q.col(i)).norm() * n);
    for (const double w : {0.5 * few.omega[0], 0.5 * (few.omega[2] + few.omega[3]), 3.0 * few.omega[4]})
      for (const int stiff : {0, n / 3, n - 1, n}) CHECK(frequencies_below(K, M, w, stiff) == frequencies_below(K, M, w));
  }
}

TEST_CASE("tridiagonal vectors: equal and nearly equal eigenvalues, blocks that fall apart") {
  // Twin wells: eigenvalues in pairs, closer than rounding. And a diagonal with equal entries.
  const int n = 41;
  Vector d(n), e = Vector::Constant(n - 1, 1.0);
  for (int i = 0; i < n; ++i) d[i] = std::abs(i - n / 2);
  for (const bool diagonal : {false, true}) {
    if (diagonal) {
      e.setZero();
      d.head(10).setConstant(99.0);
    }
    Matrix T = d.asDiagonal();
    T.diagonal(1) = T.diagonal(-1) = e;
    const Vector mu = Eigen::SelfAdjointEigenSolver<Matrix>(T).eigenvalues().reverse();
    Matrix z;
    REQUIRE(tridiagonal_vectors(d, e, mu.head(12), z));
    CHECK((z.transpose() * z - Matrix::Identity(12, 12)).cwiseAbs().maxCoeff() < 1e-11);
    CHECK((T * z - z * mu.head(12).asDiagonal()).cwiseAbs().maxCoeff() < 1e-11);
  }
}
