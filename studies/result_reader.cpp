#include "studies/result_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <stdexcept>
#include <utility>

#include "studies/configuration.hpp"
#include "studies/hdf_handle.hpp"
#include "studies/open_results.hpp"

namespace whirl::studies {

namespace {

namespace fs = std::filesystem;

/// The id, or an exception naming what could not be done.
HdfHandle opened(hid_t id, HdfHandle::Close close, std::string_view what) {
  if (id < 0) throw std::runtime_error(fmt::format("{} failed", what));
  return {id, close};
}

void done(herr_t status, std::string_view what) {
  if (status < 0) throw std::runtime_error(fmt::format("{} failed", what));
}

/// No messages of the library's own, and no closing of files at exit: handles close what they opened. Comes before any other call of the library.
void start_library() {
  [[maybe_unused]] static const herr_t once = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

HdfHandle open_object(hid_t file, const std::string& name) { return opened(H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose, "opening " + name); }

[[noreturn]] void refuse(const fs::path& path, std::string_view why) { throw InputError(fmt::format("{}: {}", path.string(), why)); }

bool is_locked(const fs::path& path, int wanted) {  // HDF5 holds an exclusive lock on a file it writes, a shared one on a file it reads
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool locked = ::flock(fd, wanted | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(fd);
  return locked;
}

hid_t open_file(const fs::path& path) {
  start_library();
  std::error_code ignored;
  if (!fs::exists(path, ignored)) refuse(path, "no such file");
  if (fs::is_directory(path, ignored)) refuse(path, "is a directory, not a result file");
  if (::access(path.c_str(), R_OK) != 0) refuse(path, "cannot be read");
  if (is_locked(path, LOCK_SH)) refuse(path, "is being written by another program");
  if (H5Fis_hdf5(path.c_str()) <= 0) refuse(path, "is not an HDF5 file");
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id < 0) refuse(path, "is truncated or damaged");
  return id;
}

// Reading ------------------------------------------------------------------------------------------------------------------------------------------

enum class Content { numbers, texts, other };

Content content_of(hid_t type) {
  const H5T_class_t type_class = H5Tget_class(type);
  if (type_class == H5T_FLOAT || type_class == H5T_INTEGER) return Content::numbers;
  return type_class == H5T_STRING && H5Tis_variable_str(type) > 0 ? Content::texts : Content::other;
}

/// Number of elements (1 for a scalar); nothing for what is neither scalar nor 1-D.
std::optional<std::size_t> length_of(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  const hssize_t n = H5Sget_simple_extent_npoints(space);
  return (rank == 0 || rank == 1) && n >= 0 ? std::optional(static_cast<std::size_t>(n)) : std::nullopt;
}

/// Reads numbers or texts through `read(memory_type, buffer)`; nothing if the content is of the other sort.
template <class Read>
std::optional<std::vector<double>> read_numbers(hid_t type, hid_t space, Read&& read) {
  const auto n = length_of(space);
  if (!n || content_of(type) != Content::numbers) return std::nullopt;
  std::vector<double> values(*n);
  if (*n > 0) done(read(H5T_NATIVE_DOUBLE, values.data()), "reading");
  return values;
}

template <class Read>
std::optional<std::vector<std::string>> read_texts(hid_t type, hid_t space, Read&& read) {
  const auto n = length_of(space);
  if (!n || content_of(type) != Content::texts) return std::nullopt;
  std::vector<char*> raw(*n, nullptr);
  if (*n == 0) return std::vector<std::string>{};
  const HdfHandle memory = opened(H5Tget_native_type(type, H5T_DIR_DEFAULT), H5Tclose, "string type");
  done(read(memory, raw.data()), "reading");
  std::vector<std::string> values;
  for (const char* p : raw) values.emplace_back(p ? p : "");
  done(H5Dvlen_reclaim(memory, space, H5P_DEFAULT, raw.data()), "reading");
  return values;
}

std::vector<std::string> members(hid_t group) {
  std::vector<std::string> names;
  const HdfHandle creation = opened(H5Gget_create_plist(group), H5Pclose, "group properties");
  unsigned flags = 0;
  H5Pget_link_creation_order(creation, &flags);
  const H5_index_t index = (flags & H5P_CRT_ORDER_TRACKED) != 0 ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* into) -> herr_t {
    static_cast<std::vector<std::string>*>(into)->emplace_back(name);
    return 0;
  };
  done(H5Literate(group, index, H5_ITER_INC, nullptr, collect, &names), "listing");
  return names;
}

H5I_type_t kind_of(hid_t group, const std::string& name) {
  const HdfHandle object(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose);
  return object < 0 ? H5I_BADID : H5Iget_type(object);
}

struct DataSet {
  HdfHandle set, type, space;
  auto reader() const {
    return [this](hid_t memory, void* into) { return H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, into); };
  }
};

constexpr hsize_t best_compression = 1032;  // of deflate: a damaged header claims more

DataSet open_dataset(hid_t file, const std::string& path) {
  HdfHandle set = opened(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "opening " + path);
  HdfHandle type = opened(H5Dget_type(set), H5Tclose, "reading " + path), space = opened(H5Dget_space(set), H5Sclose, "reading " + path);
  hsize_t size = 0;
  done(H5Fget_filesize(file, &size), "reading " + path);
  if (const auto rows = length_of(space); rows && *rows > best_compression * size)
    throw std::runtime_error(path + " claims more rows than the file holds");
  return {std::move(set), std::move(type), std::move(space)};
}

/// Reads an attribute by one of the two functions above; nothing if it is missing or of the other sort.
template <class How>
auto read_attribute(hid_t object, const std::string& name, How&& how) -> decltype(how(hid_t{}, hid_t{}, [](hid_t, void*) { return herr_t{}; })) {
  if (H5Aexists(object, name.c_str()) <= 0) return std::nullopt;
  const HdfHandle attribute = opened(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, "attribute " + name);
  const HdfHandle type = opened(H5Aget_type(attribute), H5Tclose, "attribute " + name);
  const HdfHandle space = opened(H5Aget_space(attribute), H5Sclose, "attribute " + name);
  return how(type, space, [&](hid_t memory, void* into) { return H5Aread(attribute, memory, into); });
}

constexpr auto as_numbers = [](hid_t type, hid_t space, auto&& read) { return read_numbers(type, space, read); };
constexpr auto as_texts = [](hid_t type, hid_t space, auto&& read) { return read_texts(type, space, read); };

std::string optional_text(hid_t object, const std::string& name) {
  const auto texts = read_attribute(object, name, as_texts);
  return texts && !texts->empty() ? texts->front() : "";
}

constexpr std::size_t most_groups = 1000000;  // more come from a link that leads back to its own group

std::string member(const std::string& group, const std::string& name) { return group.ends_with('/') ? group + name : group + "/" + name; }

}  // namespace

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  start_library();
  H5get_libversion(&major, &minor, &release);
  return fmt::format("HDF5 {}.{}.{}", major, minor, release);
}

