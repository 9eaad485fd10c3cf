#include "studies/result_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>

#include "studies/append_file.hpp"
#include "studies/hdf5_format.hpp"
#include "studies/hdf_handle.hpp"
#include "studies/open_results.hpp"
#include "studies/result_tree.hpp"

namespace whirl::studies {

namespace fs = std::filesystem;

namespace {

/// What is on disk and what is to come. Each operation is whole before the next begins, whichever thread asks for it.
struct OpenResult {
  explicit OpenResult(const fs::path& path) : file(path), tree(file) {}
  AppendFile file;
  ResultTree tree;
  std::mutex guard;
  bool held = true;      ///< by a ResultFile
  bool damaged = false;  ///< a write failed

  bool tells_end() const {
    const AttributeValue* outcome = tree.attribute("outcome");
    return !outcome || *outcome != AttributeValue(std::string(ResultFile::unfinished));
  }
  /// Nothing is put in the place of an older result that is not worth more.
  bool is_worth_publishing() const {
    const AttributeValue* outcome = tree.attribute("outcome");
    const bool empty_end = outcome && *outcome == AttributeValue(std::string(interrupted_outcome)) && file.replaces();
    return tree.holds_columns() || (tells_end() && !empty_end);
  }
  void commit() {
    if (tree.changed()) tree.commit();
    if (is_worth_publishing()) file.publish();
  }
  void end(const std::string& outcome, const std::vector<std::string>& reasons);
};

/// The files of runs that have not told how they ended: for those who end a run from outside.
struct OpenRuns {
  std::mutex guard;
  std::map<fs::path, std::shared_ptr<OpenResult>> all;
};

OpenRuns& open_runs() {
  static auto* runs = new OpenRuns;  // lives longer than what ends a run
  return *runs;
}

constexpr std::size_t longest_attribute = 60000;  // bytes of its data; a header message ends at 65535

template <class T>
constexpr std::size_t element_size = std::is_same_v<T, double> ? sizeof(double) : hdf5_format::text_reference_size;

class WrittenFile final : public HdfHandle {
 public:
  explicit WrittenFile(std::shared_ptr<OpenResult> result) : result_(std::move(result)) {}
  ~WrittenFile() override;

