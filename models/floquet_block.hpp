#pragma once
/// The steps of `Floquet` over one block of coordinates that the motion couples: Gauss collocation in Nystrom form, 8 nodes, order 16.
///
/// One step, unknowns z_p at the nodes tau_p = c_p h, all columns of the monodromy matrix at once:
///
///     z_p + h^2 sum_l Abar_pl K_l z_l = y + tau_p w,     K_l = diag(k - c^2/4) + g(tau_l) e^{(c_i - c_j) tau_l/2},   w = y' + c y/2
///     y <- e^{-c h/2} (y + h w - h^2 sum_l bbar_l K_l z_l),   w <- e^{-c h/2} (w - h sum_l b_l K_l z_l)
///
/// One or two coordinates: eliminated at once. More: K_l = D_l + N_l with D_l its diagonal, which is solved for exactly coordinate by coordinate,
///
///     z <- (I + h^2 Abar D)^{-1} (y + tau w) - (I + h^2 Abar D)^{-1} h^2 Abar N z
///
/// some 4 to 8 sweeps of small matrix products where elimination costs the third power of 8 m. Modes of a cable are coupled weakly and the step is
/// as short as the stiffest one asks, so the sweeps contract quickly; a step where they do not is eliminated.

#include "core/problem.hpp"
#include "models/modal_system.hpp"

namespace whirl::models {

struct GaussNystrom {
  static constexpr int nodes = 8;
  std::array<double, nodes> c{}, b{}, bbar{};           ///< nodes and weights of a unit step for z', z
  std::array<std::array<double, nodes>, nodes> abar{};  ///< z at the nodes from z'' at the nodes
  GaussNystrom();
};

class FloquetBlock {
 public:
  static constexpr int nodes = GaussNystrom::nodes;

  struct Coupling {
    const Matrix& g;                ///< samples, `nodes` a step, one column for each pair of coordinates that is coupled
    const std::vector<int>& place;  ///< column of pair (i, j) at i N + j, -1: none
  };

  /// Columns of the monodromy matrix of (q, q') for the coordinates of `block`, written into the 2N x 2N `monodromy`.
  void integrate(const ModalSystem<double>& system, const std::vector<int>& block, const Coupling& coupling, double h, int steps, double tolerance,
                 MatrixOut monodromy);
  int eliminated() const { return eliminated_; }  ///< steps of the last call with three coordinates or more that sweeps did not solve

 private:
  template <int fixed>
  void run(MatrixOut monodromy);
  void make_room(int m);
  template <int fixed>
  void stiffness_of_step(int step);
  template <int fixed>
  void eliminate_step();
  bool sweep_step();
  void solve_diagonals();
  template <int fixed>
  void advance();

  GaussNystrom gauss_;
  // Of the present call.
  const ModalSystem<double>* system_ = nullptr;
  const std::vector<int>* block_ = nullptr;
  const Coupling* coupling_ = nullptr;
  double h_ = 0.0, tolerance_ = 0.0;
  int m_ = 0, n_ = 0, steps_ = 0, eliminated_ = 0;
  std::vector<double> work_;       // [matrix | right-hand sides] of an elimination, row after row
  std::vector<double> stiffness_;  // N_l of this step; node, row, column
  std::vector<double> own_;        // D_l; coordinate, node
  std::vector<double> factor_;     // e^{(c_i - c_j) tau_l/2}
  std::vector<double> state_;      // y, w: m x 2m each, row after row; behind them e^{-c h/2}
  std::vector<double> z_, nz_;     // z and N z; coordinate, node, column
  std::vector<double> next_;       // one row of z
  std::vector<double> diagonal_;   // of each coordinate (I + h^2 Abar D)^{-1} [h^2 Abar, 1, tau], node after node
};

}  // namespace whirl::models
