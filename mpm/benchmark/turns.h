#pragma once

#include <algorithm>
#include <vector>

#include "mpm/benchmark/flowing_slump.h"
#include "mpm/benchmark/machine_limits.h"
#include "runs/run_directory.h"

/// What is measured in turns, so that a machine's other work meets all alike.
namespace flowrest::mpm::bench {

using runs::wall_seconds;

/// Time of a particle-step by a clock (cpu_seconds or wall_seconds), ns.
inline double time_of_steps(FlowingSlump& slump, int steps, double (*clock)()) {
  const double begin = clock();
  for (int i = 0; i < steps; ++i) slump.advance();
  return (clock() - begin) / (steps * slump.particles()) * 1e9;
}

inline double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}
inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

}  // namespace flowrest::mpm::bench
