#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "elements/slump.h"
#include "runs/run_directory.h"

namespace flowrest::elements {

struct RunOptions {
  std::filesystem::path directory;  ///< the run directory
  runs::Replace replace = runs::Replace::failed;
  int columns = 60;  ///< of elements; rows and steps go with them
  bool quiet = false;
  /// Asked at every row of the history; true ends the run there.
  std::function<bool()> interrupted = [] { return false; };
};

struct RunResult {
  runs::Status status = runs::Status::running;
  std::string summary;
};

/// The resolution of a number of columns, for a problem: its rounding leaves what stands still to creep by a
/// strain of less than a hundredth until the end.
Resolution resolution_of(const Problem&, int columns);

/// Computes a scene to its end and leaves the run directory, with the uncertainty of the spread at each time:
/// a twin with elements and steps 1.5 times as large, and for a law that is rounded a third with four times
/// that rounding besides.
/// @throws runs::RunError where the scene is not served or the directory may not be written; nothing is
/// written then.
/// @throws runs::NumericsError, runs::MachineError as a run's, the directory then says so, with all data so
/// far.
RunResult run(const scenes::Scene&, const RunOptions&);

}  // namespace flowrest::elements
