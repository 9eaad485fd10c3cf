#pragma once
/// The program as a user runs it, in a folder of its own that goes away with the test case.
///
///     const Folder f;
///     const Ran r = program(f, "run my.toml -o r.h5");
///     REQUIRE(r.status == 0);
///     const ResultReader file(f / "r.h5");

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

namespace whirl::studies::tests {

struct Ran {
  int status;  ///< exit status, or 128 + the signal
  std::string out, err;
};

struct Folder {
  static std::filesystem::path fresh() {
    static std::atomic<int> number{0};
    return std::filesystem::temp_directory_path() / ("whirl-test-" + std::to_string(::getpid()) + "-" + std::to_string(++number));
  }
  std::filesystem::path path = fresh();
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path / name; }
};

inline std::string slurp(const std::filesystem::path& p) {
  std::ifstream in(p);
  std::stringstream s;
  s << in.rdbuf();
  return s.str();
}

/// Runs a command in the folder.
inline Ran shell(const Folder& f, const std::string& command) {
  const auto out = f / "out.txt", err = f / "err.txt";
  const int code = std::system(("cd '" + f.path.string() + "' && " + command + " >'" + out.string() + "' 2>'" + err.string() + "'").c_str());
  return {WIFEXITED(code) ? WEXITSTATUS(code) : 128 + WTERMSIG(code), slurp(out), slurp(err)};
}

inline Ran program(const Folder& f, const std::string& arguments, const std::string& before = "") {
  return shell(f, before + WHIRL_PROGRAM + " " + arguments);
}

/// How many times longer the program takes under the sanitizers.
#ifdef __SANITIZE_ADDRESS__
inline constexpr int slower = 20;
#else
inline constexpr int slower = 1;
#endif

/// The program with Ctrl-C pressed `wait` after it has printed `text` (two minutes at most for that), as two signals at once,
/// which is how `timeout` presses it.
inline Ran interrupted_program(const Folder& f, const std::string& arguments, const std::string& text, std::chrono::milliseconds wait) {
  const auto out = f / "out.txt", err = f / "err.txt";
  const std::string command =
      "cd '" + f.path.string() + "' && exec " + WHIRL_PROGRAM + " " + arguments + " >'" + out.string() + "' 2>'" + err.string() + "'";
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    ::_exit(127);
  }
  int code = 0;
  const auto pause = [](std::chrono::milliseconds t) { std::this_thread::sleep_for(t); };
  for (int i = 0; i < 12000 && (slurp(out) + slurp(err)).find(text) == std::string::npos; ++i) {
    if (::waitpid(child, &code, WNOHANG) == child) return {WEXITSTATUS(code), slurp(out), slurp(err)};
    pause(std::chrono::milliseconds(10));
  }
  pause(wait);
  ::kill(child, SIGINT);
  pause(std::chrono::milliseconds(2));
  ::kill(child, SIGINT);
  ::waitpid(child, &code, 0);
  return {WIFEXITED(code) ? WEXITSTATUS(code) : 128 + WTERMSIG(code), slurp(out), slurp(err)};
}

}  // namespace whirl::studies::tests
