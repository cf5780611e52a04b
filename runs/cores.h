#pragma once

#include <filesystem>
#include <optional>

namespace flowrest::runs {

/// Cores that are ours to use at once, at least one: those of the affinity mask (sched_getaffinity), but no
/// more than the quota of our control groups, rounded down (version 1 or 2, ours and those that hold it),
/// than OMP_NUM_THREADS (its first number) and OMP_THREAD_LIMIT, and than SLURM_CPUS_PER_TASK. Variables that
/// are no number above 0 are no limit.
int cores();

/// Cores' worth of time that the control groups grant this process; none where they set no limit. `root` is
/// where /proc and /sys are found.
std::optional<double> core_quota(const std::filesystem::path& root = "/");

}  // namespace flowrest::runs
