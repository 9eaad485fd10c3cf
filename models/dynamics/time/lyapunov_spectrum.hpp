#pragma once
/// All Lyapunov exponents of a motion [Benettin1980]: a frame of tangent vectors carried along, made orthogonal after every interval,
///
///     V R = (d x(t + dt) / d x(t)) Q,   lambda_i = 1/(N dt) sum ln R_ii,   error: the standard error of the means of 20 blocks of the run
///
/// Their sum is the mean divergence along the motion, which is integrated on its own where the flow is known.
///
///     LyapunovSpectrum s = lyapunov_spectrum(flow, x0, p, {.interval = 0.5, .skip = 400, .counted = 40000});
///     s.exponent[0] > 3 * s.error[0]              // chaos: s.kind
///
/// Units: 1 over the flow's time. Throws std::invalid_argument for options out of range.

#include <atomic>
#include <string>

#include "core/problem.hpp"
#include "models/stroboscope.hpp"

namespace whirl::models {

struct LyapunovSpectrumOptions {
  double interval = 1.0;  ///< between orthogonalisations, in the flow's time; about 1 over the largest exponent or less
  int skip = 100;         ///< intervals before counting
  int counted = 4000;     ///< intervals counted, at least 20
  double relative_tolerance = 1e-10;
  const std::atomic<bool>* interrupted = nullptr;
  void validate() const;
};

/// What the exponents say, none taken for positive or negative within three standard errors (and five over the time counted, what a periodic motion's
/// tangent leaves over).
enum class FlowMotion { equilibrium, cycle, torus, chaotic, failed };
const char* to_string(FlowMotion motion);

struct LyapunovSpectrum {
  Vector exponent, error;   ///< falling; empty if the integration failed or was interrupted
  double divergence = 0.0;  ///< mean trace of the Jacobian, integrated on its own; NaN where the flow is not known
  double time = 0.0;        ///< counted
  Vector end;               ///< where the motion is then
  FlowMotion kind = FlowMotion::failed;
  bool ok() const { return exponent.size() > 0; }
  double sum() const { return exponent.sum(); }
  /// Kaplan-Yorke dimension of the attractor, what counts as zero taken as zero; NaN where even the sum of all exponents is positive.
  double dimension() const;
  /// Below it exponent i counts as zero.
  double margin(Eigen::Index i) const;
};

/// Of an autonomous flow from x0 at parameters p.
LyapunovSpectrum lyapunov_spectrum(const Problem& flow, const Vector& x0, const Vector& p, const LyapunovSpectrumOptions& options = {});
/// Of a forced system from the stroboscopic point y; `options.interval` is not used: an interval is a period. The exponent of time itself, zero, is
/// not among them: `torus` has one zero, `cycle` (a periodic motion) none.
LyapunovSpectrum lyapunov_spectrum(Stroboscope& strobe, const Vector& y, const LyapunovSpectrumOptions& options = {});

}  // namespace whirl::models
