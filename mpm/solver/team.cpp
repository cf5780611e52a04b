#include "mpm/solver/team.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "runs/cores.h"

namespace flowrest::mpm {

namespace {

using Clock = std::chrono::steady_clock;

/// A waiting thread looks out for work for half the time that it has worked, saved up to this much.
/// To wake a sleeping thread takes some 50 microseconds; what one thread does alone in a step of 44,000
/// particles takes as long.
constexpr Clock::duration longest_watch = std::chrono::microseconds(100);
constexpr int work_per_watch = 2;

void rest_a_moment() {
#if defined(__x86_64__) || defined(__i386__)
  for (int i = 0; i < 8; ++i) __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

}  // namespace

/// One thread's waiting.
class Team::Watch {
 public:
  explicit Watch(bool watchful) : watchful_(watchful) {}

  /// Returns once `is_over` of the value, asleep for as long as that takes if need be.
  template <class IsOver>
  void until(std::atomic<std::uint32_t>& value, const IsOver& is_over) {
    if (!is_over(value.load(std::memory_order_acquire)) && !(watchful_ && look_out(value, is_over)))
      for (auto now = value.load(std::memory_order_acquire); !is_over(now);
           now = value.load(std::memory_order_acquire))
        value.wait(now, std::memory_order_acquire);
    if (watchful_) at_work_since_ = Clock::now();
  }

 private:
  template <class IsOver>
  bool look_out(const std::atomic<std::uint32_t>& value, const IsOver& is_over) {
    const auto begin = Clock::now();
    saved_ = std::min(longest_watch, saved_ + (begin - at_work_since_) / work_per_watch);
    for (auto now = begin; now - begin < saved_; now = Clock::now()) {
      rest_a_moment();
      if (is_over(value.load(std::memory_order_acquire))) {
        saved_ -= std::min(saved_, Clock::now() - begin);
        return true;
      }
    }
    saved_ = {};
    return false;
  }

  bool watchful_;
  Clock::time_point at_work_since_ = Clock::now();
  Clock::duration saved_{};
};

Team::Team(int threads)
    : threads_(threads),
      // Threads that share a core would keep each other from it.
      watchful_(threads <= runs::cores()),
      even_(threads),
      watch_(std::make_unique<Watch>(watchful_)) {
  try {
    for (int t = 1; t < threads; ++t) helpers_.emplace_back([this, t] { help(t); });
  } catch (const std::system_error&) {
    // Those that there are do all the work.
  }
}

Team::~Team() {
  ended_ = true;
  round_.fetch_add(1);
  round_.notify_all();
}

void Team::work_on(const Work& work) {
  work_ = work;
  if (!helpers_.empty()) {
    gate_.store(open);
    round_.fetch_add(1);
    round_.notify_all();
  }
  do_part(0);
  if (!helpers_.empty()) {
    gate_.fetch_and(~open);
    watch_->until(gate_, [](std::uint32_t at_work) { return at_work == 0; });
  }
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

void Team::do_part(int thread) noexcept {
  try {
    work_.part(work_.it, thread);
  } catch (...) {
    const std::lock_guard hold(error_lock_);
    if (!error_) error_ = std::current_exception();
  }
}

void Team::help(int thread) {
  Watch watch(watchful_);
  for (std::uint32_t seen = 0; !ended_;) {
    watch.until(round_, [&](std::uint32_t round) { return round != seen; });
    seen = round_.load();
    if (!enter()) continue;
    do_part(thread);
    leave();
  }
}

/// False where the loop has been closed already. One that began meanwhile does as well.
bool Team::enter() {
  for (std::uint32_t now = gate_.load(); now & open;)
    if (gate_.compare_exchange_weak(now, now + 1)) return true;
  return false;
}

void Team::leave() {
  if (gate_.fetch_sub(1) == 1) gate_.notify_one();  // the last one, and nobody else can come
}

}  // namespace flowrest::mpm