 private:
  std::shared_ptr<OpenResult> result_;
};

void OpenResult::end(const std::string& outcome, const std::vector<std::string>& reasons) {
  if (damaged) tree.roll_back();
  tree.put_attribute("/study", "outcome", outcome);
  tree.put_attribute("/study", "stop_reasons", reasons);
  commit();
}

std::shared_ptr<OpenResult> opened(const fs::path& path) {
  OpenRuns& runs = open_runs();
  const std::lock_guard lock(runs.guard);
  if (const auto it = runs.all.find(path); it != runs.all.end() && !it->second->held) runs.all.erase(it);
  return runs.all[path] = std::make_shared<OpenResult>(path);
}

std::shared_ptr<OpenResult> result_at(const fs::path& path) {
  OpenRuns& runs = open_runs();
  const std::lock_guard lock(runs.guard);
  return runs.all.at(path);
}

/// Writes; after a failure (disk full) the last commit is what the file holds, and only its end can be told.
template <class Write>
void write_to(const fs::path& path, Write&& write) {
  const auto result = result_at(path);
  const std::lock_guard lock(result->guard);
  if (result->damaged) throw std::runtime_error(fmt::format("{}: writing failed before", path.string()));
  try {
    write(*result);
  } catch (const std::runtime_error&) {
    result->damaged = true;
    throw;
  }
}

/// A run that an exception ends is left to who catches it, see mark_failed.
WrittenFile::~WrittenFile() {
  OpenRuns& runs = open_runs();
  const std::lock_guard lock(runs.guard), lock_result(result_->guard);
  result_->held = false;
  const bool told = result_->tells_end(), thrown = std::uncaught_exceptions() > 0;
  if (told) std::erase_if(runs.all, [&](const auto& run) { return run.second == result_; });
  if (result_->damaged || (thrown && !told)) return;
  try {
    result_->commit();
    if (result_->file.published()) result_->file.synchronize();
  } catch (const std::exception&) {  // the last commit stays
  }
}

}  // namespace

ResultFile::ResultFile(const fs::path& path) : path_(path), file_(std::make_unique<WrittenFile>(opened(path))) {}
ResultFile::~ResultFile() = default;
ResultFile::ResultFile(ResultFile&&) noexcept = default;
ResultFile& ResultFile::operator=(ResultFile&&) noexcept = default;

void ResultFile::check_writable(const fs::path& path) { AppendFile::check(path); }

void ResultFile::mark_failed(const fs::path& path, const std::string& reason) noexcept try {
  OpenRuns& runs = open_runs();
  const std::lock_guard lock(runs.guard);
  const auto it = runs.all.find(path);
  if (it == runs.all.end()) return;
  const auto result = it->second;
  if (result->held) return;
  runs.all.erase(it);
  const std::lock_guard lock_result(result->guard);
  result->end("failed", {reason});
} catch (const std::exception&) {  // not even a last word fits on the disk: what failed first is what is told
}

std::vector<fs::path> end_interrupted_runs() noexcept try {
  std::vector<fs::path> published;
  OpenRuns& runs = open_runs();
  const std::lock_guard lock(runs.guard);
  for (auto& [path, result] : runs.all) {
    result->guard.lock();  // never released: the program ends
    if (!result->tells_end()) result->end(interrupted_outcome, {interrupted_outcome});
    if (result->file.published()) published.push_back(path);
  }
  return published;
} catch (const std::exception&) {  // not even a last word fits on the disk
  return {};
}

bool published(const ResultFile& file) { return result_at(file.path())->file.published(); }

namespace {

template <class T>
void put_list(const fs::path& path, const std::string& group, const std::string& name, const std::vector<T>& values) {
  write_to(path, [&](OpenResult& result) {
    if (values.size() * element_size<T> <= longest_attribute) result.tree.put_attribute(group, name, values);
    else result.tree.put_column(group, name, values, {{"description", "a list longer than an attribute can be"}});
  });
}

}  // namespace

void ResultFile::attribute(const std::string& group, const std::string& name, double value) {
  write_to(path_, [&](OpenResult& result) { result.tree.put_attribute(group, name, value); });
}
void ResultFile::attribute(const std::string& group, const std::string& name, const std::string& value) {
  write_to(path_, [&](OpenResult& result) { result.tree.put_attribute(group, name, value); });
}
void ResultFile::attribute(const std::string& group, const std::string& name, const std::vector<double>& values) {
  put_list(path_, group, name, values);
}
void ResultFile::attribute(const std::string& group, const std::string& name, const std::vector<std::string>& values) {
  put_list(path_, group, name, values);
}

void ResultFile::scalar(const std::string& group, const std::string& name, double value, const std::string& unit, const std::string& description) {
  write_to(path_, [&](OpenResult& result) { result.tree.put_scalar(group, name, value, {{"units", unit}, {"description", description}}); });
}

void ResultFile::text(const std::string& group, const std::string& name, const std::string& value) {
  write_to(path_, [&](OpenResult& result) { result.tree.put_scalar(group, name, value, {{"description", ""}}); });
}

namespace {

void check_rows(const std::string& group, const std::vector<Column>& columns, const std::vector<TextColumn>& text_columns) {
  const std::size_t rows = !columns.empty() ? columns[0].values.size() : !text_columns.empty() ? text_columns[0].values.size() : 0;
  const auto same = [&](const auto& column) { return column.values.size() == rows; };
  if (!std::all_of(columns.begin(), columns.end(), same) || !std::all_of(text_columns.begin(), text_columns.end(), same))
    throw std::invalid_argument(fmt::format("table {}: columns of unequal length", group));
  std::set<std::string> names;  // a second column of a name would replace the first without a word
  const auto fresh = [&](const auto& column) { return names.insert(column.name).second; };
  if (!std::all_of(columns.begin(), columns.end(), fresh) || !std::all_of(text_columns.begin(), text_columns.end(), fresh))
    throw std::invalid_argument(fmt::format("table {}: two columns of one name", group));
}

TextAttributes meaning(const Column& c) { return {{"units", c.unit}, {"description", c.description}}; }
TextAttributes meaning(const TextColumn& c) { return {{"description", c.description}}; }

}  // namespace

void ResultFile::table(const std::string& group, const std::vector<Column>& columns, const std::vector<TextColumn>& text_columns) {
  check_rows(group, columns, text_columns);
  write_to(path_, [&](OpenResult& result) {
    for (const Column& c : columns) result.tree.put_column(group, c.name, c.values, meaning(c));
    for (const TextColumn& c : text_columns) result.tree.put_column(group, c.name, c.values, meaning(c));
  });
}

void extend_table(ResultFile& file, const std::string& group, const std::vector<Column>& columns, const std::vector<TextColumn>& text_columns) {
  check_rows(group, columns, text_columns);
  write_to(file.path(), [&](OpenResult& result) {
    for (auto c = columns.begin(); c != columns.end(); ++c) {  // of two of a name the last counts, as in a table written at once
      const bool again = std::any_of(c + 1, columns.end(), [&](const Column& later) { return later.name == c->name; });
      if (!again) result.tree.extend_column(group, c->name, c->values, meaning(*c));
    }
    for (const TextColumn& c : text_columns) result.tree.extend_column(group, c.name, c.values, meaning(c));
  });
}

void ResultFile::flush() {
  write_to(path_, [](OpenResult& result) { result.commit(); });
}

}  // namespace whirl::studies
