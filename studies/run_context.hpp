#pragma once
/// What every study run shares: where it prints, whether Ctrl-C was pressed, how far it is, which warnings it collected.

#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "studies/json.hpp"

namespace whirl::studies {

/// Set by the SIGINT handler; long loops look at it.
extern std::atomic<bool> interrupted;
void catch_interrupts();

/// One line on a terminal, rewritten in place; nothing in a pipe. Callable from several threads.
class Progress {
 public:
  Progress();
  ~Progress() { clear(); }
  void show(const std::string& text);
  void clear();

 private:
  bool terminal_;
  std::mutex guard_;
  std::size_t width_ = 0;
  std::chrono::steady_clock::time_point last_{};
};

enum class ExitStatus { ok = 0, numerical_failure = 1, bad_input = 2, stopped_by_user = 130 };

struct RunContext {
  std::filesystem::path output;  ///< result file
  bool json = false;             ///< the report as JSON on standard output; tables go to standard error then
  bool quiet = false;            ///< no tables
  Progress progress;
  std::vector<std::string> warnings;  ///< printed, and written into the result file
  Json report = Json::object();       ///< what `--json` prints once the run is over
  void warn(const std::string& text);
  void print(const std::string& table);  ///< on standard output, unless quiet
};

std::string version_text();  ///< "whirl 0.1.0 (abcdef0), SUNDIALS 6.4.1, ..."
std::string git_hash();
std::vector<std::string> library_versions();

}  // namespace whirl::studies
