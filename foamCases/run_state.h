#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foamCases/solver_log.h"
#include "runs/earlier_run.h"
#include "scenes/scene.h"

/// A run that was begun earlier: what it was, how far it came and what it has behind it.
namespace flowrest::foam {

/// What run.json and its case say of it.
struct EarlierRun {
  runs::EarlierRun run;                          ///< as it was begun
  scenes::Scene scene;                           ///< that it is to go on with
  bool plug_in = false;                          ///< whether its case takes the plug-in's laws
  int ranks = 1;                                 ///< that it had last
  std::map<std::string, double> cpu_by_program;  ///< s; empty where it was cut off
  double wall = 0.0;                             ///< s
};

/// A time directory.
struct StateTime {
  double time = 0.0;  ///< s
  std::string name;
};

/// Where it can be gone on from.
struct RunState {
  double time = 0.0;              ///< s
  double last_row = 0.0;          ///< s, of the history's rows that stay
  double last_profile = 0.0;      ///< s
  std::vector<SolverStep> steps;  ///< up to then
  runs::Table overstresses;       ///< of the samples up to then, where it was kept: time_s, overstress
  std::map<std::string, double> cpu_by_program;
  double wall = 0.0;
};

/// What a case keeps of its samples for whoever goes on with it.
inline constexpr const char* overstresses_file = "overstresses.csv";

/// The run in a folder, with `set` laid over its settings: time.end, time.stop_at_rest=false.
/// @throws runs::RunError where the folder holds no run of this solver, or one that is finished and not
/// prolonged, or where a setting may not change.
EarlierRun read_earlier_run(const std::filesystem::path& directory, const std::vector<std::string>& set);

/// The latest time after the start of which every field is whole, in the parts of a decomposed case too;
/// nothing where there is none.
std::optional<StateTime> latest_whole_time(const std::filesystem::path& case_directory, const EarlierRun&);

/// @throws runs::RunError where the case is not as `flowrest foam` filled it, or cannot be gone on with to
/// the new end.
void check_case(const std::filesystem::path& case_directory, const EarlierRun&);

/// Removes the time directories that are later than this one.
void remove_later_times(const std::filesystem::path& case_directory, const StateTime&);

/// The state of that time; what is later is removed, and the solver's log is set aside.
RunState take_up(const std::filesystem::path& directory, const EarlierRun&, const StateTime&);

/// Makes a whole state of the fields that interFoam leaves at its end: writes what it says of its steps
/// beside the fields of a state only where that is due.
void complete_last_state(const std::filesystem::path& case_directory, const SolverStep& last,
                         double time_step_before, std::size_t steps);

}  // namespace flowrest::foam
