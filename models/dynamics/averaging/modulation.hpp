#pragma once
/// The slow modulation of a motion, averaged and integrated, side by side: the averaged equations as equations in time,
/// [NielsenKirkegaard2002, eqs (39)-(46)], from the same physical start as the forced system.
///
///     averaged     x' = f(x, p), x = (u, v) of every kept harmonic, B of a mean
///     integrated   Z_k(t) = 2/T int_{t-T/2}^{t+T/2} q(s) e^{-i k w s / nu} ds,   B(t) = 1/T int q ds,   T = 2 pi nu / w,  t >= T/2
///
/// The start: x at t = 0 is the affine inverse of (q, q')(0) = motion(x, 0). Where a coordinate keeps several harmonics the displacement is given to
/// the one nearest its natural frequency, and the others start as zero.
///
///     Modulation m = modulation(system, averaged_flow, Vector::Constant(1, omega), y0, {.periods = 60});
///     m.averaged.row(r), m.integrated.row(r)       // Z of coordinate m.rows[r].first, harmonic m.rows[r].second of omega/nu
///
/// Units: q in m, t in s. Throws std::invalid_argument for options out of range.

#include <complex>
#include <functional>

#include "core/cvode.hpp"
#include "models/slow_flow/ansatz.hpp"

namespace whirl::models {

/// Averaged equations of an ansatz as a flow with the motion they stand for.
struct AveragedFlow {
  const Problem& flow;
  const Ansatz& ansatz;
  std::function<Vector(In u, double t)> motion;  ///< (q, q') of (x, p) at time t
};

struct ModulationOptions {
  int periods = 60;  ///< excitation periods integrated; at least nu
  int samples = 64;  ///< of an excitation period: of the motion, an even number
  IntegratorOptions integrator{.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12};
  void validate() const;
};

struct Modulation {
  std::vector<std::pair<int, int>> rows;  ///< coordinate and harmonic, in the ansatz's order
  Vector t;                               ///< middle of the windows, the first T/2
  Eigen::MatrixXcd integrated, averaged;  ///< rows x instants
  std::string why;                        ///< why it ends early, or ""

  double largest(int row) const { return integrated.row(row).cwiseAbs().maxCoeff(); }
  /// Largest |Z integrated - Z averaged| of all rows, over the largest |Z averaged|.
  double difference() const;
};

/// The averaged state of a physical state (q, q') at t = 0.
Vector averaged_start(const ModalSystem<double>& system, const AveragedFlow& averaged, In p, const Vector& y0);

Modulation modulation(const ModalSystem<double>& system, const AveragedFlow& averaged, In p, const Vector& y0, const ModulationOptions& options = {});

}  // namespace whirl::models
