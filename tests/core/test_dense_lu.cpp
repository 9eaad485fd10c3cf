#include <catch2/catch.hpp>
#include <random>

#include "core/dense_lu.hpp"

using namespace whirl;

TEST_CASE("dense LU solves both ways and knows the sign of the determinant, at every size") {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int n = 1; n <= 12; ++n) {
    DenseLu lu(n);
    for (int trial = 0; trial < 20; ++trial) {
      Matrix wide(n, n + 2);
      Vector b(n), x(n);
      for (auto& z : wide.reshaped()) z = normal(random);
      for (auto& z : b) z = normal(random);
      if (trial % 2 == 0) wide(0, 0) = 0.0;  // needs an exchange of rows
      const auto a = wide.leftCols(n);
      CAPTURE(n, trial);
      if (n == 1 && trial % 2 == 0) continue;
      lu.compute(a);
      const double bound = 1e-12 * (1.0 + Matrix(a).inverse().norm());  // errors grow with the condition
      lu.solve(b, x);
      CHECK((a * x - b).norm() < bound * (1.0 + x.norm()));
      lu.solve_transposed(b, x);
      CHECK((a.transpose() * x - b).norm() < bound * (1.0 + x.norm()));
      Vector same = b;
      lu.solve_transposed(same, same);
      CHECK(same == x);
      CHECK(lu.negative_determinant() == (Matrix(a).determinant() < 0.0));
    }
  }
}

TEST_CASE("dense LU of a singular matrix gives no finite solution") {
  DenseLu lu(3);
  lu.compute(Matrix::Zero(3, 3));
  Vector x = Vector::Ones(3);
  lu.solve(x, x);
  CHECK_FALSE(x.allFinite());
}
