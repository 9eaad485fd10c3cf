#pragma once
/// Motions of a flow met by integration, by their Lyapunov exponents: the table /motions, the same as JSON and as text.

#include "models/dynamics/time/lyapunov_spectrum.hpp"
#include "studies/json.hpp"
#include "studies/result_file.hpp"

namespace whirl::studies {

struct IntegratedMotion {
  double parameter = 0.0;
  Vector start;
  models::LyapunovSpectrum spectrum;
};

struct MotionTable {
  std::string parameter, unit, unit_of_time;
  std::vector<std::string> variables;

  void write(ResultFile& file, const std::vector<IntegratedMotion>& motions) const;
  static Json json(const std::vector<IntegratedMotion>& motions, const std::string& parameter);
  std::string text(const std::vector<IntegratedMotion>& motions) const;
};

}  // namespace whirl::studies
