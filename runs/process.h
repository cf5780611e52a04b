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
  /// Whether somebody ended it, a scheduler or the system for want of memory, say: by a signal, or as the
  /// shell and mpirun pass one on.
  bool from_outside() const;
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
  /// Sends a signal to it and its children; SIGKILL also to those that made themselves independent of it.
  void signal(int number);
  /// Hands on to it every interrupt that has come to us since the last call: two as SIGINT, the third ends it
  /// and all that it started. True once there was one.
  bool hand_on_interrupts();
  /// Waits, at most `seconds` and not past another interrupt, for what it started and has left behind; then
  /// kills that.
  void end_survivors(double seconds);

 private:
  pid_t pid_ = -1;
  std::string mark_;
  int handed_on_ = 0;
  std::optional<ProcessEnd> end_;
};

/// The last line of a log that says something, without our name before it: what a program ended with.
std::string last_words(const std::filesystem::path& log);

/// While it lives, whatever asks this process to stop is noted instead of ending it: SIGINT, SIGTERM, SIGHUP
/// (a closed terminal), SIGPIPE (nobody reads what we say), SIGXCPU and SIGUSR1 (a scheduler's warnings).
/// What the caller has us ignore stays ignored, as SIGHUP under nohup and SIGINT in the background. Guards
/// may be nested.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  /// How often it was asked to stop. Signals that come together, from a scheduler and from who started us,
  /// say, count once.
  static int count();
};

}  // namespace flowrest::runs
