#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// Programs run as child processes, each with its log.
namespace flowrest::runs {

/// Where a program lies on the PATH; nothing where it is not.
std::optional<std::filesystem::path> find_program(const std::string& name);

/// How a process ended.
struct ProcessEnd {
  int exit_code = 0;   ///< where no signal ended it
  int signal = 0;      ///< 0 where it exited by itself
  double cpu_s = 0.0;  ///< of the process and the children it waited for
  bool good() const { return signal == 0 && exit_code == 0; }
  /// "exit code 1" or "signal 8 (Floating point exception)"
  std::string how() const;
};

/// A running child. It has a process group of its own, so that Ctrl-C on the terminal reaches only us and we
/// decide how it ends; it is killed when it goes out of scope or when this process dies.
class Process {
 public:
  /// Starts `program` in `directory`, its output and errors going to `log`, `environment` added to ours.
  /// @throws MissingProgram where it cannot be started.
  Process(const std::filesystem::path& program, const std::vector<std::string>& arguments,
          const std::filesystem::path& directory, const std::filesystem::path& log,
          const std::map<std::string, std::string>& environment);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// How it ended, or nothing while it runs.
  std::optional<ProcessEnd> poll();
  /// Waits for its end, at most `seconds`.
  std::optional<ProcessEnd> wait(double seconds);
  /// Sends a signal to it and its children.
  void signal(int number);

 private:
  pid_t pid_ = -1;
  std::optional<ProcessEnd> end_;
};

/// The last line of a log that says something, without our name before it: what a program ended with.
std::string last_words(const std::filesystem::path& log);

/// While it lives, SIGINT and SIGTERM are noted instead of ending this process.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  /// How often it was asked to stop.
  static int count();
};

}  // namespace flowrest::runs
