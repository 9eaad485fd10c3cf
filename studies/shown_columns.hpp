#pragma once
/// Which columns of a branch the printed table shows.

#include <vector>

#include "studies/branch_output.hpp"

namespace whirl::studies {

/// Five at most: those marked, else amplitudes (phases and derived numbers stand in the file).
std::vector<std::size_t> shown_columns(const std::vector<PointColumn>& columns);

/// Adds columns that the printed table leaves out: it keeps those it would have shown without them.
void append_unshown(std::vector<PointColumn>& columns, std::vector<PointColumn> further);

}  // namespace whirl::studies
