#pragma once
/// Floquet multipliers of a periodic motion of a forced modal system, over the nu excitation periods that the motion lasts.
///
///     q_i = a_i0 + sum_k a_ik cos(k theta) + b_ik sin(k theta),  theta = omega t / nu          x = per coordinate [a0, a1, b1, .., aH, bH]
///     y_i'' + c_i y_i' + k_i y_i + sum_j g_ij(t) y_j = 0,        g_ij = d b_i / d q_j          small disturbance y of q
///
/// Floquet (production): z_i = e^{c_i t/2} y_i, t from the start of each step, takes the damping out exactly,
///
///     z_i'' + (k_i - c_i^2/4) z_i + sum_j g_ij e^{(c_i - c_j) t/2} z_j = 0,
///
/// and z is advanced by Gauss collocation with 8 nodes a step (order 16, floquet_block.hpp). g stands in tables of the nodes, made from the terms
/// directly or, where they are many, from the harmonics of g.
/// The number of steps follows from the stiffness and is raised by half until two results agree. Coordinates that g does not couple (in plane and
/// out of plane on planar motion) are separate blocks, found from exact zeros or given. The smaller of two real multipliers of a single coordinate
/// comes from Liouville's determinant e^{-c nu T}.
///
/// monodromy_by_integration (reference, slow): motion and disturbance integrated together with CVODE, nothing tabulated.
///
///     Floquet floquet(system, 15, 1);
///     const FloquetResult& f = floquet.compute(system, x);      // f.multipliers[0] is the largest of block 0
///
/// Throws std::invalid_argument for sizes that do not fit and for blocks that the motion couples.

#include <Eigen/Eigenvalues>
#include <map>

#include "core/problem.hpp"
#include "models/floquet_block.hpp"

namespace whirl::models {

/// Product of a term's factors but one (`skip` = -1: of all) times cos(h omega t), at every sample. q: column per coordinate.
template <class Q, class S>
void term_product(const Term<S>& term, int skip, const Q* q, const double* cosine, int samples, Q* out) {
  for (int m = 0; m < samples; ++m) out[m] = Q(cosine[m]);
  for (int a = 0; a < term.degree; ++a) {
    if (a == skip) continue;
    const Q* factor = q + std::ptrdiff_t(samples) * term.factor[static_cast<std::size_t>(a)];
    for (int m = 0; m < samples; ++m) out[m] = out[m] * factor[m];
  }
}

/// How often the coordinate of factor a stands in the term; 0 unless a is its first appearance.
template <class S>
int multiplicity(const Term<S>& term, int a) {
  int count = 0;
  for (int b = 0; b < term.degree; ++b) {
    if (term.factor[static_cast<std::size_t>(b)] != term.factor[static_cast<std::size_t>(a)]) continue;
    if (b < a) return 0;
    ++count;
  }
  return count;
}

struct FloquetOptions {
  double tolerance = 1e-11;  ///< of the monodromy matrix, relative to its largest entry
  int max_steps = 4096;      ///< over the period
  void validate() const;
};

struct FloquetResult {
  Eigen::VectorXcd multipliers;          ///< 2N, block after block, by falling modulus within a block
  Matrix monodromy;                      ///< of (q, q') over nu T, 2N x 2N
  std::vector<std::vector<int>> blocks;  ///< coordinates of each block
  double error = 0.0;                    ///< of the monodromy matrix, from two step lengths, relative
  int steps = 0;
  int eliminated = 0;  ///< steps that were eliminated because sweeps did not contract, of both step lengths and all blocks
  bool converged = false;
};

class Floquet {
 public:
  static constexpr int nodes = GaussNystrom::nodes;  ///< of a step
  using Blocks = std::vector<std::vector<int>>;

  /// `shape` gives the number of coordinates and the largest harmonic of any term.
  Floquet(const ModalSystem<double>& shape, int harmonics, int nu, const FloquetOptions& options = {});

  /// Multipliers of the motion x. Empty `blocks`: coordinates that g leaves uncoupled are separated.
  const FloquetResult& compute(const ModalSystem<double>& system, In x, const Blocks& blocks = {});

 private:
  struct Grid {  // harmonics of theta, cos(h omega t) at some instants
    Matrix basis, cosine;
  };
  void list_pairs(const ModalSystem<double>& shape);
  template <class Fraction>
  Grid fill_grid(Fraction fraction, int samples, int top) const;
  const Grid& grid(int steps);
  void sample(const ModalSystem<double>& system, In x, const Grid& grid);
  void analyse();
  void tabulate(const ModalSystem<double>& system, In x, int steps);
  bool couples(int i, int j) const;
  Blocks find_blocks() const;
  void check_blocks(const Blocks& blocks) const;
  int first_guess(const ModalSystem<double>& system, double period) const;
  void integrate(const ModalSystem<double>& system, double period, int steps, MatrixOut monodromy);
  void collect(const ModalSystem<double>& system, double period);

  FloquetOptions options_;
  int n_, harmonics_, nu_, max_harmonic_;
  std::size_t terms_ = 0;
  int pairs_ = 0;
  std::vector<int> place_;  // column of g of pair (i, j) at i N + j, -1: no term couples them
  GaussNystrom gauss_;
  FloquetBlock steps_of_block_;
  std::map<int, Grid> grids_;  // at the nodes of so many steps
  Matrix q_, g_, coarse_, fine_;
  std::vector<double> product_;
  // Where the terms are many: g sampled at as few even instants as its harmonics need, and from the harmonics at the nodes.
  Grid even_;
  Matrix analysis_, compact_, gamma_;  // empty: the terms are sampled at the nodes themselves
  std::vector<int> coupled_;
  int kept_ = 0;  // rows of gamma_ that are not rounding
  FloquetResult result_;
};

struct IntegratedPeriod {
  Vector end;        ///< (q, q') after nu excitation periods
  Matrix monodromy;  ///< d end / d start
  bool ok = false;
};

/// One period nu T from (q, q') = start at omega t = 0 with its derivative by the start, by CVODE at the relative tolerance given.
IntegratedPeriod monodromy_by_integration(const ModalSystem<double>& system, const Vector& start, int nu, double tolerance = 1e-13);

/// Periodic motion through (q, q') near `start`, by Newton on the integrated period map. `ok` false if it does not converge to `tolerance`.
struct IntegratedOrbit {
  Vector state;
  Matrix monodromy;
  double defect = 0.0;  ///< |end - start|
  bool ok = false;
};
IntegratedOrbit periodic_by_integration(const ModalSystem<double>& system, Vector start, int nu, double tolerance = 1e-12);

}  // namespace whirl::models
