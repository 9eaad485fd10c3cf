#pragma once
/// All isolated complex roots of a square system of polynomials, by homotopy continuation.
///
///     H(x, t) = (1 - t) gamma g(x) + t f(x),   t from 0 to 1 along each root of g
///
/// Unknowns stand in groups; an equation whose degree in group k is d_k starts from a product of d_k random affine forms of each group, so the number
/// of paths is the multihomogeneous Bezout number, [MorganSommese1987]. These paths lead to the roots of a system with the same monomials and random
/// complex coefficients, once; every system of that shape is then reached from those roots [SommeseWampler2005]. With probability one no isolated
/// root is missed. A multiple root may be: paths that come near it end as `failed`.
///
///     PolynomialSolver solver(f, {0, 0, 1, 1});                // x0, x1 one group, x2, x3 the other
///     PolynomialRoots r = solver.solve(f);                     // f, or other coefficients of the same monomials
///     r.finite, r.at_infinity, r.failed
///
/// Scale unknowns and equations so that roots wanted are of size one. Throws std::invalid_argument for shapes that do not fit.

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace whirl {

struct Monomial {
  std::complex<double> coefficient;
  std::vector<int> powers;  ///< one for each unknown
};

struct PolynomialSystem {
  std::vector<std::vector<Monomial>> equations;  ///< as many as unknowns
  int unknowns() const { return static_cast<int>(equations.size()); }
};

struct HomotopyOptions {
  double tolerance = 1e-11;      ///< of a root, relative to 1 + |x|
  double first_step = 0.02;      ///< in t
  double longest_step = 0.1;     ///< in t
  double shortest_step = 1e-12;  ///< in t; a path that needs shorter ones has failed
  double largest_guess = 0.03;   ///< first Newton correction accepted, relative to 1 + |x|: nearer paths than that are told apart
  double infinity = 1e5;         ///< |x| beyond which a path is taken to go to infinity
  int max_corrections = 4;       ///< of Newton's method in a step
  int max_steps = 2000;          ///< on a path
  double same = 1e-6;            ///< two roots are one if they differ by less, relative to 1 + |x|
  int max_paths = 4000;          ///< of the random system
  void validate() const;
};

struct PolynomialRoots {
  std::vector<Eigen::VectorXcd> finite;  ///< each once
  int paths = 0, at_infinity = 0, failed = 0;
};

/// Number of paths of the product start, the multihomogeneous Bezout number; -1 beyond `limit`.
int multihomogeneous_bezout(const PolynomialSystem& shape, const std::vector<int>& group, int limit);

class PolynomialSolver {
 public:
  PolynomialSolver(const PolynomialSystem& shape, const std::vector<int>& group, const HomotopyOptions& options = {});
  /// f: the shape's monomials, in its order.
  PolynomialRoots solve(const PolynomialSystem& f) const;
  int generic_roots() const { return static_cast<int>(generic_.finite.size()); }
  const PolynomialRoots& generic() const { return generic_; }

 private:
  HomotopyOptions options_;
  PolynomialSystem random_;
  PolynomialRoots generic_;
};

}  // namespace whirl
