#include "runs/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "runs/console.h"

namespace flowrest::runs {

namespace {

using Seconds = std::chrono::duration<double>;
constexpr Seconds terminal_interval{0.1};
constexpr Seconds plain_interval{5.0};

std::string duration_text(double seconds) {
  const auto whole = std::lround(std::clamp(seconds, 0.0, 3.6e8));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

Progress::Progress(std::string what, double end, bool quiet)
    : what_(std::move(what)),
      end_(end),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

void Progress::update(double done, const std::string& state) {
  if (quiet_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < (terminal_ ? terminal_interval : plain_interval)) return;
  last_ = now;
  const double fraction = end_ > 0.0 ? std::clamp(done / end_, 0.0, 1.0) : 0.0;
  const double elapsed = Seconds(now - start_).count();
  // The first per cent says too little about the rest to be worth an estimate.
  const std::string left =
      fraction > 0.01 ? ", about " + duration_text(elapsed * (1.0 - fraction) / fraction) + " left" : "";
  if (terminal_) {
    constexpr int width = 24;
    const int filled = static_cast<int>(fraction * width);
    say(stderr, fmt::format("\r\033[K{} [{}{}] {:3.0f} %  {}{}", what_, std::string(filled, '#'),
                            std::string(width - filled, '.'), 100.0 * fraction, state, left));
  } else {
    say(stderr, fmt::format("{}: {:.0f} %, {}{}\n", what_, 100.0 * fraction, state, left));
  }
}

void Progress::note(const std::string& text) {
  if (quiet_) return;
  fmt::print(stderr, "{}{}: {}\n", terminal_ ? "\r\033[K" : "", what_, text);
  std::fflush(stderr);
}

void Progress::finish(const std::string& summary) {
  if (quiet_) return;
  const double elapsed = Seconds(std::chrono::steady_clock::now() - start_).count();
  say(stderr,
      fmt::format("{}{}: {} (in {})\n", terminal_ ? "\r\033[K" : "", what_, summary, duration_text(elapsed)));
}

}  // namespace flowrest::runs