ResultReader::ResultReader(const fs::path& path) : path_(path), file_(std::make_unique<HdfHandle>(open_file(path), H5Fclose)) {}
ResultReader::~ResultReader() = default;
ResultReader::ResultReader(ResultReader&&) noexcept = default;
ResultReader& ResultReader::operator=(ResultReader&&) noexcept = default;

std::vector<std::string> ResultReader::tables() const {
  std::vector<std::string> found = groups();
  std::erase_if(found, [&](const std::string& group) { return column_names(group).empty(); });
  return found;
}

std::vector<std::string> ResultReader::groups() const {
  std::vector<std::string> found, open{"/"};
  while (!open.empty()) {
    const std::string group = open.back();
    open.pop_back();
    found.push_back(group);
    const std::vector<std::string> names = children(group);
    for (auto it = names.rbegin(); it != names.rend(); ++it)
      if (const std::string child = member(group, *it); kind_of(*file_, child) == H5I_GROUP) open.push_back(child);
    if (found.size() + open.size() > most_groups) refuse(path_, "has groups without end");  // a link that leads back to its own group
  }
  return found;
}

std::vector<std::string> ResultReader::children(const std::string& group) const {
  if (kind_of(*file_, group) != H5I_GROUP) refuse(path_, fmt::format("has no group {}", group));
  return members(opened(H5Gopen2(*file_, group.c_str(), H5P_DEFAULT), H5Gclose, "opening " + group));
}

std::vector<std::string> ResultReader::names_of(const std::string& group, int dimensions, bool numbers, bool texts) const {
  std::vector<std::string> names;
  for (const std::string& name : children(group)) {
    if (kind_of(*file_, member(group, name)) != H5I_DATASET) continue;
    const DataSet data = open_dataset(*file_, member(group, name));
    const Content content = content_of(data.type);
    const bool wanted = content == Content::numbers ? numbers : content != Content::other && texts;
    if (wanted && H5Sget_simple_extent_ndims(data.space) == dimensions) names.push_back(name);
  }
  return names;
}

std::vector<std::string> ResultReader::column_names(const std::string& group) const { return names_of(group, 1, true, true); }
std::vector<std::string> ResultReader::scalar_names(const std::string& group) const { return names_of(group, 0, true, false); }
std::vector<std::string> ResultReader::text_names(const std::string& group) const { return names_of(group, 0, false, true); }

Table ResultReader::table(const std::string& group) const {
  Table table;
  for (const std::string& name : column_names(group)) {
    if (content_of(open_dataset(*file_, member(group, name)).type) == Content::numbers) table.columns.push_back(column(group, name));
    else table.text_columns.push_back(text_column(group, name));
  }
  return table;
}

