#include "studies/run_context.hpp"

#include <fmt/format.h>
#include <semaphore.h>
#include <unistd.h>

#include <Eigen/Core>
#include <boost/version.hpp>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <system_error>
#include <thread>

#include "core/kinsol.hpp"
#include "studies/interruption.hpp"
#include "studies/open_results.hpp"

namespace whirl::studies {

std::atomic<bool> interrupted{false};

namespace {

constexpr std::int64_t second_press_ms = 500;  ///< two signals at once are one: `timeout -s INT` sends one to the program and one to its group
constexpr std::int64_t patience_ms = 700;      ///< for a run to end by itself after the first

std::atomic<std::int64_t> first_interrupt_ms{0};
static_assert(std::atomic<std::int64_t>::is_always_lock_free);  // the handler may touch nothing else, but post a semaphore
std::atomic<bool> ending{false};
sem_t pressed;

std::int64_t milliseconds_now() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t(now.tv_sec) * 1000 + now.tv_nsec / 1000000;
}

// A second Ctrl-C does not wait.
void on_interrupt(int) {
  const std::int64_t now = milliseconds_now();
  std::int64_t first = 0;
  if (!first_interrupt_ms.compare_exchange_strong(first, now) && now - first > second_press_ms)
    std::_Exit(static_cast<int>(ExitStatus::stopped_by_user));
  interrupted = true;
  sem_post(&pressed);
}

/// Ends a run that does not end by itself: its file holds all that was finished.
void stand_by(bool quiet) {
  while (sem_wait(&pressed) != 0) continue;
  while (ending || milliseconds_now() - first_interrupt_ms < patience_ms) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const auto results = end_interrupted_runs();
  if (!quiet) {
    if (results.empty()) fmt::print(stderr, "interrupted before a first result\n");
    for (const auto& path : results) fmt::print(stderr, "interrupted; result: {}\n", path.string());
  }
  std::_Exit(static_cast<int>(ExitStatus::stopped_by_user));
}

}  // namespace

void catch_interrupts_of_run(bool quiet) {
  sem_init(&pressed, 0, 0);
  try {
    std::thread(stand_by, quiet).detach();
  } catch (const std::system_error&) {  // no thread to be had: the loops that look at `interrupted` are what is left
  }
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  if (std::signal(SIGHUP, on_interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
}

void catch_interrupts() { catch_interrupts_of_run(false); }

void end_begins() { ending = true; }

Progress::Progress() : terminal_(isatty(STDERR_FILENO) != 0) {}

void Progress::show(const std::string& text) {
  if (!terminal_) return;
  const std::lock_guard lock(guard_);
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  fmt::print(stderr, "\r{:<{}}", text, width_);
  std::fflush(stderr);
  width_ = text.size();
}

void Progress::clear() {
  if (!terminal_ || width_ == 0) return;
  const std::lock_guard lock(guard_);
  fmt::print(stderr, "\r{:<{}}\r", "", width_);
  std::fflush(stderr);
  width_ = 0;
}

void RunContext::warn(const std::string& text) {
  progress.clear();
  fmt::print(stderr, "warning: {}\n", text);
  warnings.push_back(text);
}

void RunContext::print(const std::string& table) {
  if (quiet) return;
  progress.clear();
  std::FILE* const to = json ? stderr : stdout;
  fmt::print(to, "{}", table);
  std::fflush(to);  // a reader at the other end of a pipe waits for it
}

std::string git_hash() { return WHIRL_GIT_HASH; }

std::vector<std::string> library_versions() {
  return {fmt::format("Eigen {}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION),
          fmt::format("SUNDIALS {}", sundials_version()),
          fmt::format("Boost {}.{}.{}", BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100), hdf5_version()};
}

std::string version_text() {
  std::string text = fmt::format("whirl {} ({})", WHIRL_VERSION, git_hash());
  for (const auto& library : library_versions()) text += ", " + library;
  return text;
}

}  // namespace whirl::studies
