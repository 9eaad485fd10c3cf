#pragma once
/// All steady states of the averaged equations of a forced modal system about one resonance: each coordinate moves with one harmonic of Omega =
/// omega/nu, or with none of its own. Every root of these polynomials is found (core/polynomial_system.hpp), so they seed motions that nothing else
/// leads to.
///
///     q_i = Re[ Z_i e^{i k_i Omega t} ] + q2_i + linear response to the forces at other harmonics
///     D_i(k) = K_i - k^2 Omega^2 + i k Omega c_i
///     0   = D_i(k_i) Z_i + 2 [b_i(q)]_{k_i} - F_i                [h]: coefficient of e^{i h Omega t};   unknowns Z_i and W_i = conj Z_i
///     q2_i = - sum over h != k_i of [b2_i(q)]_h e^{i h Omega t} / D_i(h)        b2: terms of second order, products of two and q cos(h omega t)
///
/// of third order in Z, the forced response and the parametric terms together [NayfehMook1979, section 2.3]. Harmonics h next to a resonance of their
/// own have no place in q2 and are left out of it.
///
///     AveragedStates half(2, {1, 0});                          // omega/2 in q1, nothing of its own in q2
///     for (const auto& z : half.solve(system)) z(1, 2);        // amplitude Q e^{i phase} of cos(omega t + phase) in q2
///
/// Throws std::invalid_argument for harmonics that do not fit.

#include <Eigen/Core>
#include <complex>
#include <memory>
#include <vector>

#include "core/polynomial_system.hpp"
#include "models/modal_system.hpp"

namespace whirl::models {

struct AveragedStateOptions {
  bool second_order = true;     ///< with q2; without it the equations of first order, better where parametric terms are as large as the stiffness
  double near_resonance = 0.2;  ///< |D_i(h)| below this part of K_i + h^2 Omega^2: no place in q2
  double real = 1e-6;           ///< |W - conj Z| of a real state, relative to 1 + |Z| in scaled units
  int max_paths = 300;          ///< of the polynomials' start system; beyond it `solve` gives nothing
};

class AveragedStates {
 public:
  /// harmonics: k_i for each coordinate, in units of omega/nu; 0 for none of its own.
  AveragedStates(int nu, std::vector<int> harmonics, const AveragedStateOptions& options = {});

  /// Amplitudes of the real states, coordinates x (H + 1), of harmonics 0..H of omega/nu; column 0 is the mean.
  std::vector<Eigen::MatrixXcd> solve(const ModalSystem<double>& system);
  /// Of the last `solve`: roots, real or not; -1 if the polynomials were too large.
  int roots() const { return roots_; }

 private:
  const PolynomialSolver& solver_for(const PolynomialSystem& polynomials, const std::vector<int>& group);

  int nu_;
  std::vector<int> harmonics_;
  AveragedStateOptions options_;
  std::vector<std::pair<PolynomialSystem, std::unique_ptr<PolynomialSolver>>> solvers_;  // one for each set of monomials met
  int roots_ = 0;
};

struct ResonanceOptions {
  std::vector<double> orders = {0.5, 1.0, 1.5, 2.0, 3.0};  ///< k_i / nu that are tried, those that are whole multiples of 1/nu
  double below = 0.4, above = 3.0;  ///< order omega over the natural frequency: motions far above it are those of stiffening systems
  int most_moving = 2;              ///< coordinates with a harmonic of their own; three where the system has three
};

/// Harmonics for `AveragedStates` with which the system may resonate: for each order the coordinates in its reach, the nearest ones; and each
/// coordinate at the order nearest to it, where that differs.
std::vector<std::vector<int>> likely_resonances(const ModalSystem<double>& system, int nu, const ResonanceOptions& options = {});

}  // namespace whirl::models
