#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foamCases/solver_log.h"
#include "scenes/scene.h"

/// A run that was begun earlier: what it was, how far it came and what it has behind it.
namespace flowrest::foam {

/// What run.json says of it.
struct EarlierRun {
  scenes::Scene scene;
  bool plug_in = false;                          ///< whether its case takes the plug-in's laws
  std::map<std::string, double> cpu_by_program;  ///< s; empty where it was cut off
  double wall = 0.0;                             ///< s
};

/// Where it can be gone on from.
struct RunState {
  double time = 0.0;              ///< s
  std::vector<SolverStep> steps;  ///< up to then
  std::map<std::string, double> cpu_by_program;
  double wall = 0.0;
};

/// @throws runs::RunError where the folder holds no run of this solver, or one that has come to its end.
EarlierRun read_earlier_run(const std::filesystem::path& directory);

/// Removes the time directories, of a decomposed case too, that are later than the latest whole state.
void remove_cut_off_times(const std::filesystem::path& case_directory, const scenes::Scene&);

/// The latest whole state after the start; nothing where there is none. What is later is removed, and the
/// solver's log is set aside.
/// @throws runs::RunError where the case is not as `flowrest foam` filled it.
std::optional<RunState> latest_state(const std::filesystem::path& directory, const EarlierRun&);

}  // namespace flowrest::foam
