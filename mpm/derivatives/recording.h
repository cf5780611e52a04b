#pragma once

#include <cstddef>
#include <vector>

#include "mpm/output/run.h"

namespace flowrest::mpm::derivatives {

/// What a run did, step by step: enough to make it again. A derivative is that of the run with these steps.
struct Recording {
  struct Row {
    std::size_t steps;  ///< that were made by then
    double time;        ///< s
  };
  std::vector<StepTaken> steps;
  std::vector<Row> rows;  ///< of history.csv, the last one at the run's end
};

/// Lets a run be recorded. `into` must outlive it.
inline void record(RunOptions& options, Recording& into) {
  options.on_step = [&into](const StepTaken& step) { into.steps.push_back(step); };
  options.on_row = [&into](double time) { into.rows.push_back({into.steps.size(), time}); };
}

}  // namespace flowrest::mpm::derivatives
