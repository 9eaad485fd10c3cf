#pragma once
/// The tables of a result file as the member "tables" of what `--json` prints.

#include <filesystem>

#include "studies/json.hpp"

namespace whirl::studies {

/// [{"name": "/modes", "rows": 8, "columns": [{"name": "omega", "unit": "rad/s", "values": [...]}, ...]}, ...], a column of texts without a unit.
/// Tables of more than 200 rows come without their values: `export` has them. Empty if there is no file.
Json tables_json(const std::filesystem::path& result);

}  // namespace whirl::studies
