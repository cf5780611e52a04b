#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "foamCases/case_fields.h"
#include "foamCases/solver_log.h"
#include "runs/columns.h"
#include "runs/resolution.h"
#include "runs/rest.h"
#include "runs/run_directory.h"
#include "scenes/scene.h"

namespace flowrest::foam {

/// Which samples become rows. interFoam samples at the first step past half a step before each multiple of
/// the interval, so a sample may come a little early.
class RowClock {
 public:
  RowClock(const scenes::Scene&, double interval);
  /// Whether the sample of this time becomes a row; `at_end`: the last one does in any case.
  bool is_due(double time, bool at_end = false);
  /// Goes on behind the row of this time.
  void continue_from(double time);

 private:
  double interval_, early_;  ///< s
  double next_ = 0.0;        ///< s
};

/// The last of these times of rows that is a row of a longer run, too. s; -1 where there is none
double last_regular_row(const scenes::Scene&, double interval, const std::vector<double>& times);

/// Turns the time directories of a running case into rows of history.csv and profiles.csv, and removes those
/// that were written for that only (a snapshot also holds p_rgh). What is gauged is a matter of the scene's
/// kind.
class Sampler {
 public:
  virtual ~Sampler() = default;

  /// Says when a run begins that does not begin at 0 s.
  void begin_at(double time) { start_ = time; }

  /// Counts a step: what the solver's log says of it goes into the next row at or after its time.
  void note(const SolverStep&);

  /// Samples, in their order, the time directories not yet sampled whose time is below `complete_before`, and
  /// calls `after_each`.
  /// @throws FieldError where one of them is not whole.
  void sample_before(
      double complete_before, const std::function<void()>& after_each = [] {});

  /// Goes on with a run whose rows so far are these: what was sampled is not sampled again.
  virtual void continue_from(const runs::Table& history);

  /// s, of the last sample; 0 before the first
  double time() const { return last_sampled_.value_or(0.0); }

  virtual std::size_t cells() const = 0;
  /// The state in a few words, for progress.
  virtual std::string progress() const = 0;
  /// The overstress that governs rest (runs/rest.h), of the last sample; `runs::nothing` where no cell is
  /// full enough to tell, which is no rest.
  double overstress() const { return rest_.overstress(overstressing_rate()); }
  /// Why the run can give no answer any more; empty where it can.
  virtual std::string fault() const = 0;
  /// Why the answer is in doubt for what was sampled; empty where it is not.
  virtual std::string doubt() const = 0;
  /// How the cells resolve what is sheared, by the rows so far.
  const runs::Resolution& resolution() const { return resolution_; }
  /// The last gauges, for run.json.
  virtual nlohmann::ordered_json summary() const = 0;

 protected:
  /// `plug_in`: whether the plug-in watches the steps, too.
  Sampler(const scenes::Scene&, CaseFields, runs::RunWriter&, bool plug_in);

  virtual void sample(double time, const ReadField&) = 0;
  /// 1/s, of the last sample: the 99th percentile, by volume of concrete, of runs::overstressing_rate;
  /// `runs::nothing` where no cell is full enough to tell.
  virtual double overstressing_rate() const = 0;

  const scenes::Scene& scene() const { return scene_; }
  /// Whether the solver has written the fields of a time, which at the start it has not.
  bool is_solved(double time) const { return time > start_; }
  runs::RunWriter& writer() { return writer_; }
  bool plug_in() const { return plug_in_; }
  /// What a row says of the steps since the last: the largest residual, chatter and Courant number, and the
  /// last step.
  runs::Row steps_until(double time);
  /// What a row says of the layer that is sheared, which the run's resolution is judged by.
  runs::Row resolution_until(double time, const runs::ShearedLayer&);
  /// Whether rows tell of flocculation.
  bool thixotropic() const;
  /// The field of the flocculation, as it is at the start while the solver has not written it yet.
  std::vector<double> flocculation(double time, const ReadField&) const;
  /// The part by which every cell's yield stress passes tau0 with this flocculation.
  std::vector<double> structure(double time, std::vector<double> flocculation) const;
  /// What a row says of the structure, whose mean flocculation is this.
  runs::Row structure_columns(double time, double flocculation) const;
  bool history_is_due(double time);
  bool profile_is_due(double time);

 private:
  SolverStep since_last_row(double time);
  bool is_at_end(double time) const;

  const scenes::Scene& scene_;
  runs::Rest rest_;
  CaseFields fields_;
  runs::RunWriter& writer_;
  bool plug_in_;
  double start_ = 0.0;  ///< s
  std::optional<double> last_sampled_;
  RowClock history_clock_, profile_clock_;
  runs::Resolution resolution_;
  std::deque<SolverStep> steps_;  ///< not yet in a row
};

}  // namespace flowrest::foam
