#pragma once
/// The HDF5 file of one run: tables (a group with one 1-D dataset per column), scalars, texts and attributes, each with `units` and `description`.
///
/// Columns keep the order in which they were written. `flush()` after each completed branch: nothing of the file's structure reaches the disk
/// between flushes, so a run killed later leaves the state of the last one. A file that cannot be created or read throws InputError (one line); a
/// write that fails (disk full) throws std::runtime_error and leaves the last flushed state; columns of unequal length or of one name throw
/// std::invalid_argument.
///
///     ResultFile out("result.h5");
///     out.attribute("/study", "kind", "superharmonic");
///     out.table("/branches/IP1", {{"omega", "rad/s", "excitation frequency", omega}, {"n_unstable", "-", "unstable directions", n}});
///     out.flush();

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace whirl::studies {

struct Column {
  std::string name, unit, description;
  std::vector<double> values;
};

struct TextColumn {
  std::string name, description;
  std::vector<std::string> values;
};

struct Table {
  std::vector<Column> columns;
  std::vector<TextColumn> text_columns;
};

struct Scalar {
  double value;
  std::string unit, description;
};

std::string hdf5_version();  ///< "HDF5 1.10.8"

class HdfHandle;  // closes what the C library opened

/// Missing groups on the way are created, groups that exist are reused, a dataset or attribute written again is replaced.
class ResultFile {
 public:
  /// Creates the file; one that exists is overwritten.
  explicit ResultFile(const std::filesystem::path& path);
  ~ResultFile();
  ResultFile(ResultFile&&) noexcept;
  ResultFile& operator=(ResultFile&&) noexcept;

  /// Throws the InputError the constructor would throw, but leaves the place as it is: nothing is created, nothing truncated.
  static void check_writable(const std::filesystem::path& path);

  static constexpr const char* unfinished = "unfinished";  ///< attribute `outcome` of /study while a run goes on
  /// Of a run that ended by an exception after its file was closed: outcome "failed" and why. Leaves a file alone whose run has told its outcome,
  /// and what it cannot read or write.
  static void mark_failed(const std::filesystem::path& path, const std::string& reason) noexcept;

  void attribute(const std::string& group, const std::string& name, double value);
  void attribute(const std::string& group, const std::string& name, const std::string& value);
  void attribute(const std::string& group, const std::string& name, const std::vector<double>& values);
  void attribute(const std::string& group, const std::string& name, const std::vector<std::string>& values);

  void scalar(const std::string& group, const std::string& name, double value, const std::string& unit, const std::string& description);
  void text(const std::string& group, const std::string& name, const std::string& value);
  void table(const std::string& group, const std::vector<Column>& columns, const std::vector<TextColumn>& text_columns = {});

  void flush();
  const std::filesystem::path& path() const { return path_; }

 private:
  template <class Write>
  void attempt(Write&& write);

  std::filesystem::path path_;
  std::unique_ptr<HdfHandle> file_;
};

/// Reads what ResultFile wrote. Asking for what is not there throws InputError.
class ResultReader {
 public:
  explicit ResultReader(const std::filesystem::path& path);
  ~ResultReader();
  ResultReader(ResultReader&&) noexcept;
  ResultReader& operator=(ResultReader&&) noexcept;

  std::vector<std::string> tables() const;                                ///< "/branches/IP1", ...: groups with at least one 1-D dataset
  std::vector<std::string> groups() const;                                ///< all of them, "/" first
  std::vector<std::string> column_names(const std::string& group) const;  ///< in the order written, texts among numbers
  std::vector<std::string> scalar_names(const std::string& group) const;  ///< numbers that stand alone
  std::vector<std::string> text_names(const std::string& group) const;    ///< texts that stand alone
  Table table(const std::string& group) const;
  Column column(const std::string& group, const std::string& name) const;
  TextColumn text_column(const std::string& group, const std::string& name) const;

  Scalar scalar(const std::string& group, const std::string& name) const;
  std::string text(const std::string& group, const std::string& name) const;
  bool has(const std::string& object) const;  ///< a group or dataset
  std::vector<std::string> children(const std::string& group) const;

  std::vector<std::string> attribute_names(const std::string& object) const;
  bool holds_numbers(const std::string& object, const std::string& attribute) const;
  double number_attribute(const std::string& object, const std::string& name) const;
  std::string text_attribute(const std::string& object, const std::string& name) const;
  std::vector<double> numbers_attribute(const std::string& object, const std::string& name) const;
  std::vector<std::string> texts_attribute(const std::string& object, const std::string& name) const;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::vector<std::string> names_of(const std::string& group, int dimensions, bool numbers, bool texts) const;

  std::filesystem::path path_;
  std::unique_ptr<HdfHandle> file_;
};

}  // namespace whirl::studies
