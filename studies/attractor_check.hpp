#pragma once
/// Is a stable motion missing? Starts integrated at values of the parameter over the range, each followed to where it settles, and the attractors met
/// compared with the branches found. One that no branch holds starts a branch of its own (`OrbitBranches`), or is reported by name.
///
///     AttractorCheck check(source, options);
///     check.integrate(lower, upper, size, context);        // once; what it met stays
///     for (auto& met : check.met()) met.branch = ...;      // whoever knows the branches says which holds it, "" for none
///     check.text("omega");                                 // "96 starts integrated at 12 values of omega: all settle on branches found"
///
/// How long: twelve times the decay of the slowest damped coordinate. How many: as many starts as `budget` excitation periods allow, at most `starts`
/// at each value. Undamped systems have no attractors: nothing is integrated.

#include "models/attractor_survey.hpp"
#include "studies/forced_system.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

struct AttractorCheckOptions {
  int starts = 10;           ///< at each value; 0: no check
  int values = 12;           ///< of the parameter, evenly in the range
  bool bounded = true;       ///< fewer starts where the budget does not allow so many
  double decays = 12.0;      ///< of the slowest coordinate, after which a start has not settled
  double part_needed = 0.5;  ///< of these periods, that a start takes as a rule
  int least_periods = 200;   ///< granted to a start, however strong the damping
  int most_periods = 20000;  ///< granted to a start, however weak it is
  int max_multiple = 6;      ///< longest period looked for, in excitation periods
  double reach = 1.5;        ///< half width of the box of starts over the largest motion known
};

class AttractorCheck {
 public:
  struct Met {
    double p;
    models::SurveyResult::Met motion;
    std::string branch;  ///< that holds it; "" for none
  };

  AttractorCheck(const ForcedSystem& source, AttractorCheckOptions options) : source_(&source), options_(options) {}

  bool done() const { return done_; }
  /// size: largest displacement known of each coordinate; budget: excitation periods that may be integrated.
  void integrate(double lower, double upper, const Vector& size, double budget, RunContext& context);
  std::vector<Met>& met() { return met_; }
  const std::vector<Met>& met() const { return met_; }

  bool complete() const;  ///< every start settled on a branch found
  /// One line, "N starts integrated at M values of omega: ..."; "" if none was.
  std::string text(const std::string& parameter) const;
  /// {"starts": 96, "values": 12, "missing": 0, ..., "text": "..."}
  std::string json(const std::string& parameter) const;
  /// /verification/attractors: one row for each attractor met.
  void write(ResultFile& file, const std::string& parameter) const;

 private:
  std::string motions_without_branch() const;

  const ForcedSystem* source_;
  AttractorCheckOptions options_;
  bool done_ = false;
  std::vector<double> values_;  // integrated at
  std::vector<Met> met_;
  int starts_ = 0, unsettled_ = 0, diverged_ = 0, failed_ = 0, longest_ = 0;
};

}  // namespace whirl::studies
