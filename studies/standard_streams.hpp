#pragma once
/// Standard output and error that may be closed, full, or without a reader: no file of the program gets their place, nothing thrown, no signal.
///
/// What standard error loses is lost; what standard output loses is told by `lost_output` at the end. A reader that goes away (`| head`) has what it
/// wants.

#include <optional>
#include <string>

namespace whirl::studies {

/// Before anything is opened or printed.
void secure_standard_streams();

/// Why standard output lost something: one line. Flushes it first.
std::optional<std::string> lost_output();

}  // namespace whirl::studies
