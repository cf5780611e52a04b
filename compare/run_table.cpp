#include "compare/run_table.h"

#include <algorithm>
#include <cmath>

namespace flowrest::compare {

report::Format lengths(const Comparison& comparison, int more) {
  return fixed(comparison.grain.decimals() + more);
}

report::Format signed_lengths(const Comparison& comparison) {
  return signed_fixed(comparison.grain.decimals());
}

report::Format times(const Comparison& comparison, int digits) {
  return fixed(digits +
               std::max(0, static_cast<int>(std::ceil(-std::log10(comparison.thresholds.time_unit)))));
}

}  // namespace flowrest::compare
