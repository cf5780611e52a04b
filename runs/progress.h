#pragma once

#include <chrono>
#include <string>

/// Progress of long work: a bar on a terminal, plain lines elsewhere (at most one every few seconds).
namespace flowrest::runs {

class Progress {
 public:
  /// `what` leads every line; `quiet` prints nothing.
  Progress(std::string what, double end, bool quiet = false);
  /// `done` of `end`, with a short text of the state (e.g. "spread 543 mm").
  void update(double done, const std::string& state);
  /// A line that stays.
  void note(const std::string& text);
  void finish(const std::string& summary);

 private:
  std::string what_;
  double end_;
  bool quiet_;
  bool terminal_;
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace flowrest::runs
