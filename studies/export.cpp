#include "studies/export.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <string>

#include "studies/configuration.hpp"
#include "studies/result_file.hpp"

namespace whirl::studies {
namespace {

namespace fs = std::filesystem;

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n\r#") == std::string::npos) return text;
  std::string s = "\"";
  for (const char c : text) s += c == '"' ? std::string("\"\"") : std::string(1, c);
  return s + '"';
}

struct Cells {
  std::string name, unit;
  std::vector<std::string> rows;
};

/// The columns in the order of the file.
std::vector<Cells> cells_of(const ResultReader& reader, const std::string& group) {
  const Table table = reader.table(group);
  std::vector<Cells> all;
  for (const std::string& name : reader.column_names(group)) {
    Cells cells{name, "", {}};
    for (const Column& c : table.columns) {
      if (c.name != name) continue;
      cells.unit = c.unit;
      for (const double x : c.values) cells.rows.push_back(fmt::format("{:.17g}", x));
    }
    for (const TextColumn& c : table.text_columns)
      if (c.name == name) std::transform(c.values.begin(), c.values.end(), std::back_inserter(cells.rows), csv_text);
    all.push_back(std::move(cells));
  }
  return all;
}

std::string csv(const std::vector<Cells>& columns) {
  std::vector<std::string> units, row;
  std::size_t n = 0;
  for (const Cells& c : columns) {
    units.push_back(c.unit.empty() ? c.name : fmt::format("{} [{}]", c.name, c.unit));
    row.push_back(csv_text(c.name));
    n = std::max(n, c.rows.size());
  }
  std::string text = fmt::format("# {}\n{}\n", fmt::join(units, ", "), fmt::join(row, ","));
  for (std::size_t i = 0; i < n; ++i) {
    row.clear();
    for (const Cells& c : columns) row.push_back(i < c.rows.size() ? c.rows[i] : "");
    text += fmt::format("{}\n", fmt::join(row, ","));
  }
  return text;
}

// Numbers that stand alone in a group, as a table of one row.
std::vector<Cells> scalars_of(const ResultReader& reader, const std::string& group) {
  std::vector<Cells> all;
  for (const std::string& name : reader.scalar_names(group)) {
    const Scalar s = reader.scalar(group, name);
    all.push_back({name, s.unit, {fmt::format("{:.17g}", s.value)}});
  }
  return all;
}

// Attributes of all groups: stop reasons, tangents of groups of guys, omitted by tables. A list takes a row an entry.
std::vector<Cells> attributes_of(const ResultReader& reader) {
  std::vector<Cells> all{{"object", "", {}}, {"attribute", "", {}}, {"value", "", {}}};
  const auto add = [&](const std::string& object, const std::string& name, const std::string& value) {
    all[0].rows.push_back(csv_text(object));
    all[1].rows.push_back(csv_text(name));
    all[2].rows.push_back(csv_text(value));
  };
  for (const std::string& group : reader.groups())
    for (const std::string& name : reader.attribute_names(group)) {
      if (reader.holds_numbers(group, name))
        for (const double x : reader.numbers_attribute(group, name)) add(group, name, fmt::format("{:.17g}", x));
      else
        for (const auto& text : reader.texts_attribute(group, name)) add(group, name, text);
    }
  return all;
}

/// Under another name first: whoever finds `path` finds all of it.
void write_whole(const fs::path& path, const std::string& text) {
  const fs::path part = path.string() + ".part";
  std::ofstream out(part, std::ios::binary);
  out << text;
  out.close();
  std::error_code failure, ignored;
  if (out) fs::rename(part, path, failure);
  if (out && !failure) return;
  fs::remove(part, ignored);
  throw InputError(fmt::format("{}: cannot be written", path.string()));
}

std::string file_name(const std::string& group, const std::string& extension, std::set<std::string>& taken) {
  std::string stem = group == "/" ? "root" : group.substr(group.find_first_not_of('/'));
  std::replace(stem.begin(), stem.end(), '/', '-');
  std::string name = stem + extension;
  for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{}-{}{}", stem, i, extension);
  return name;
}

}  // namespace

std::vector<fs::path> export_csv(const fs::path& result, fs::path folder) {
  const ResultReader reader(result);
  if (folder.empty()) folder = result.parent_path() / (result.stem().string() + "-csv");
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (!fs::is_directory(folder, failure)) throw InputError(fmt::format("{}: cannot be created as a folder", folder.string()));
  std::vector<fs::path> files;
  std::set<std::string> taken;
  const auto write = [&](const std::string& name, const char* extension, const std::string& text) {
    files.push_back(folder / file_name(name, extension, taken));
    write_whole(files.back(), text);
  };
  for (const std::string& group : reader.tables()) write(group, ".csv", csv(cells_of(reader, group)));
  for (const std::string& group : reader.groups()) {
    if (const auto scalars = scalars_of(reader, group); !scalars.empty()) write(group, ".csv", csv(scalars));
    for (const std::string& name : reader.text_names(group)) write(group + "/" + name, ".txt", reader.text(group, name));
  }
  write("attributes", ".csv", csv(attributes_of(reader)));
  return files;
}

}  // namespace whirl::studies
