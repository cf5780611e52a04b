#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "runs/material_state.h"
#include "runs/run_directory.h"
#include "scenes/scene.h"

namespace flowrest::foam {

/// How a run is made.
struct RunOptions {
  std::filesystem::path directory;  ///< of the run; the case goes into directory/case
  /// Above 1: decomposed, under mpirun. One unless given; where a run is gone on with, as many as it had.
  std::optional<int> ranks = std::nullopt;
  bool quiet = false;
  bool force = false;                 ///< replace whatever run stands in the directory
  std::string from = {};              ///< the state to start from; empty: the scene's body, at 0 s
  runs::StateReader read_state = {};  ///< reads it
  double grace = 60.0;                ///< s, that a solver asked to stop has to end its step and write
};

/// What a run came to; more of it stands in its run.json.
struct RunOutcome {
  runs::Status status = runs::Status::running;
  std::string reason;
  std::string verdict;
  double time = 0.0;              ///< s, reached
  nlohmann::ordered_json gauges;  ///< the last ones, by their names in run.json
};

/// Fills the scene's case, runs it, gauges it while it runs and leaves a run directory. A finished run of the
/// same settings and version is taken as it is.
/// @throws scenes::SceneError where the scene cannot be run, runs::RunError where it cannot start from the state
/// that is asked for (see runs::check_start), runs::MissingProgram without OpenFOAM,
/// runs::RunError where the directory may not be written (see runs::RunFolder), all before anything is
/// written; runs::NumericsError where the run failed and runs::MachineError where the machine did (the run
/// directory stays, with the reason).
RunOutcome run_scene(const scenes::Scene&, const RunOptions&);

/// Goes on with the run in options.directory from its latest whole state, under its settings with `set` laid
/// over them: a later time.end, which prolongs a finished run, and time.stop_at_rest=false. A run that was
/// stopped before its first state begins anew.
/// @throws runs::RunError where that is no run of this solver, is finished and not prolonged, its case is not
/// the one that `flowrest foam` filled, or a setting may not change; nothing is written then. Else as
/// run_scene.
RunOutcome resume_run(const RunOptions&, const std::vector<std::string>& set = {});

}  // namespace flowrest::foam
