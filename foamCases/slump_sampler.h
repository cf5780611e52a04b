#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <vector>

#include "foamCases/solver_log.h"
#include "foamCases/wedge_gauge.h"
#include "foamCases/wedge_grid.h"
#include "runs/run_directory.h"
#include "scenes/scene.h"

namespace flowrest::foam {

/// The state of a slump when it was last sampled, for progress and for the summary.
struct SlumpState {
  double time = 0.0;          ///< s
  double spread = 0.0;        ///< m, at 3 mm depth
  double front = 0.0;         ///< m
  double height = 0.0;        ///< m, centre depth
  double volume = 0.0;        ///< m3
  double rim_depth = 0.0;     ///< m
  double volume_error = 0.0;  ///< largest so far, relative to the first sample
  double first_volume = 0.0;  ///< m3
  double flocculation = 0.0;  ///< mean over the concrete
};

/// Turns the time directories of a running slump case into rows of history.csv and profiles.csv, and removes
/// those that were written for that only (a snapshot also holds p_rgh).
class SlumpSampler {
 public:
  SlumpSampler(const scenes::Scene&, std::filesystem::path case_directory, runs::RunWriter&);

  /// Counts a step: what the solver's log says of it goes into the next row at or after its time.
  void note(const SolverStep&);

  /// Samples, in their order, the time directories not yet sampled whose time is below `complete_before`.
  /// @throws FieldError where one of them is not whole.
  void sample_before(double complete_before);

  const SlumpState& state() const { return state_; }

 private:
  void sample(double time, const std::filesystem::path& directory);
  void write_history(double time, const SlumpGauges&);
  SolverStep since_last_row(double time);
  bool is_due(double time, double interval, double& next) const;

  const scenes::Scene& scene_;
  WedgeGrid grid_;
  std::filesystem::path case_directory_;
  runs::RunWriter& writer_;
  SlumpState state_;
  std::optional<double> last_sampled_;
  double next_history_ = 0.0;
  double next_profile_ = 0.0;
  std::deque<SolverStep> steps_;  ///< not yet in a row
};

/// The time directories of a case in ascending order; other names are passed over.
std::vector<std::pair<double, std::filesystem::path>> time_directories(
    const std::filesystem::path& case_directory);

}  // namespace flowrest::foam
