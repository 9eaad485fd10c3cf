#pragma once
/// Attractors that a set of starts leads to at one value of a system's parameters: the question asked of branches found, does any motion settle on
/// what they do not hold?
///
///     SurveyResult s = survey_attractors(system, reflections, {.starts = 10, .half_width = box});
///     for (const auto& a : s.attractors) a.motion.multiple, a.starts;
///
/// Starts are a low-discrepancy sequence over the box of (q, q') about rest, the first at rest; `first` goes on where another survey stopped, so that
/// neighbouring values of a parameter see different starts. Everything is integrated in units of the box and of the excitation's phase: the result
/// does not depend on units. Throws std::invalid_argument for boxes of the wrong size.

#include "models/attractors.hpp"

namespace whirl::models {

struct SurveyOptions {
  int starts = 10;
  int first = 0;      ///< number of the first start in the sequence; 0 is rest
  Vector half_width;  ///< of (q, q'), size 2 n, all > 0
  AttractorOptions settle;
  int patience = 3;         ///< a start that has not settled goes on from where it is, so many times in all
  int samples = 128;        ///< of a recorded motion, per excitation period
  int record_periods = 16;  ///< recorded where it has none
  void validate(int states) const;
};

struct SurveyResult {
  struct Met {
    Attractor attractor;  ///< in the units of the system
    SteadyMotion motion;
    int starts;  ///< that settle on it or on a mirror image
  };
  std::vector<Met> attractors;  ///< of mirror images one
  int starts = 0, unsettled = 0, diverged = 0, failed = 0;
  long periods = 0;  ///< integrated
};

SurveyResult survey_attractors(const ModalSystem<double>& system, const std::vector<Reflection>& reflections, const SurveyOptions& options);

/// Excitation periods in which the slowest damped coordinate falls to 1/e by linear theory; infinity without damping.
double slowest_decay(const ModalSystem<double>& system);

/// q = size y, theta = omega t: the system for y(theta), with omega = 1.
ModalSystem<double> in_units_of(const ModalSystem<double>& system, double size);

}  // namespace whirl::models
