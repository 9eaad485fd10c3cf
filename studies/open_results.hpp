#pragma once
/// Results while they are written, and how they end when their run does not end by itself. See ResultFile for what stands at a path at which instant.

#include <filesystem>
#include <string>
#include <vector>

#include "studies/result_file.hpp"

namespace whirl::studies {

constexpr const char* interrupted_outcome = "interrupted";  ///< attribute `outcome` of /study

/// Adds rows to a table of an open result, or begins it: costs the rows added, not those that are there.
void extend_table(ResultFile& file, const std::string& group, const std::vector<Column>& columns, const std::vector<TextColumn>& text_columns = {});

/// Does the result stand at its path? An interrupted run that has no table yet leaves an older one there.
bool published(const ResultFile& file);

/// Tells every open result that its run was interrupted, and lets none be written any more: the program must end now. The files written.
std::vector<std::filesystem::path> end_interrupted_runs() noexcept;

/// Every attribute and column once: throws if the file or one of them is damaged.
void read_all(const std::filesystem::path& path);

}  // namespace whirl::studies
