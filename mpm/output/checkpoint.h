#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "mpm/output/noise.h"
#include "mpm/solver/solver.h"

namespace flowrest::mpm {

/// What a run knows beside its particles; with them it goes on bit for bit.
struct RunState {
  double time = 0.0;  ///< s
  double steps = 0.0;
  double step = 0.0;              ///< s, the last one
  double largest_speed = 0.0;     ///< m/s, of the last step
  double largest_pressure = 0.0;  ///< Pa
  double dissipated = 0.0;        ///< J, whole body
  double work = 0.0;              ///< J, done by the driving force
  double initial_energy = 0.0;    ///< J
  double calm_since = -1.0;       ///< s, since when the rest bound has held; -1 where it does not
  double cpu = 0.0;               ///< s, spent so far
  double wall = 0.0;              ///< s
  double histories = 0.0, profiles = 0.0, snapshots = 0.0, checkpoints = 0.0;  ///< outputs made so far
  /// s, the latest profile and snapshot made at their intervals: the end of a run adds one that a longer run
  /// does not have. -1 before the first.
  double last_profile = -1.0, last_snapshot = -1.0;
  NoiseRecord noise;
  StageTimes stages;  ///< so far
};

struct Checkpoint {
  RunState run;
  StoredState solver;               ///< its arrays are read from the file when they are asked for
  std::string scene;                ///< resolved TOML
  std::vector<double> noise_meter;  ///< its state
};

/// Writes `directory`/checkpoint.h5 atomically, the rest of it as in Checkpoint. @throws runs::RunError
void write_checkpoint(const std::filesystem::path& directory, const RunState&, Solver&,
                      const std::string& scene, const std::vector<double>& noise_meter);
/// @throws runs::RunError where the file is damaged; nullopt where there is none.
std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& directory);

}  // namespace flowrest::mpm
