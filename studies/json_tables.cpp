#include "studies/json_tables.hpp"

#include "studies/result_file.hpp"

namespace whirl::studies {
namespace {

constexpr std::size_t most_rows = 200;

std::size_t rows_of(const Table& table) {
  return !table.columns.empty() ? table.columns[0].values.size() : !table.text_columns.empty() ? table.text_columns[0].values.size() : 0;
}

Json column_json(const Table& table, const std::string& name, bool with_values) {
  Json o = Json::object();
  o.put("name", name);
  for (const Column& c : table.columns) {
    if (c.name != name) continue;
    o.put("unit", c.unit);
    if (with_values) o.put("values", Json::array(c.values));
  }
  for (const TextColumn& c : table.text_columns)
    if (c.name == name && with_values) o.put("values", Json::array(c.values));
  return o;
}

}  // namespace

Json tables_json(const std::filesystem::path& result) {
  Json all = Json::array();
  std::error_code ignored;
  if (!std::filesystem::exists(result, ignored)) return all;
  const ResultReader reader(result);
  for (const std::string& group : reader.tables()) {
    const Table table = reader.table(group);
    const std::size_t rows = rows_of(table);
    Json columns = Json::array();
    for (const std::string& name : reader.column_names(group)) columns.add(column_json(table, name, rows <= most_rows));
    all.add(std::move(Json::object().put("name", group).put("rows", rows).put("columns", std::move(columns))));
  }
  return all;
}

}  // namespace whirl::studies
