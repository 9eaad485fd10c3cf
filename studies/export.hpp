#pragma once
/// The tables of a result file as CSV: `branches-IP1.csv` for the table `/branches/IP1`. Numbers that stand alone in a group make a table of one row
/// (`cable.csv` for /cable), texts a file of their own (`study-configuration.txt`), attributes a table of three columns, `attributes.csv`.
///
/// The first line of a file is a comment with the units (`# omega [rad/s], type`), the second holds the column names; numbers carry 17 significant
/// digits, so they read back unchanged. Each file appears under its name only when it is complete.
/// Throws InputError for a result that cannot be read and a folder that cannot be written.
///
///     for (const auto& file : export_csv("result.h5")) fmt::print("{}\n", file.string());    // result-csv/branches-IP1.csv, ...

#include <filesystem>
#include <vector>

namespace whirl::studies {

/// `folder` empty: `<stem>-csv` beside the result file. It is created if missing; files of earlier exports are replaced.
std::vector<std::filesystem::path> export_csv(const std::filesystem::path& result, std::filesystem::path folder = {});

}  // namespace whirl::studies
