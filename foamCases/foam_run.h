#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "runs/run_directory.h"
#include "scenes/scene.h"

namespace flowrest::foam {

/// How a run is made.
struct RunOptions {
  std::filesystem::path directory;  ///< of the run; the case goes into directory/case
  int ranks = 1;                    ///< above 1: decomposed, under mpirun
  bool quiet = false;
  double grace = 60.0;  ///< s, that a solver asked to stop has to end its step and write
};

/// What a run came to; more of it stands in its run.json.
struct RunOutcome {
  runs::Status status = runs::Status::running;
  std::string reason;
  std::string verdict;
  double time = 0.0;              ///< s, reached
  nlohmann::ordered_json gauges;  ///< the last ones, by their names in run.json
};

/// Fills the scene's case, runs it, gauges it while it runs and leaves a run directory.
/// @throws scenes::SceneError where the scene cannot be run, runs::MissingProgram without OpenFOAM (both
/// before anything is written), runs::NumericsError where the run failed (the run directory stays, with the
/// reason).
RunOutcome run_scene(const scenes::Scene&, const RunOptions&);

/// Goes on with the run in options.directory from its latest whole state, or from the start where there is
/// none.
/// @throws runs::RunError where that is no run of this solver, has come to its end, or its case is not the
/// one that `flowrest foam` filled; else as run_scene.
RunOutcome resume_run(const RunOptions&);

}  // namespace flowrest::foam
