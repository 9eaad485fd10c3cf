#pragma once
/// Systems that define special points, themselves Problems: Newton locates a point, the walker follows a curve of them.
/// All derivatives are exact (`Problem::second` of the base). A base with k parameters gives a system with k - 1.
///
/// SingularSystem, fold or symmetry-breaking point. A = r_x on the rows and columns of block M, x on the coordinates S, else zero:
///
///     r_S(x, p) = 0,  g(x, p) = 0      [ A   b ] [v]   [0]      dg = -w' D2r[v, .]
///                                      [ c'  0 ] [g] = [1]
///   M = S: fold (or any singular r_x along x); M a block of odd coordinates: pitchfork. Unknowns (x_S, p1 | p2 ...).
///
/// BranchPointSystem, simple branch point without symmetry: [r_x r_p1] loses rank.
///
///     r(x, p) + beta b0 = 0,  g1 = g2 = 0      [ J   b ] [V]   [0]      dg_i = -w' D2r[v_i, .]
///                                              [ C'  0 ] [g] = [I]
///   Unknowns (x, p1, beta | p2 ...); beta = 0 at a branch point that persists.
///
/// HopfSystem: A^2 + kappa I loses rank two; kappa = (frequency)^2 > 0 Hopf, < 0 neutral saddle, = 0 Bogdanov-Takens (regular).
///
///     r_S(x, p) = 0,  two entries of G = 0     [ A^2 + kappa I   W ] [X]   [0]
///                                              [ V'              0 ] [G] = [I]
///   Unknowns (x_S, p1, kappa | p2 ...).
///
/// PeakSystem, an extremum of a(x) = 1/2 x'Qx + l'x along the curve r(x, p1) = 0:
///
///     r_S(x, p) = 0,  h = (Qx + l)' v_x = 0    [ r_x r_p1 ] [v]   [0]     dh = v_x'Q . - w' D2r[v, .],  [ r_x r_p1 ]' [w]   [Qx + l]
///                                              [   c'     ]     = [1]                                   [   c'     ]     = [  0   ]
///   Unknowns (x_S, p1 | p2 ...).

#include "continuation/blocks.hpp"
#include "core/dense_lu.hpp"

namespace whirl::continuation {

/// Shared by all: where the base's unknowns stand in the system's, and the order of work. Everything at one y is evaluated once.
class AugmentedSystem : public Problem {
 public:
  /// The base's u = (x, p) behind the system's unknowns.
  Vector base_point(In y) const;
  /// The system's unknowns for the base point u (extra unknowns as given).
  virtual Vector unknowns(In u) const = 0;
  /// Recomputes the borders at y; keeps the bordered matrices well conditioned along a curve.
  virtual void update_borders(In y) = 0;
  const Problem& base() const { return base_; }

 protected:
  AugmentedSystem(const Problem& base, Indices state, int extra);
  void spread(In y) const;                                       // y -> u_
  void gather_rows(MatrixIn j, int extra, MatrixOut out) const;  // [J_SS | J_Sp] into the system's columns
  /// Solves the bordered system at y, whose base point and Jacobian stand in u_ and j_.
  virtual void solve_bordered(In y) const = 0;
  virtual void fill_residual(In y, Out r) const = 0;  ///< from u_, r_ and the bordered solutions
  virtual void fill_jacobian(In y, MatrixOut j) const = 0;
  void prepare(In y) const;  // u_, j_ and the bordered solutions at y
  int column(int base_column) const { return column_[static_cast<std::size_t>(base_column)]; }

  const Problem& base_;
  Indices state_;            // S
  int extra_;                // scalar unknowns beyond x_S and p1
  std::vector<int> column_;  // base column -> system column, -1 outside S
  mutable Vector u_, r_;
  mutable Matrix j_, h_;

 private:
  void do_residual(In y, Out r) const override;
  void do_jacobian(In y, MatrixOut j) const override;
  void do_linearise(In y, Out r, MatrixOut j) const override;
};

class SingularSystem : public AugmentedSystem {
 public:
  SingularSystem(const Problem& base, Indices state, Indices block, In u);
  Vector unknowns(In u) const override;
  void update_borders(In y) override;
  Vector null_vector(In y) const;       ///< v, size n, unit length
  Vector left_null_vector(In y) const;  ///< w, size n, unit length

 private:
  void fill_residual(In y, Out r) const override;
  void fill_jacobian(In y, MatrixOut j) const override;
  void solve_bordered(In y) const override;
  Indices block_;  // M
  Vector b_, c_;
  mutable Matrix bordered_;
  mutable DenseLu lu_;
  mutable Vector v_, w_, full_;
};

class BranchPointSystem : public AugmentedSystem {
 public:
  BranchPointSystem(const Problem& base, In u);
  Vector unknowns(In u) const override;
  void update_borders(In y) override;
  bool persists(In y) const;            ///< beta is zero, up to rounding: two curves cross and do not just come near
  Matrix null_space(In y) const;        ///< two columns spanning ker [r_x r_p1], size n + 1
  Vector left_null_vector(In y) const;  ///< size n, unit length

 private:
  void fill_residual(In y, Out r) const override;
  void fill_jacobian(In y, MatrixOut j) const override;
  void solve_bordered(In y) const override;
  Vector b_;
  Matrix c_;
  mutable Matrix bordered_, v_;
  mutable DenseLu lu_;
  mutable Vector w_, full_;
};

class HopfSystem : public AugmentedSystem {
 public:
  /// `kappa`: of the pair meant, from what is known near u; none: of the pair nearest the imaginary axis.
  HopfSystem(const Problem& base, Indices state, Indices block, In u, double kappa = 0.0);
  Vector unknowns(In u) const override;
  void update_borders(In y) override;
  double kappa(In y) const { return y[static_cast<int>(state_.size()) + 1]; }

 private:
  void fill_residual(In y, Out r) const override;
  void fill_jacobian(In y, MatrixOut j) const override;
  void solve_bordered(In y) const override { solve_bordered(kappa(y)); }
  void solve_bordered(double kappa) const;
  bool null_planes(double kappa);
  void choose_entries();
  void gradients(bool first, bool second) const;  // into four_, rows dG00, dG10, dG01, dG11; of each column of G only where asked
  Indices block_;
  Matrix left_, right_;  // W, V
  double kappa0_ = 0.0;
  int entry_[2] = {0, 1};
  mutable Matrix a_, bordered_, x_, y_, g_, four_;
  mutable DenseLu lu_;
  mutable Vector full_, against_;
};

/// a(x) = 1/2 x'Qx + l'x of the unknowns x: a coordinate, or half the square of an amplitude.
struct QuadraticForm {
  Matrix Q;
  Vector l;
  static QuadraticForm coordinate(int n, int i);
  static QuadraticForm square_sum(int n, const Indices& of);  ///< half the sum of x_i^2
  double value(In x) const { return 0.5 * x.dot(Q * x) + l.dot(x); }
  Vector gradient(In x) const { return Q * x + l; }
};

class PeakSystem : public AugmentedSystem {
 public:
  PeakSystem(const Problem& base, Indices state, QuadraticForm form, In u);
  Vector unknowns(In u) const override;
  void update_borders(In y) override;

 private:
  void fill_residual(In y, Out r) const override;
  void fill_jacobian(In y, MatrixOut j) const override;
  void solve_bordered(In y) const override;
  QuadraticForm form_;
  Vector c_;
  mutable Matrix bordered_;
  mutable DenseLu lu_;
  mutable Vector v_, w_, gradient_, full_;
};

}  // namespace whirl::continuation
