#include "studies/apart.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <exception>

#include "studies/configuration.hpp"

namespace whirl::studies {
namespace {

namespace fs = std::filesystem;

constexpr rlim_t least_seconds = 20;
constexpr std::uintmax_t bytes_per_second = 1000000;  // of processor time, a tenth of what the slowest reading of a good file does

enum Ended : int { done = 0, refused = 2, failed = 3 };

void limit_time(const fs::path& file) {
  std::error_code ignored;
  const std::uintmax_t size = fs::file_size(file, ignored);
  const rlim_t seconds = least_seconds + (ignored ? 0 : size / bytes_per_second);
  const rlimit limit{seconds, seconds};
  ::setrlimit(RLIMIT_CPU, &limit);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
}

void send(int pipe, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(pipe, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
}

std::string receive(int pipe) {
  std::string all;
  char part[4096];
  for (;;) {
    const ssize_t n = ::read(pipe, part, sizeof part);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return all;
    all.append(part, static_cast<std::size_t>(n));
  }
}

[[noreturn]] void work_and_leave(int pipe, const std::function<std::vector<std::string>()>& work) {
  try {
    for (const std::string& line : work()) send(pipe, line + '\0');
    ::_exit(done);
  } catch (const InputError& e) {
    send(pipe, e.what());
    ::_exit(refused);
  } catch (const std::exception&) {
    ::_exit(failed);
  }
}

}  // namespace

std::vector<std::string> in_process_of_its_own(const fs::path& file, const std::function<std::vector<std::string>()>& work) {
  int ends[2];
  if (::pipe(ends) != 0) return work();
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) {  // no process to be had
    ::close(ends[0]);
    ::close(ends[1]);
    return work();
  }
  if (child == 0) {
    ::close(ends[0]);
    limit_time(file);
    work_and_leave(ends[1], work);
  }
  ::close(ends[1]);
  const std::string text = receive(ends[0]);
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (WIFEXITED(status) && WEXITSTATUS(status) == refused) throw InputError(text);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != done) throw InputError(fmt::format("{}: is damaged", file.string()));
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\0', begin);
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

}  // namespace whirl::studies
