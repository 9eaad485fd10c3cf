#pragma once
/// A file that grows by parts that are never changed, beside the place where it will stand, until what it holds is worth to replace what stands
/// there.
///
/// `path.unfinished` is written first. `commit` writes what was appended and then, in one write of 48 bytes, the superblock that makes it valid:
/// whoever opens the file at any instant finds the state of one commit or of the next. `publish` renames it to `path` (a symbolic link stays, its
/// target is replaced); it is written further there. While it is open no other AppendFile can have the same path. What is not published goes away
/// with the object; what a killed run leaves is taken over by the next one.
///
/// A write that fails (disk full) throws std::runtime_error; the state of the last commit stays valid. `reserve` bytes are kept for a last word after
/// that.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace whirl::studies {

class AppendFile {
 public:
  /// Throws InputError if the place cannot be written or is in use.
  explicit AppendFile(const std::filesystem::path& path);
  ~AppendFile();
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;

  /// Throws the InputError the constructor would throw, but leaves the place as it is.
  static void check(const std::filesystem::path& path);

  std::uint64_t append(std::string_view bytes);  ///< its address, a multiple of 8
  std::uint64_t allocate(std::size_t bytes);     ///< the same with zeros
  /// Fills a part that no committed state refers to.
  void fill(std::uint64_t address, std::string_view bytes);
  void commit(std::uint64_t root);
  /// Drops what was appended since the last commit and appends to the reserve from now on.
  void roll_back_to_reserve();
  void publish();
  void synchronize();  ///< down to the disk: a power cut keeps it
  bool published() const { return published_; }
  bool replaces() const { return replaces_; }  ///< something stood at the path when it was opened

 private:
  void open();
  bool lock();
  void write(std::uint64_t address, std::string_view bytes);
  void spill();
  [[noreturn]] void fail(const char* what, int error) const;

  std::filesystem::path path_, target_, unfinished_;
  int descriptor_ = -1;
  bool published_ = false, replaces_ = false, in_reserve_ = false;
  std::uint64_t written_ = 0;    ///< bytes of the file
  std::uint64_t committed_ = 0;  ///< of them valid
  std::string buffer_;           ///< what follows them
};

}  // namespace whirl::studies
