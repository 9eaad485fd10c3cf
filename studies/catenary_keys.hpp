#pragma once
/// Keys, conversions and result-file parts that the studies of hanging cables share.

#include "models/catenary/cable.hpp"
#include "studies/configuration.hpp"
#include "studies/numbers.hpp"
#include "studies/result_file.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

/// [cable]: three of span, height_difference, length, sag, horizontal_tension, upper_tension; mass, gravity, stiffness; drag if wanted.
void add_hanging_cable_keys(Schema& schema, bool drag);
/// The cable; InputError at the key that cannot be.
models::catenary::HangingCable hanging_cable_of(const Configuration& c);
/// What the inextensible catenary leaves out of this cable.
std::vector<std::string> hanging_cable_warnings(const models::catenary::HangingCable& cable);
/// Geometry, tensions, end slopes, dimensionless numbers.
Numbers hanging_cable_numbers(const models::catenary::HangingCable& cable);
/// These into /cable, the report and the printed table.
void write_hanging_cable(ResultFile& file, RunContext& context, const models::catenary::HangingCable& cable);

/// Points along the cable as columns s, x, y in metres from the lower end; x in units of a from the apex for the solvers.
struct Along {
  Vector x;
  std::vector<Column> columns;
};
Along along(const models::catenary::HangingCable& cable, int points);
std::vector<double> to_std(const Eigen::Ref<const Vector>& v);

/// Warnings and outcome into /study; the exit status they amount to. `failures`: what was not reached.
ExitStatus finish_tables(ResultFile& file, RunContext& context, const std::vector<std::string>& failures);

}  // namespace whirl::studies
