#include "studies/result_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "studies/configuration.hpp"

namespace whirl::studies {

class HdfHandle {
 public:
  using Close = herr_t (*)(hid_t);
  HdfHandle(hid_t id, Close close) : id_(id), close_(close) {}
  HdfHandle(HdfHandle&& other) noexcept : id_(std::exchange(other.id_, hid_t{-1})), close_(other.close_) {}
  HdfHandle& operator=(HdfHandle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~HdfHandle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  void abandon() { id_ = -1; }  ///< not closed, ever

 private:
  hid_t id_;
  Close close_;
};

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

/// No messages of the library's own, and no closing of files at exit: it crashes there after a write that failed. Handles close what they opened.
void start_library() {
  [[maybe_unused]] static const herr_t once = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

HdfHandle text_type() {
  HdfHandle type = opened(H5Tcopy(H5T_C_S1), H5Tclose, "string type");
  done(H5Tset_size(type, H5T_VARIABLE), "string type");
  done(H5Tset_cset(type, H5T_CSET_UTF8), "string type");
  return type;
}

HdfHandle space_of(std::optional<std::size_t> size) {  // scalar without a size
  const hsize_t n = size.value_or(0);
  return opened(size ? H5Screate_simple(1, &n, nullptr) : H5Screate(H5S_SCALAR), H5Sclose, "dataspace");
}

std::vector<const char*> pointers(const std::vector<std::string>& texts) {
  std::vector<const char*> p;
  for (const std::string& t : texts) p.push_back(t.c_str());
  return p;
}

HdfHandle open_object(hid_t file, const std::string& name) { return opened(H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose, "opening " + name); }

/// Opens a group, creates it and its parents if missing; new groups remember the order of their members.
HdfHandle ensure_group(hid_t file, const std::string& path) {
  HdfHandle current = opened(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "opening /");
  const HdfHandle creation = opened(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "group properties");
  done(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED), "group properties");
  for (std::size_t begin = 0; begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string part = path.substr(begin, end - begin);
    begin = end + 1;
    if (part.empty()) continue;
    const bool exists = H5Lexists(current, part.c_str(), H5P_DEFAULT) > 0;
    const hid_t id = exists ? H5Gopen2(current, part.c_str(), H5P_DEFAULT) : H5Gcreate2(current, part.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT);
    current = opened(id, H5Gclose, "group " + path);
  }
  return current;
}

void write_attribute(hid_t object, const std::string& name, hid_t type, std::optional<std::size_t> size, const void* data) {
  if (H5Aexists(object, name.c_str()) > 0) done(H5Adelete(object, name.c_str()), "attribute " + name);
  const HdfHandle space = space_of(size);
  const HdfHandle attribute = opened(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "attribute " + name);
  if (size != std::size_t{0}) done(H5Awrite(attribute, type, data), "attribute " + name);
}

void write_text_attribute(hid_t object, const std::string& name, const std::string& value) {
  const char* p = value.c_str();
  write_attribute(object, name, text_type(), std::nullopt, &p);
}

struct Meaning {
  std::optional<std::string> unit;
  std::string description;
};

void write_dataset(hid_t group, const std::string& name, hid_t type, std::optional<std::size_t> size, const void* data, const Meaning& meaning) {
  if (name.empty() || name.find('/') != std::string::npos) throw std::invalid_argument(fmt::format("\"{}\" cannot name a dataset", name));
  if (H5Lexists(group, name.c_str(), H5P_DEFAULT) > 0) {
    // The space set free may be used at once: the file on disk must not refer to it any more.
    done(H5Ldelete(group, name.c_str(), H5P_DEFAULT), "replacing " + name);
    done(H5Fflush(group, H5F_SCOPE_GLOBAL), "flush");
  }
  const HdfHandle space = space_of(size);
  const HdfHandle set = opened(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose, "writing " + name);
  if (size != std::size_t{0}) done(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "writing " + name);
  if (meaning.unit) write_text_attribute(set, "units", *meaning.unit);
  write_text_attribute(set, "description", meaning.description);
}

/// Keeps the file's structure in memory until it is flushed, so that the disk always holds one consistent state.
void hold_metadata(hid_t access) {
  H5AC_cache_config_t config;
  config.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  done(H5Pget_mdc_config(access, &config), "cache settings");
  config.evictions_enabled = false;
  config.incr_mode = H5C_incr__off;
  config.flash_incr_mode = H5C_flash_incr__off;
  config.decr_mode = H5C_decr__off;
  done(H5Pset_mdc_config(access, &config), "cache settings");
}

[[noreturn]] void refuse(const fs::path& path, std::string_view why) { throw InputError(fmt::format("{}: {}", path.string(), why)); }

bool is_locked(const fs::path& path, int wanted) {  // HDF5 holds an exclusive lock on a file it writes, a shared one on a file it reads
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool locked = ::flock(fd, wanted | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(fd);
  return locked;
}

hid_t create_file(const fs::path& path) {
  start_library();
  const HdfHandle creation = opened(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "file properties");
  done(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED), "file properties");
  const HdfHandle access = opened(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file properties");
  hold_metadata(access);
  done(H5Pset_sieve_buf_size(access, 0), "file properties");  // a full disk shows where data are written, not where they are closed
  const hid_t id = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access);
  if (id < 0) refuse(path, "cannot be created");
  return id;
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

DataSet open_dataset(hid_t file, const std::string& path) {
  HdfHandle set = opened(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "opening " + path);
  HdfHandle type = opened(H5Dget_type(set), H5Tclose, "reading " + path), space = opened(H5Dget_space(set), H5Sclose, "reading " + path);
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

std::string member(const std::string& group, const std::string& name) { return group.ends_with('/') ? group + name : group + "/" + name; }

}  // namespace

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("HDF5 {}.{}.{}", major, minor, release);
}

ResultFile::ResultFile(const fs::path& path) : path_(path) {
  check_writable(path);
  file_ = std::make_unique<HdfHandle>(create_file(path), H5Fclose);
}
ResultFile::~ResultFile() = default;
ResultFile::ResultFile(ResultFile&&) noexcept = default;
ResultFile& ResultFile::operator=(ResultFile&&) noexcept = default;

void ResultFile::check_writable(const fs::path& path) {
  std::error_code ignored;
  if (path.empty()) throw InputError("the result file has no name");
  if (fs::is_directory(path, ignored)) refuse(path, "is a directory, not a result file");
  if (fs::exists(path, ignored)) {
    if (!fs::is_regular_file(path, ignored)) refuse(path, "is not a regular file");
    if (::access(path.c_str(), W_OK) != 0) refuse(path, "is not writable");
    if (is_locked(path, LOCK_SH)) refuse(path, "is being written by another program");
    if (is_locked(path, LOCK_EX)) refuse(path, "is open in another program");
    return;
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::exists(folder, ignored)) refuse(path, fmt::format("folder {} does not exist", folder.string()));
  if (!fs::is_directory(folder, ignored)) refuse(path, fmt::format("{} is not a folder", folder.string()));
  if (::access(folder.c_str(), W_OK | X_OK) != 0) refuse(path, fmt::format("folder {} is not writable", folder.string()));
}

void ResultFile::mark_failed(const fs::path& path, const std::string& reason) noexcept try {
  start_library();
  std::error_code ignored;
  if (!fs::exists(path, ignored) || H5Fis_hdf5(path.c_str()) <= 0) return;
  if (ResultReader(path).text_attribute("/study", "outcome") != unfinished) return;
  const HdfHandle file = opened(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, path.string());
  const auto study = ensure_group(file, "/study");
  write_text_attribute(study, "outcome", "failed");
  write_text_attribute(study, "stop_reasons", reason);
} catch (const std::exception&) {  // a file of another kind, or one that a full disk left open: what failed first is what is told
}

/// Writes; after a failure (disk full) the file is let go as it is, for closing it would write half of its structure over the last flushed state.
template <class Write>
void ResultFile::attempt(Write&& write) {
  try {
    write(static_cast<hid_t>(*file_));
  } catch (const std::runtime_error& e) {
    file_->abandon();
    throw std::runtime_error(fmt::format("{}: {}", path_.string(), e.what()));
  }
}

void ResultFile::attribute(const std::string& group, const std::string& name, double value) {
  attempt([&](hid_t file) { write_attribute(ensure_group(file, group), name, H5T_NATIVE_DOUBLE, std::nullopt, &value); });
}
void ResultFile::attribute(const std::string& group, const std::string& name, const std::string& value) {
  attempt([&](hid_t file) { write_text_attribute(ensure_group(file, group), name, value); });
}
void ResultFile::attribute(const std::string& group, const std::string& name, const std::vector<double>& values) {
  attempt([&](hid_t file) { write_attribute(ensure_group(file, group), name, H5T_NATIVE_DOUBLE, values.size(), values.data()); });
}
void ResultFile::attribute(const std::string& group, const std::string& name, const std::vector<std::string>& values) {
  attempt([&](hid_t file) { write_attribute(ensure_group(file, group), name, text_type(), values.size(), pointers(values).data()); });
}

void ResultFile::scalar(const std::string& group, const std::string& name, double value, const std::string& unit, const std::string& description) {
  attempt([&](hid_t file) { write_dataset(ensure_group(file, group), name, H5T_NATIVE_DOUBLE, std::nullopt, &value, {unit, description}); });
}

void ResultFile::text(const std::string& group, const std::string& name, const std::string& value) {
  const char* p = value.c_str();
  attempt([&](hid_t file) { write_dataset(ensure_group(file, group), name, text_type(), std::nullopt, &p, {std::nullopt, ""}); });
}

void ResultFile::table(const std::string& group, const std::vector<Column>& columns, const std::vector<TextColumn>& text_columns) {
  const std::size_t rows = !columns.empty() ? columns[0].values.size() : !text_columns.empty() ? text_columns[0].values.size() : 0;
  const auto same = [&](const auto& column) { return column.values.size() == rows; };
  if (!std::all_of(columns.begin(), columns.end(), same) || !std::all_of(text_columns.begin(), text_columns.end(), same))
    throw std::invalid_argument(fmt::format("table {}: columns of unequal length", group));
  std::set<std::string> names;  // a second column of a name would replace the first without a word
  const auto fresh = [&](const auto& column) { return names.insert(column.name).second; };
  if (!std::all_of(columns.begin(), columns.end(), fresh) || !std::all_of(text_columns.begin(), text_columns.end(), fresh))
    throw std::invalid_argument(fmt::format("table {}: two columns of one name", group));
  attempt([&](hid_t file) {
    const HdfHandle into = ensure_group(file, group), type = text_type();
    for (const Column& c : columns) write_dataset(into, c.name, H5T_NATIVE_DOUBLE, rows, c.values.data(), {c.unit, c.description});
    for (const TextColumn& c : text_columns) write_dataset(into, c.name, type, rows, pointers(c.values).data(), {std::nullopt, c.description});
  });
}

void ResultFile::flush() {
  attempt([](hid_t file) { done(H5Fflush(file, H5F_SCOPE_GLOBAL), "writing"); });
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
    if (found.size() + open.size() > 1000000) refuse(path_, "has groups without end");  // a link that leads back to its own group
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
