#pragma once
/// Groups, columns and attributes of one HDF5 file that grows by commits: columns go to the file at once, groups are rewritten by the commit that
/// follows a change, whatever no longer counts stays behind as unused bytes. A commit costs what was changed, not what the file holds.
///
///     ResultTree tree(file);
///     tree.put_column("/branches/IP1", "omega", values, {{"units", "rad/s"}});
///     tree.commit();

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "studies/append_file.hpp"
#include "studies/hdf5_format.hpp"

namespace whirl::studies {

using TextAttributes = std::vector<std::pair<std::string, std::string>>;
using AttributeValue = std::variant<double, std::string, std::vector<double>, std::vector<std::string>>;

class ResultTree {
 public:
  explicit ResultTree(AppendFile& file);
  ~ResultTree();

  /// Groups on the way are created; what bears the name is replaced.
  void put_attribute(const std::string& group, const std::string& name, AttributeValue value);
  void put_column(const std::string& group, const std::string& name, const std::vector<double>& values, const TextAttributes& attributes);
  void put_column(const std::string& group, const std::string& name, const std::vector<std::string>& values, const TextAttributes& attributes);
  void put_scalar(const std::string& group, const std::string& name, double value, const TextAttributes& attributes);
  void put_scalar(const std::string& group, const std::string& name, const std::string& value, const TextAttributes& attributes);
  /// Adds rows to a column that this made, or makes it. Rows in the file are not written again but when the column's place doubles.
  void extend_column(const std::string& group, const std::string& name, const std::vector<double>& values, const TextAttributes& attributes);
  void extend_column(const std::string& group, const std::string& name, const std::vector<std::string>& values, const TextAttributes& attributes);

  bool holds_columns() const { return holds_columns_; }
  bool changed() const;                                            ///< since the last commit
  const AttributeValue* attribute(const std::string& name) const;  ///< of /study; nothing if it has none

  void commit();
  /// Back to the last commit but for the attributes of /study; what is committed from now on goes into the file's reserve.
  void roll_back();

 private:
  struct Group;
  struct Link;
  struct Extended;  // a column that grows
  Group& group(const std::string& path);
  void put_dataset(const std::string& group, const std::string& name, const hdf5_format::Message& type, std::optional<std::size_t> rows,
                   std::uint64_t address, std::size_t bytes, const TextAttributes& attributes);
  void extend(const std::string& group, const std::string& name, const hdf5_format::Message& type, std::size_t element, std::string_view data,
              const TextAttributes& attributes);
  hdf5_format::Bytes references(const std::vector<std::string>& texts);
  hdf5_format::Bytes reference(const std::string& text);
  void begin_heap(std::size_t needed);
  void end_heap();
  hdf5_format::Message encoded(const std::string& name, const AttributeValue& value);
  std::uint64_t write(Group& group);

  AppendFile& file_;
  std::unique_ptr<Group> root_;
  std::map<std::string, Extended> extended_;
  bool holds_columns_ = false;
  struct Heap {
    std::uint64_t address = 0;
    std::size_t size = 0, used = 0;
    std::uint32_t texts = 0;
  } heap_;
};

}  // namespace whirl::studies
