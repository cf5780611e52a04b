#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace flowrest::mpm {

/// A loop over blocks, shared out among threads. Every loop gives a thread the same blocks first, for what
/// the last loop left of them is in its core's cache; one that is done with its own helps the others, from
/// their ends.
class BlockShares {
 public:
  explicit BlockShares(int threads = 1)
      : threads_(static_cast<std::size_t>(threads)), ends_(threads_, 0), left_(threads_) {}

  int threads() const { return static_cast<int>(threads_); }

  /// Shares out blocks `0 .. ends.back() - 1` anew: a thread's own end at `ends[thread]`.
  void share_out(std::vector<std::uint32_t> ends) { ends_ = std::move(ends); }
  /// The same, with as many for every thread.
  void share_out_evenly(std::size_t blocks) {
    for (std::size_t t = 0; t < threads_; ++t)
      ends_[t] = static_cast<std::uint32_t>(blocks * (t + 1) / threads_);
  }

  /// The thread that a block belongs to; the last one's are all that come after.
  int owner(std::uint32_t block) const {
    const auto at = std::upper_bound(ends_.begin(), ends_.end() - 1, block);
    return static_cast<int>(at - ends_.begin());
  }

  /// Before a loop begins, by one thread.
  void begin() {
    for (std::size_t t = 0; t < threads_; ++t)
      left_[t].range.store(packed(t == 0 ? 0 : ends_[t - 1], ends_[t]), std::memory_order_relaxed);
  }

  /// A thread's part of the loop: returns once nothing is left to begin.
  template <class Body>
  void run(int thread, const Body& body) {
    std::uint32_t block = 0;
    const auto own = static_cast<std::size_t>(thread);
    while (left_[own].take(block, Side::front)) body(block);
    for (std::size_t i = 1; i < threads_; ++i)
      while (left_[(own + i) % threads_].take(block, Side::back)) body(block);
  }

 private:
  enum class Side { front, back };
  static std::uint64_t packed(std::uint32_t first, std::uint32_t end) {
    return std::uint64_t{end} << 32 | first;
  }
  /// Blocks of a thread that nobody has taken yet, on a cache line of their own.
  struct alignas(64) Left {
    std::atomic<std::uint64_t> range{0};
    bool take(std::uint32_t& block, Side side) {
      std::uint64_t now = range.load(std::memory_order_relaxed);
      while (true) {
        const auto first = static_cast<std::uint32_t>(now), end = static_cast<std::uint32_t>(now >> 32);
        if (first >= end) return false;
        const bool front = side == Side::front;
        block = front ? first : end - 1;
        if (range.compare_exchange_weak(now, front ? packed(first + 1, end) : packed(first, end - 1),
                                        std::memory_order_relaxed))
          return true;
      }
    }
  };

  std::size_t threads_;
  std::vector<std::uint32_t> ends_;
  std::vector<Left> left_;
};

}  // namespace flowrest::mpm
