#pragma once
/// Parts of a catenary-modes result that stand apart: damped modes in plane, and the nonlinear model on a few modes.

#include "models/catenary/reduced.hpp"
#include "studies/catenary_keys.hpp"

namespace whirl::studies {

/// /modes/damped (a root a row, slowest first), /shapes/damped/mode<k> (amplitude and phase along the cable), overdamped roots as an attribute.
void write_damped(ResultFile& file, const models::catenary::HangingCable& cable, const models::catenary::DampedSet& set, int points);
/// A table for the terminal; empty without drag.
std::string damped_text(const models::catenary::DampedSet& set, double unit);

/// /reduced: terms, and the model as text for a study file. Nothing if no modes are wanted.
void write_reduced(ResultFile& file, const models::catenary::HangingCable& cable, const models::catenary::ReducedOptions& o, RunContext& context);

}  // namespace whirl::studies
