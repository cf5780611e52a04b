#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runs/environment.h"

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
/// decide how it ends; it is killed when it goes out of scope or when this process dies. What it has started
/// in turn is known by a mark in its environment, wherever it has gone (ranks and jobs have groups of their
/// own), and never outlives this object.
class Process {
 public:
  /// Starts `program`, a helper, in `directory`, its output and errors going to `log`, in this environment
  /// and no other.
  /// @throws MissingProgram where it cannot be started.
  Process(const std::filesystem::path& program, const std::vector<std::string>& arguments,
          const std::filesystem::path& directory, const std::filesystem::path& log,
          const Environment& environment);
  /// As before, for this program itself: `added` to the environment that we have.
  Process(const std::filesystem::path& program, const std::vector<std::string>& arguments,
          const std::filesystem::path& directory, const std::filesystem::path& log,
          const std::map<std::string, std::string>& added);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// How it ended, or nothing while it runs.
  std::optional<ProcessEnd> poll();
  /// Waits for its end, at most `seconds`.
  std::optional<ProcessEnd> wait(double seconds);
  /// Sends a signal to it and its children.
  void signal(int number);
  /// While an InterruptGuard lives: hands on to it, as SIGINT, every interrupt that has come to us since the
  /// last call. What is left a few seconds after the second one is killed, and at once after the third. To be
  /// called again and again while it runs. True once there was one.
  bool hand_on_interrupts();
  /// Whether it or anything that it started still runs.
  bool any_left() const;
  /// Waits, at most `seconds`, for what it started and has left behind, handing interrupts on; then kills
  /// that.
  void end_survivors(double seconds);
  /// Kills it and all that it started, and waits until they are gone.
  void kill_all();

 private:
  void start(const std::filesystem::path& program, const std::vector<std::string>& arguments,
             const std::filesystem::path& directory, const std::filesystem::path& log,
             std::map<std::string, std::string> environment);

  pid_t pid_ = -1;
  std::string mark_;
  int handed_on_ = 0;
  std::optional<std::chrono::steady_clock::time_point> deadline_;  ///< of what was asked twice to end
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
