#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "mpm/solver/block_shares.h"

namespace flowrest::mpm {

/// Threads that share out loops over blocks among them, on a machine whose cores may have other work.
///
/// There is no barrier that all have to reach. The thread that asks for a loop does whatever nobody else has
/// begun; the others help as soon as the system lets them run. So a thread that has to wait for a core holds
/// the others up no longer than its own current block, or not at all.
///
/// A thread that has nothing to do looks out for work for some microseconds, then sleeps. It may look out for
/// a share of the time that it has worked: two threads never take twice the CPU time of one, however long
/// they have to wait for each other.
class Team {
 public:
  explicit Team(int threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  /// As asked for. Where the system refuses to start so many, fewer do the work.
  int threads() const { return threads_; }

  /// Runs `body(block, thread)` once for every block of the shares, and returns when all are done. `thread`
  /// is 0 for the caller and below threads() for the others; the shares are for as many.
  /// @throws the first of what bodies have thrown; some blocks have not been run then.
  template <class Body>
  void run(BlockShares& shares, const Body& body) {
    shares.begin();
    const auto part = [&](int thread) {
      shares.run(thread, [&](std::uint32_t block) { body(block, thread); });
    };
    work_on({&part, [](const void* it, int thread) { (*static_cast<const decltype(part)*>(it))(thread); }});
  }

  /// The same over `0 .. count - 1`, as many for every thread.
  template <class Body>
  void run(std::size_t count, const Body& body) {
    if (count == 0) return;
    even_.share_out_evenly(count);
    run(even_, body);
  }

 private:
  /// What a thread does in a loop: all of it, if nobody else comes.
  struct Work {
    const void* it = nullptr;
    void (*part)(const void* it, int thread) = nullptr;
  };
  /// The loop is open to those who come to help; the other bits count those who are at it.
  static constexpr std::uint32_t open = 1u << 31;

  void work_on(const Work&);
  void do_part(int thread) noexcept;
  void help(int thread);
  bool enter();
  void leave();

  int threads_;
  bool watchful_;  ///< whether threads look out before they sleep
  BlockShares even_;
  Work work_;
  std::exception_ptr error_;
  std::mutex error_lock_;
  alignas(64) std::atomic<std::uint32_t> gate_{0};
  alignas(64) std::atomic<std::uint32_t> round_{0};  ///< loops begun so far; what helpers wait for
  std::atomic<bool> ended_{false};
  class Watch;
  std::unique_ptr<Watch> watch_;  ///< the caller's
  std::vector<std::jthread> helpers_;
};

}  // namespace flowrest::mpm