void read_all(const fs::path& path) {
  const ResultReader reader(path);
  const HdfHandle file(open_file(path), H5Fclose);
  const auto read_attributes = [&](const std::string& object) {
    const HdfHandle handle = open_object(file, object);
    for (const std::string& name : reader.attribute_names(object)) {
      (void)read_attribute(handle, name, as_numbers);
      (void)read_attribute(handle, name, as_texts);
    }
  };
  std::size_t seen = 0;
  for (std::vector<std::string> open{"/"}; !open.empty(); ++seen) {
    if (seen + open.size() > most_groups) refuse(path, "has groups without end");
    const std::string group = open.back();
    open.pop_back();
    read_attributes(group);
    for (const std::string& name : reader.children(group)) {
      const std::string child = member(group, name);
      const H5I_type_t kind = kind_of(file, child);
      if (kind == H5I_BADID) throw std::runtime_error("opening " + child + " failed");
      if (kind == H5I_GROUP) open.push_back(child);
      if (kind != H5I_DATASET) continue;
      read_attributes(child);
      const DataSet data = open_dataset(file, child);
      (void)read_numbers(data.type, data.space, data.reader());
      (void)read_texts(data.type, data.space, data.reader());
    }
  }
}

bool ResultReader::has(const std::string& object) const { return kind_of(*file_, object) != H5I_BADID; }

Column ResultReader::column(const std::string& group, const std::string& name) const {
  const std::string path = member(group, name);
  if (kind_of(*file_, path) != H5I_DATASET) refuse(path_, fmt::format("has no column {}", path));
  const DataSet data = open_dataset(*file_, path);
  auto values = read_numbers(data.type, data.space, data.reader());
  if (!values) refuse(path_, fmt::format("{} is not a column of numbers", path));
  return {name, optional_text(data.set, "units"), optional_text(data.set, "description"), std::move(*values)};
}

TextColumn ResultReader::text_column(const std::string& group, const std::string& name) const {
  const std::string path = member(group, name);
  if (kind_of(*file_, path) != H5I_DATASET) refuse(path_, fmt::format("has no column {}", path));
  const DataSet data = open_dataset(*file_, path);
  auto values = read_texts(data.type, data.space, data.reader());
  if (!values) refuse(path_, fmt::format("{} is not a column of texts", path));
  return {name, optional_text(data.set, "description"), std::move(*values)};
}

Scalar ResultReader::scalar(const std::string& group, const std::string& name) const {
  const Column c = column(group, name);
  if (c.values.size() != 1) refuse(path_, fmt::format("{} is not a scalar", member(group, name)));
  return {c.values[0], c.unit, c.description};
}

std::string ResultReader::text(const std::string& group, const std::string& name) const {
  const TextColumn c = text_column(group, name);
  if (c.values.size() != 1) refuse(path_, fmt::format("{} is not a single text", member(group, name)));
  return c.values[0];
}

std::vector<std::string> ResultReader::attribute_names(const std::string& object) const {
  if (!has(object)) refuse(path_, fmt::format("has no {}", object));
  const HdfHandle opened_object = open_object(*file_, object);
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5A_info_t*, void* into) -> herr_t {
    static_cast<std::vector<std::string>*>(into)->emplace_back(name);
    return 0;
  };
  done(H5Aiterate2(opened_object, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names), "listing");
  return names;
}

std::vector<double> ResultReader::numbers_attribute(const std::string& object, const std::string& name) const {
  if (!has(object)) refuse(path_, fmt::format("has no {}", object));
  const auto values = read_attribute(open_object(*file_, object), name, as_numbers);
  if (!values) refuse(path_, fmt::format("{} has no attribute {} of numbers", object, name));
  return *values;
}

std::vector<std::string> ResultReader::texts_attribute(const std::string& object, const std::string& name) const {
  if (!has(object)) refuse(path_, fmt::format("has no {}", object));
  const auto values = read_attribute(open_object(*file_, object), name, as_texts);
  if (!values) refuse(path_, fmt::format("{} has no attribute {} of texts", object, name));
  return *values;
}

bool ResultReader::holds_numbers(const std::string& object, const std::string& attribute) const {
  return has(object) && read_attribute(open_object(*file_, object), attribute, as_numbers).has_value();
}

double ResultReader::number_attribute(const std::string& object, const std::string& name) const {
  const auto values = numbers_attribute(object, name);
  if (values.size() != 1) refuse(path_, fmt::format("attribute {} of {} is not a single number", name, object));
  return values[0];
}

std::string ResultReader::text_attribute(const std::string& object, const std::string& name) const {
  const auto values = texts_attribute(object, name);
  if (values.size() != 1) refuse(path_, fmt::format("attribute {} of {} is not a single text", name, object));
  return values[0];
}

}  // namespace whirl::studies
