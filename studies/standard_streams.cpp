#include "studies/standard_streams.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>

namespace whirl::studies {
namespace {

std::atomic<int> output_error{0};

/// Writes all, or remembers why not; either way all counts as written, for a stream in error throws in the middle of a run.
ssize_t write_all(int descriptor, const char* data, std::size_t size, std::atomic<int>* error) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t n = ::write(descriptor, data + done, size - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      if (error) *error = n < 0 ? errno : ENOSPC;
      break;
    }
    done += static_cast<std::size_t>(n);
  }
  return static_cast<ssize_t>(size);
}

ssize_t write_output(void*, const char* data, std::size_t size) { return write_all(STDOUT_FILENO, data, size, &output_error); }
ssize_t write_error(void*, const char* data, std::size_t size) { return write_all(STDERR_FILENO, data, size, nullptr); }

FILE* stream(cookie_write_function_t* write) {
  cookie_io_functions_t functions{};
  functions.write = write;
  return ::fopencookie(nullptr, "w", functions);
}

void open_missing_descriptors() {
  int fd = ::open("/dev/null", O_RDWR);
  while (fd >= 0 && fd <= STDERR_FILENO) fd = ::open("/dev/null", O_RDWR);
  if (fd >= 0) ::close(fd);
}

}  // namespace

void secure_standard_streams() {
  open_missing_descriptors();
  std::signal(SIGPIPE, SIG_IGN);
  if (FILE* out = stream(write_output)) {
    std::setvbuf(out, nullptr, ::isatty(STDOUT_FILENO) != 0 ? _IOLBF : _IOFBF, BUFSIZ);
    stdout = out;
  }
  if (FILE* err = stream(write_error)) {
    std::setvbuf(err, nullptr, _IONBF, 0);
    stderr = err;
  }
}

std::optional<std::string> lost_output() {
  std::fflush(stdout);
  int error = output_error;
  errno = 0;
  if (error == 0 && !std::cout.flush()) error = errno != 0 ? errno : EIO;  // which has a stream of its own
  if (error == 0 || error == EPIPE) return std::nullopt;
  return fmt::format("standard output is incomplete: {}", std::strerror(error));
}

}  // namespace whirl::studies
