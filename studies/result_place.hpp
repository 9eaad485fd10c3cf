#pragma once
/// Where a run may put its result: at a name that no file has yet, or over a result of this program. Everything else is somebody's file.
///
///     check_result_place("stay.h5");        // throws InputError (one line) for notes.txt, data.csv, an HDF5 file of another program

#include <filesystem>

namespace whirl::studies {

/// A new name must end in .h5 or .hdf5, or have no extension: results are HDF5 whatever they are called. An empty file counts as new.
void check_result_place(const std::filesystem::path& path);

}  // namespace whirl::studies
