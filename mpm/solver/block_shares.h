#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace flowrest::mpm {

/// Loops over blocks, shared out among threads. Every loop gives a thread the same blocks first, for what the
/// last loop left of them is in its core's cache; one that is done with its own helps the others, from their
/// ends.
class BlockShares {
 public:
  explicit BlockShares(int threads = 1, int loops = 1)
      : threads_(static_cast<std::size_t>(threads)),
        ends_(threads_, 0),
        left_(threads_ * static_cast<std::size_t>(loops)) {}

  int threads() const { return static_cast<int>(threads_); }

  /// Shares out blocks `0 .. ends.back() - 1` anew: a thread's own end at `ends[thread]`.
  void share_out(std::vector<std::uint32_t> ends) { ends_ = std::move(ends); }

  /// The thread that a block belongs to; the last one's are all that come after.
  int owner(std::uint32_t block) const {
    const auto at = std::upper_bound(ends_.begin(), ends_.end() - 1, block);
    return static_cast<int>(at - ends_.begin());
  }

  /// Before the loops begin, by one thread.
  void begin() {
    for (std::size_t i = 0; i < left_.size(); ++i) {
      const std::size_t thread = i % threads_;
      left_[i].range.store(packed(thread == 0 ? 0 : ends_[thread - 1], ends_[thread]));
    }
  }

  /// A thread's part of one of the loops; each is to be run once after begin(). There is no barrier in it.
  template <class Body>
  void run(int loop, int thread, const Body& body) {
    Left* const left = &left_[static_cast<std::size_t>(loop) * threads_];
    std::uint32_t block = 0;
    const auto own = static_cast<std::size_t>(thread);
    while (left[own].take(block, Side::front)) body(block);
    for (std::size_t i = 1; i < threads_; ++i)
      while (left[(own + i) % threads_].take(block, Side::back)) body(block);
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
