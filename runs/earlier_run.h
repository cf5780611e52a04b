#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runs/run_directory.h"
#include "scenes/scene.h"

/// A run that was begun earlier and is to be gone on with, or prolonged.
namespace flowrest::runs {

/// What its run.json says of it.
struct EarlierRun {
  std::filesystem::path directory;
  nlohmann::ordered_json info;
  scenes::Scene scene;  ///< that it was begun with, by its own name and with its own text
  Status status = Status::running;
  /// Whether it came to an end of its own, which only a later one can prolong.
  bool finished() const { return status == Status::at_rest || status == Status::end_time; }
};

/// @throws RunError where the folder holds no run of `solver` ("mpm" or "foam") that can be gone on with.
EarlierRun read_earlier_run(const std::filesystem::path&, const std::string& solver);

/// The dotted names of the settings in which two scenes differ.
std::vector<std::string> differing_settings(const scenes::Scene&, const scenes::Scene&);

/// The scene that a run goes on with: its own, with `set` ("time.end=120") laid over it. Beside time.end, and
/// time.stop_at_rest where it is turned off, only what stands in `free` may change: all else would give
/// another run than the one that had these settings from the start.
/// @throws scenes::SceneError where the settings cannot be; RunError where one may not change, or where the
/// run is finished and they do not prolong it.
scenes::Scene scene_to_go_on_with(const EarlierRun&, const std::vector<std::string>& set,
                                  const std::vector<std::string>& free = {});

/// @throws RunError where the run has come further than its new end; `from` is the earliest that it can have,
/// s.
void check_end(const EarlierRun&, const scenes::Scene&, double from);

/// @throws RunError naming the options that were given beside --resume and have no meaning there; `allowed`
/// names those that have.
void refuse_beside_resume(const std::vector<std::string>& given, const std::string& allowed);

}  // namespace flowrest::runs
