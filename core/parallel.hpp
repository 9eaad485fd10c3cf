#pragma once
/// Independent jobs on all cores: results do not depend on which thread took which.
///
///     parallel_for(runs.size(), [&](std::size_t i) { runs[i].motion = integrate(runs[i]); });

#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace whirl {

/// Calls f(0) ... f(count - 1); the first exception thrown is rethrown here when all threads have stopped.
template <class F>
void parallel_for(std::size_t count, F&& f, unsigned threads = std::thread::hardware_concurrency()) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr thrown;
  std::mutex guard;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) try {
        f(i);
      } catch (...) {
        const std::lock_guard lock(guard);
        if (!thrown) thrown = std::current_exception();
        next = count;
      }
  };
  {
    std::vector<std::jthread> pool;
    try {
      for (std::size_t i = 1; i < std::min<std::size_t>(count, threads > 0 ? threads : 1); ++i) pool.emplace_back(work);
    } catch (const std::system_error&) {  // no further thread to be had: those there do all
    }
    work();
  }
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace whirl
