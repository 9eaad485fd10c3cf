#pragma once
/// Where a forced modal system settles: time integration with CVODE to the steady motion, and what kind of motion that is.
///
/// The stroboscopic map x(t) -> x(t + T), T = 2 pi/omega, is iterated until x(t + m T) = x(t) for the smallest m <= max_multiple, the distance still
/// to go estimated from the rate at which successive distances shrink. Of what does not settle within max_periods, distances |x(t + m T) - x(t)| are
/// compared, the largest of an eighth of max_periods in the middle with that of the last eighth, for the m that comes nearest to itself:
///
///     they fall (or grow) by more than 3 %      unsettled; `decay_rate` is measured, `why` says it
///     they last, largest Lyapunov exponent > 0  chaotic
///     they last, exponent zero                  quasi-periodic; or unsettled, `decay_rate` from the multipliers, where a stable periodic motion is
///                                               found in the middle whose damping is too weak to be seen over those periods (slow_decay.hpp)
///
///     SteadyMotion m = settle(system, y0, {.max_periods = 2000});      // y0 = (q, q') at omega t = 0
///     m.harmonic(0, 2.0)                                                // amplitude and phase of cos(2 omega t + phase) in q1

#include <atomic>
#include <complex>

#include "core/cvode.hpp"
#include "models/modal_system.hpp"

namespace whirl::models {

enum class MotionKind { periodic, quasi_periodic, chaotic, unsettled, failed, diverging };
const char* to_string(MotionKind kind);

struct SettleOptions {
  double tolerance = 1e-8;  ///< of the stroboscopic point, relative to 1 + |x|
  int max_periods = 3000;
  int max_multiple = 8;        ///< longest period looked for, in excitation periods
  int samples = 128;           ///< per excitation period of the recorded motion
  int record_periods = 64;     ///< recorded where the motion is not periodic
  int lyapunov_periods = 400;  ///< for motions that do not settle; 0: leave them `unsettled`
  IntegratorOptions integrator{.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12};
  const std::atomic<bool>* interrupted = nullptr;
  void validate() const;
};

struct SteadyMotion {
  MotionKind kind = MotionKind::failed;
  int multiple = 0;  ///< m, in excitation periods; 0 if not periodic
  int periods_integrated = 0;
  double distance = 0.0;    ///< last stroboscopic distance |x(t + m T) - x(t)|
  double lyapunov = 0.0;    ///< largest exponent [1/s], where computed
  double decay_rate = 0.0;  ///< of stroboscopic distances that shrink still [1/s], where unsettled; negative where they grow
  double omega = 0.0;
  Vector state;   ///< stroboscopic point at omega t = 0 (mod 2 pi), size 2 n
  Matrix record;  ///< 2 n x samples of the motion after settling, first column at omega t = 0
  int record_periods = 0;
  std::string why;  ///< if failed or unsettled

  /// Complex amplitude Q e^{i phase} of Q cos(k omega t + phase) in coordinate i; k may be a fraction. A mean for k = 0.
  std::complex<double> harmonic(int i, double k) const;
};

SteadyMotion settle(const ModalSystem<double>& system, const Vector& y0, const SettleOptions& options = {});

}  // namespace whirl::models
