#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "runs/material_state.h"
#include "runs/run_directory.h"
#include "scenes/scene.h"

namespace flowrest::mpm {

/// What computes the steps: the kernels, or the plain step (plain/step.h).
enum class Method { fast, plain };

/// A step that a run has made.
struct StepTaken {
  double time = 0.0, step = 0.0;      ///< s: when it began, and how long it was
  double end = 0.0;                   ///< s: what time it was after it
  double apic_relaxation_time = 0.0;  ///< s, see Solver::set_apic_relaxation_time
};

struct RunOptions {
  std::filesystem::path directory;  ///< the run directory
  bool quiet = false;
  bool force = false;  ///< replace whatever run stands in the directory
  /// Empty: the best this machine runs; where a run is gone on with, the one it had, as others round
  /// otherwise.
  std::string instruction_set;
  std::string from;              ///< the state to start from; empty: the scene's body, at 0 s
  runs::StateReader read_state;  ///< reads it
  Method method = Method::fast;  ///< of a run that is gone on with: that which it was begun with
  /// Told of every step, and of the time (s) of every row of history.csv: for those who make the run again.
  std::function<void(const StepTaken&)> on_step;
  std::function<void(double)> on_row;
  /// Asked at every step; true stops the run at a step boundary with a checkpoint (Ctrl-C).
  std::function<bool()> interrupted = [] { return false; };
};

struct RunResult {
  runs::Status status = runs::Status::running;
  std::string reason;
  double time = 0.0;      ///< s, simulated
  double headline = 0.0;  ///< the scene's main gauge at the end (spread in mm, plug velocity in m/s)
};

/// Runs a scene to its end (rest, end time, interruption) and leaves the run directory. A finished run of the
/// same settings and version is taken as it is.
/// @throws runs::NumericsError where the numerics fail and runs::MachineError where the machine does, as
/// where disk or memory are full; the run directory then says so, with all data so far.
/// @throws runs::RunError where the directory may not be written, see runs::RunFolder, or the run cannot start
/// from the state that is asked for, see runs::check_start; nothing is written then.
RunResult run(const scenes::Scene&, const RunOptions&);

/// Goes on with the run in `options.directory` under its settings with `set` laid over them, bit for bit as
/// if it had had them from the start: from its checkpoint or, where it was stopped before the first one, from
/// the start. `set` may give a later time.end, which prolongs a finished run, time.stop_at_rest=false,
/// mpm.threads and output.checkpoint_interval.
/// @throws runs::RunError where there is no such run, it is finished and not prolonged, or a setting may not
/// change; nothing is written then.
RunResult resume(const RunOptions&, const std::vector<std::string>& set = {});

}  // namespace flowrest::mpm
