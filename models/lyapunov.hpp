#pragma once
/// The largest Lyapunov exponent of a forced modal system by its variational equation: one tangent vector carried along and brought back to length
/// one every period,
///
///     lambda = 1/(N T) sum_k ln |v(t_k + T)|,        error: twice the standard error of the means over 16 stretches of the run
///
///     const LyapunovResult r = largest_lyapunov(strobe, y, {.periods = 4000, .skip = 200});   // y moves along

#include "models/stroboscope.hpp"

namespace whirl::models {

struct LyapunovOptions {
  int periods = 800;  ///< counted
  int skip = 100;     ///< before counting, while the tangent turns
  void validate() const;
};

struct LyapunovResult {
  double exponent = 0.0;  ///< [1/s]
  double error = 0.0;     ///< [1/s]
  Matrix points;          ///< stroboscopic points after every counted period, 2 n x periods
  bool ok = false;        ///< false: the integration failed or the motion diverged
};

LyapunovResult largest_lyapunov(Stroboscope& strobe, Vector& y, const LyapunovOptions& options = {});

}  // namespace whirl::models
