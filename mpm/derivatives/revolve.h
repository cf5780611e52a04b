#pragma once

#include <cstddef>
#include <functional>

/// In which order to go a run of known length backwards, with room for few of its states.
namespace flowrest::mpm::derivatives {

/// How many steps can be gone back with `snapshots` states, none of them made more than `repeats` times beside the
/// first: (snapshots + repeats)! / (snapshots! repeats!) (Griewank and Walther 2000), or `most` where that is more.
inline std::size_t reversible_steps(std::size_t snapshots, std::size_t repeats, std::size_t most) {
  double count = 1.0;
  for (std::size_t i = 1; i <= repeats; ++i) {
    count *= static_cast<double>(snapshots + i) / static_cast<double>(i);
    if (count > static_cast<double>(most)) return most;
  }
  return static_cast<std::size_t>(count + 0.5);
}

/// What goes a run backwards: the state that it is in, kept ones, and the adjoint of a step.
struct Reversal {
  std::function<void(std::size_t step)> advance_to;  ///< from the state that it is in
  std::function<void()> keep;                        ///< the state that it is in, on top of those kept
  std::function<void()> restore;                     ///< the state kept last
  std::function<void()> drop;                        ///< the state kept last
  std::function<void(std::size_t step)> back;  ///< makes that step from the state before it, and its adjoint
};

/// Goes the steps from `begin` to `end` backwards. The state at `begin` is kept on top; `snapshots` more can be.
/// Binomial, with the fewest repeats that do (Griewank and Walther 2000).
inline void go_back(const Reversal& reversal, std::size_t begin, std::size_t end, std::size_t snapshots) {
  while (end > begin) {
    reversal.restore();
    const std::size_t length = end - begin;
    if (length == 1) {
      reversal.back(begin);
      return;
    }
    if (snapshots == 0) {
      reversal.advance_to(end - 1);
      reversal.back(end - 1);
      --end;
      continue;
    }
    std::size_t repeats = 1;
    while (reversible_steps(snapshots, repeats, length) < length) ++repeats;
    // As much as can be gone back with one repeat less; what is left, with one snapshot less, has to be enough.
    const std::size_t behind = reversible_steps(snapshots - 1, repeats, length);
    std::size_t ahead = length > behind ? length - behind : 1;
    ahead = ahead < length ? ahead : length - 1;
    const std::size_t middle = begin + ahead;
    reversal.advance_to(middle);
    reversal.keep();
    go_back(reversal, middle, end, snapshots - 1);
    reversal.drop();
    end = middle;
  }
}

}  // namespace flowrest::mpm::derivatives
