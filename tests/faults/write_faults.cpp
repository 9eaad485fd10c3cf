/// Preloaded into the program: ends it, or fills the disk, at a chosen change of a file.
///
///     WHIRL_FAULT=before|half|after|full|count WHIRL_FAULT_AT=17 WHIRL_FAULT_LOG=log LD_PRELOAD=libwhirl_write_faults.so whirl run ...
///
/// Changes are counted from 1: writes at a place in a file, renaming, truncating, flushing to the disk. `before`, `half` and `after` kill around the
/// chosen one; `full` lets no file grow from it on. The log gets "changes commits refused renames" at the end or at the kill: a commit is a write of
/// 48 bytes at 0, refused are writes that found the disk full.

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

constexpr size_t whole_writes = 512;  // what the kernel copies in one piece: a kill comes before or after

std::atomic<long> changes{0}, commits{0}, refused{0}, renames{0};

const char* setting(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}
bool mode(const char* name) { return std::strcmp(setting("WHIRL_FAULT"), name) == 0; }
long chosen() { return std::atol(setting("WHIRL_FAULT_AT")); }

void write_log() {
  const int fd = ::open(setting("WHIRL_FAULT_LOG"), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (fd < 0) return;
  char text[96];
  const int n = std::snprintf(text, sizeof text, "%ld %ld %ld %ld\n", changes.load(), commits.load(), refused.load(), renames.load());
  (void)!::write(fd, text, static_cast<size_t>(n));
  ::close(fd);
}

void kill_now() {
  write_log();
  ::raise(SIGKILL);
}

template <class F>
F next(const char* name) {
  return reinterpret_cast<F>(::dlsym(RTLD_NEXT, name));
}

/// Any change but a write.
template <class F>
int change(F&& f) {
  const long now = ++changes;
  if (now == chosen() && (mode("before") || mode("half"))) kill_now();
  const int result = f();
  if (now == chosen() && mode("after")) kill_now();
  return result;
}

ssize_t change_write(int fd, const void* data, size_t size, off_t at) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t, off_t)>("pwrite");
  const long now = ++changes;
  if (now == chosen() && mode("before")) kill_now();
  if (now == chosen() && mode("half")) {
    if (size > whole_writes) (void)!real(fd, data, size / 2, at);
    kill_now();
  }
  if (now >= chosen() && mode("full")) {
    struct stat s {};
    ::fstat(fd, &s);
    if (at >= s.st_size) {
      ++refused;
      errno = ENOSPC;
      return -1;
    }
    size = std::min(size, static_cast<size_t>(s.st_size - at));
  }
  const ssize_t n = real(fd, data, size, at);
  if (at == 0 && size == 48 && n == 48) ++commits;
  if (now == chosen() && mode("after")) kill_now();
  return n;
}

[[gnu::destructor]] void tell() {
  if (mode("count") || mode("full")) write_log();
}

}  // namespace

extern "C" {
ssize_t pwrite(int fd, const void* data, size_t size, off_t at) { return change_write(fd, data, size, at); }
ssize_t pwrite64(int fd, const void* data, size_t size, off_t at) { return change_write(fd, data, size, at); }
int rename(const char* from, const char* to) noexcept {
  return change([&] {
    const int result = next<int (*)(const char*, const char*)>("rename")(from, to);
    if (result == 0) ++renames;
    return result;
  });
}
int ftruncate(int fd, off_t size) noexcept {
  return change([&] { return next<int (*)(int, off_t)>("ftruncate")(fd, size); });
}
int ftruncate64(int fd, off_t size) noexcept { return ftruncate(fd, size); }
int fdatasync(int fd) {
  return change([&] { return next<int (*)(int)>("fdatasync")(fd); });
}
}
