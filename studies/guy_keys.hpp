#pragma once
/// Keys, conversions and result-file parts of the guy studies.

#include <string>
#include <vector>

#include "models/guy/linear_guy.hpp"
#include "models/guy/statics.hpp"
#include "studies/configuration.hpp"
#include "studies/numbers.hpp"
#include "studies/result_file.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

/// [guy] and [condition].
void add_guy_keys(Schema& schema);
/// [damping] of the linear studies.
void add_guy_damping_keys(Schema& schema);

/// The guy of a study file: as installed, and in its condition (ice on it, warmer or colder) at the same unstressed length.
struct GuyInput {
  models::guy::Statics installed, rest;     ///< of the form asked for
  models::guy::Statics exact, first_order;  ///< `rest` and its twin of the other form at the same H
};

/// InputError at the key that is to blame.
GuyInput guy_of(const Configuration& c);

/// c/m [1/s]: damping.rate, else 2 damping.ratio w_1 of the mean-tension string.
double damping_rate_of(const Configuration& c, const models::guy::Statics& rest);

/// `points` values from range[0] to range[1].
std::vector<double> grid_of(const Configuration& c, const std::string& range_key, int points);

/// Calls f and turns std::invalid_argument into an InputError at `key`.
template <class F>
auto blame(const Configuration& c, const std::string& key, F&& f) -> decltype(f()) {
  try {
    return f();
  } catch (const std::invalid_argument& e) {
    throw c.error(key, e.what());
  }
}

/// A column filled by calls.
template <class F>
Column column(const std::string& name, const std::string& unit, const std::string& description, std::size_t rows, F&& value) {
  Column made{name, unit, description, {}};
  made.values.reserve(rows);
  for (std::size_t i = 0; i < rows; ++i) made.values.push_back(value(i));
  return made;
}

/// /guy and /static_curve: everything derived, with units; in the report and the printed table too.
void write_guy(ResultFile& file, RunContext& context, const GuyInput& guy);

/// Warnings about what the input means, for `whirl check` and the file.
std::vector<std::string> guy_warnings(const GuyInput& guy);

}  // namespace whirl::studies
