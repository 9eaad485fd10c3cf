#include "studies/append_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "studies/configuration.hpp"
#include "studies/hdf5_format.hpp"

namespace whirl::studies {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t reserve = 32768;           // a group of settings and its texts: a few times what the largest study kind needs
constexpr std::size_t most_in_memory = 1 << 23;  // of what is not committed
constexpr std::uint64_t alignment = 8;
constexpr int most_links = 40;  // as the kernel follows

[[noreturn]] void refuse(const fs::path& path, std::string_view why) { throw InputError(fmt::format("{}: {}", path.string(), why)); }

/// Where a path leads through symbolic links, the last of which may lead to nothing yet.
fs::path followed(fs::path path) {
  std::error_code failure;
  for (int i = 0; i < most_links && fs::is_symlink(path, failure); ++i) {
    const fs::path to = fs::read_symlink(path, failure);
    path = to.is_absolute() ? to : path.parent_path() / to;
  }
  return path;
}

fs::path unfinished_name(const fs::path& target) { return target.string() + ".unfinished"; }

// Locks of our own are of the kind that belongs to an open file: those of the HDF5 library (flock) are others, so a result can be read while it
// grows.
struct flock whole_file() {
  struct flock f {};
  f.l_type = F_WRLCK;
  f.l_whence = SEEK_SET;
  return f;
}

bool is_written_by_a_run(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return false;
  struct flock wanted = whole_file();
  const bool locked = ::fcntl(fd, F_OFD_GETLK, &wanted) == 0 && wanted.l_type != F_UNLCK;
  ::close(fd);
  return locked;
}

bool is_open_in_hdf5(const fs::path& path, int wanted) {  // which holds an exclusive lock on a file it writes, a shared one on a file it reads
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return false;
  const bool locked = ::flock(fd, wanted | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(fd);
  return locked;
}

void check_folder(const fs::path& path, const fs::path& target) {
  std::error_code ignored;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::exists(folder, ignored)) refuse(path, fmt::format("folder {} does not exist", folder.string()));
  if (!fs::is_directory(folder, ignored)) refuse(path, fmt::format("{} is not a folder", folder.string()));
  if (::access(folder.c_str(), W_OK | X_OK) != 0) refuse(path, fmt::format("folder {} is not writable", folder.string()));
}

void check_target(const fs::path& path, const fs::path& target) {
  std::error_code ignored;
  if (fs::is_directory(target, ignored)) refuse(path, "is a directory, not a result file");
  if (!fs::exists(target, ignored)) return;
  if (!fs::is_regular_file(target, ignored)) refuse(path, "is not a regular file");
  if (::access(target.c_str(), W_OK) != 0) refuse(path, "is not writable");
  if (is_written_by_a_run(target) || is_open_in_hdf5(target, LOCK_SH)) refuse(path, "is being written by another program");
  if (is_open_in_hdf5(target, LOCK_EX)) refuse(path, "is open in another program");
}

}  // namespace

void AppendFile::check(const fs::path& path) {
  if (path.empty()) throw InputError("the result file has no name");
  const fs::path target = followed(path), unfinished = unfinished_name(target);
  check_target(path, target);
  check_folder(path, target);
  std::error_code ignored;
  const auto there = fs::symlink_status(unfinished, ignored).type();
  if (there != fs::file_type::not_found && there != fs::file_type::regular)
    refuse(path, fmt::format("cannot be created: {} stands in the way", unfinished.string()));
  if (is_written_by_a_run(unfinished)) refuse(path, "is being written by another program");
}

AppendFile::AppendFile(const fs::path& path) : path_(path), target_(followed(path)), unfinished_(unfinished_name(target_)) {
  check(path);
  open();
  try {
    check_target(path, target_);  // a run that published in between
    struct stat old {};
    replaces_ = ::stat(target_.c_str(), &old) == 0;
    if (replaces_) ::fchmod(descriptor_, old.st_mode & 07777);
    if (::ftruncate(descriptor_, 0) != 0) fail("writing", errno);
    written_ = hdf5_format::superblock_size + reserve;
    write(0, std::string(written_, '\0'));
  } catch (...) {
    ::unlink(unfinished_.c_str());
    ::close(descriptor_);
    throw;
  }
}

void AppendFile::open() {
  for (;;) {
    descriptor_ = ::open(unfinished_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor_ < 0) refuse(path_, fmt::format("cannot be created: {}", std::strerror(errno)));
    const bool locked = lock();
    struct stat mine {
    }, named{};
    const bool same = ::fstat(descriptor_, &mine) == 0 && ::stat(unfinished_.c_str(), &named) == 0 && mine.st_ino == named.st_ino;
    if (locked && same) return;
    ::close(descriptor_);
    if (!locked) refuse(path_, "is being written by another program");
    // Published by its run between our opening and our lock: not ours to touch.
  }
}

bool AppendFile::lock() {
  struct flock wanted = whole_file();
  return ::fcntl(descriptor_, F_OFD_SETLK, &wanted) == 0 || (errno != EAGAIN && errno != EACCES);  // a file system without locks does not stop us
}

AppendFile::~AppendFile() {
  if (!published_) ::unlink(unfinished_.c_str());
  ::close(descriptor_);
}

void AppendFile::fail(const char* what, int error) const {
  throw std::runtime_error(fmt::format("{}: {} failed: {}", path_.string(), what, std::strerror(error)));
}

void AppendFile::write(std::uint64_t address, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(address));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("writing", n < 0 ? errno : ENOSPC);
    bytes.remove_prefix(static_cast<std::size_t>(n));
    address += static_cast<std::uint64_t>(n);
  }
}

std::uint64_t AppendFile::append(std::string_view bytes) {
  const std::uint64_t address = written_ + buffer_.size();
  buffer_ += bytes;
  buffer_.resize((buffer_.size() + alignment - 1) / alignment * alignment);
  if (buffer_.size() > most_in_memory) spill();
  return address;
}

std::uint64_t AppendFile::allocate(std::size_t bytes) { return append(std::string(bytes, '\0')); }

void AppendFile::fill(std::uint64_t address, std::string_view bytes) {
  if (address >= written_) buffer_.replace(address - written_, bytes.size(), bytes);
  else write(address, bytes);
}

void AppendFile::spill() {
  write(written_, buffer_);
  written_ += buffer_.size();
  buffer_.clear();
}

void AppendFile::commit(std::uint64_t root) {
  if (in_reserve_ && written_ + buffer_.size() > hdf5_format::superblock_size + reserve) fail("writing", ENOSPC);
  spill();
  write(0, hdf5_format::superblock(in_reserve_ ? committed_ : written_, root));
  if (!in_reserve_) committed_ = written_;
}

void AppendFile::roll_back_to_reserve() {
  buffer_.clear();
  if (committed_ == 0) committed_ = hdf5_format::superblock_size + reserve;
  [[maybe_unused]] const int freed = ::ftruncate(descriptor_, static_cast<off_t>(committed_));  // what stays is unused
  written_ = hdf5_format::superblock_size;
  in_reserve_ = true;
}

void AppendFile::publish() {
  if (published_) return;
  synchronize();
  if (::rename(unfinished_.c_str(), target_.c_str()) != 0) fail("renaming the finished file", errno);
  published_ = true;
}

void AppendFile::synchronize() {
  if (::fdatasync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail("writing", errno);
}

}  // namespace whirl::studies
