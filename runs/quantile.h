#pragma once

#include <utility>
#include <vector>

namespace flowrest::runs {

/// A value and the weight (mass, volume, area) that has it.
using Weighted = std::pair<double, double>;

/// The value that `share` of the weight does not exceed; `nothing` without any. Reorders the values.
double quantile(std::vector<Weighted>& values, double share);

/// The value that 99 % of the weight does not exceed.
inline double percentile_99(std::vector<Weighted> values) { return quantile(values, 0.99); }

}  // namespace flowrest::runs
