#pragma once

#include <filesystem>
#include <functional>

#include "runs/run_directory.h"
#include "scenes/scene.h"

namespace flowrest::mpm {

struct RunOptions {
  std::filesystem::path directory;  ///< the run directory
  bool quiet = false;
  bool resume = false;          ///< go on from the directory's checkpoint
  std::string instruction_set;  ///< empty: the best this machine runs
  /// Asked at every step; true stops the run at a step boundary with a checkpoint (Ctrl-C).
  std::function<bool()> interrupted = [] { return false; };
};

struct RunResult {
  runs::Status status = runs::Status::running;
  std::string reason;
  double time = 0.0;      ///< s, simulated
  double headline = 0.0;  ///< the scene's main gauge at the end (spread in mm, plug velocity in m/s)
};

/// Runs a scene to its end (rest, end time, interruption) and leaves the run directory.
/// @throws runs::NumericsError where the numerics fail; the run directory then says so, with all data so far.
/// @throws runs::RunError where the directory cannot be written.
RunResult run(const scenes::Scene&, const RunOptions&);

/// Goes on with the run in `options.directory`, from its checkpoint or, before the first one, from the start.
RunResult resume(const RunOptions&);

}  // namespace flowrest::mpm
