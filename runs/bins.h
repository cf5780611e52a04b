#pragma once

#include <algorithm>
#include <cmath>

namespace flowrest::runs {

/// Calls use(bin, overlap) for every bin of width 1, bin i from i to i + 1, that [low, high) overlaps; all
/// overlaps sum to high - low.
template <class Use>
void for_each_bin(double low, double high, const Use& use) {
  for (auto bin = static_cast<long>(std::floor(low)); static_cast<double>(bin) < high; ++bin) {
    const auto from = static_cast<double>(bin);
    use(bin, std::min(high, from + 1.0) - std::max(low, from));
  }
}

}  // namespace flowrest::runs
