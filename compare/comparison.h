#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/measures/series.h"
#include "compare/words.h"
#include "runs/run_directory.h"
#include "runs/verdict.h"

/// Compares run directories, whoever made them: measures of each, differences between them, and what they say
/// in words.
namespace flowrest::compare {

class ApparatusReport;

/// What a caller asks the measures to be taken by; what is empty follows from the runs' [gauges].
struct Options {
  std::optional<double>
      rest_shear_rate;  ///< 1/s: at rest once the 99th percentile of the shear rate stays below
  std::optional<double> rest_spread_rate;  ///< m/s: at rest once the spread grows by less
  std::optional<double> residual_window;   ///< s, the last of a run, for its residual speed
};

/// What the measures are taken by: speeds and times of the standard apparatus, or as a body of another size
/// has them. Every threshold is named in comparison.json.
struct Thresholds {
  double rest_shear_rate = 0.05;   ///< 1/s
  double rest_spread_rate = 5e-4;  ///< m/s
  double still_speed = 1e-4;  ///< m/s: a law that can rest, and spreads slower than this, has come to rest
  double rest_velocity_fraction = 0.01;  ///< of a duct's largest plug velocity: stopped once it stays below
  double rate_window = 2.0;              ///< s, over which rates are taken
  double residual_window = 5.0;          ///< s
  double creep_factor = 3.0;  ///< a residual up to this many times the predicted creep is explained by it
  double time_unit = 1.0;     ///< s, a round time: 1 s of the standard apparatus
  std::vector<double> overshoot_times = {20.0, 25.0, 60.0};  ///< s
  double stop_from = 10.0;                                   ///< s, where arbitrary stops begin
  double stop_to = 60.0;                                     ///< s
};
Thresholds thresholds_of(const scenes::Gauges&, const Options&);

/// Why a run still moves at its end, as far as known.
enum class Cause {
  at_rest,
  within_bound,
  approaching_rest,
  creep,
  creep_or_noise,
  noise,
  unexplained,
  unknown
};
std::string to_string(Cause);

/// A number read off a run, in the unit of its name, and how well it is known by another grid.
struct ReadValue {
  std::optional<double> value, uncertainty;
};

/// What is measured of one run. Spreads in m, velocities in m/s. Empty: not measurable, or without meaning
/// for this run.
struct Measures {
  std::optional<double> end;          ///< s, the last time recorded
  std::optional<double> gauge_end;    ///< of the gauge, SI, at the end
  std::optional<double> uncertainty;  ///< of that, SI, all but ducts: the largest of what is known
  std::string uncertainty_source;     ///< what it is: "the grid study among these runs", "a cell", ...
  std::optional<double> spread_at_half,
      spread_at_twice;  ///< the depth of the spread, of the last profile: the sensitivity to that depth
  std::optional<double> centre_depth;                             ///< m, of the last profile
  std::optional<double> rest_declared;                            ///< s, by the run itself
  std::optional<double> rest_by_shear_rate, rest_by_spread_rate;  ///< s
  std::optional<double> growth_to_come;  ///< m, a bound the run itself puts on what its spread may still gain
  std::optional<double> stop_after_step;  ///< s after the last change of force, ducts
  std::optional<double> stopping_bound;   ///< s, its exact upper bound, ducts
  std::optional<double> residual;  ///< m/s: growth of the spread, or plug velocity, over the last seconds
  std::optional<double> residual_scatter;  ///< of the gauge about its trend there
  std::optional<double> predicted_creep;   ///< m/s, what the regularisation alone would leave
  /// m/s, at which the exact material still approaches rest at the end: of a thin film with the pull of its
  /// plug, and without. Of those slumps alone that move and do not creep.
  std::optional<double> approach_least, approach_most;
  Cause cause = Cause::unknown;
  std::optional<double> overshoot_reference;        ///< m, the arrested spread overshoots are counted from
  std::string overshoot_reference_run;              ///< its label
  std::map<double, double> overshoot;               ///< s -> m
  std::optional<double> stop_lowest, stop_highest;  ///< the gauge over all arbitrary stops
  std::optional<double> volume_drift;               ///< (last - first)/first
  std::optional<double> mass_drift;
  std::optional<double> cpu, wall, cpu_per_simulated_second;  ///< s
  std::map<std::string, ReadValue> readings;                  ///< its readings, by their quantity
};

/// A run under comparison.
struct RunView {
  const ApparatusReport* apparatus = nullptr;
  runs::Run run;
  std::string label;  ///< unique
  std::string solver, model;
  bool exact = false;
  bool held = false;             ///< it came to rest: its last state stands for all later times
  std::optional<laws::Law> law;  ///< that `model` names
  bool fluid = false;            ///< a law that never comes to rest
  runs::Doubt doubt;             ///< of its own verdict: noisy, under-resolved
  std::string trouble;  ///< "interrupted at 12 s", "failed at 3 s: why"; empty where the run came to its end
  scenes::Gauges gauges;     ///< what its gauges are defined by
  bool unread = false;       ///< its last row has nothing to read of the gauge
  std::string walls_differ;  ///< where its walls are not those of the scene, in words; empty where they are
  Series gauge;              ///< SI: spread or front (m), plug velocity (m/s), discharged fraction
  Series shear_rate;         ///< 99th percentile, 1/s
  Measures measures;

  /// The profile on `grid` at a time, linear between the recorded ones; none where the run has nothing to
  /// say.
  std::optional<std::vector<double>> profile(double time, const std::vector<double>& grid) const;
  std::optional<double> gauge_at(double time) const;
};

/// The difference of one pair of runs.
struct Pair {
  std::size_t run = 0, reference = 0;
  std::string kind;  ///< "law", "solver", "both", "settings" or "exact": what differs
  struct At {
    double time = 0.0;
    ProfileError error;
    std::optional<double> gauge_difference;  ///< run less reference
  };
  std::vector<At> at;
};

/// The square (finite volumes, material points) x (fluid, elasto-viscoplastic): the whole difference between
/// the fluid in OpenFOAM and the material in MPM, split into what the law does and what the discretisation
/// does.
struct Square {
  /// Indices of the runs; a corner that no run fills is empty.
  std::optional<std::size_t> mpm_solid, mpm_fluid, foam_solid, foam_fluid;
  std::string fluid;  ///< the fluid's model
  /// Differences of the gauge, m or m/s.
  struct At {
    double time = 0.0;
    double total = 0.0;           ///< foam_fluid less mpm_solid
    double law = 0.0;             ///< fluid less solid, the mean of both solvers
    double discretisation = 0.0;  ///< OpenFOAM less MPM, the mean of both laws; law + discretisation = total
    double interaction = 0.0;  ///< half of what the law does in OpenFOAM beyond what it does in MPM: neither
                               ///< can be told closer
    double noise = 0.0;        ///< root sum square of the runs' scatter and of how their edge is read
  };
  std::vector<At> at;
  std::vector<std::string> missing;  ///< commands that make the corners without a run, where they are known
};

/// A sentence of what was found.
struct Finding {
  /// What comes first and carries the warnings; when and where each stops; how far apart they are; which
  /// difference has which cause; cost; references and limits.
  enum class Topic { opening, stop, apart, cause, cost, context };
  Topic topic = Topic::stop;
  std::string text;
};

struct Comparison {
  Thresholds thresholds;
  scenes::Gauges gauges;  ///< what the gauges of the first run are defined by
  words::Grain grain;     ///< the least that is told of lengths, speeds and times
  std::string title;
  const ApparatusReport* apparatus = nullptr;  ///< of all the runs
  bool radial = true;                          ///< profiles are against a radius
  std::vector<RunView> runs;
  std::vector<Pair> pairs;
  std::optional<Square> square;  ///< where at least two of its corners on one side are among the runs
  std::vector<double> grid;      ///< m, common
  std::vector<double> frames;    ///< s, at which profiles are shown and written
  std::vector<double> times;     ///< s, at which pairs are compared
  std::vector<double> stops;     ///< s, arbitrary stops
  double end = 0.0;              ///< s, of the longest run
  double cell = 0.0;             ///< m, the coarsest cell; 0 where none is known
  std::vector<std::string>
      missing;                     ///< runs that the scene names and that are not here, and how to make them
  std::vector<std::string> notes;  ///< what the reader must know before trusting anything
  std::vector<Finding> findings;   ///< what was found, in the order in which it is told
  std::string fair;                ///< which comparison is fair
};

/// Every run directory named: a folder without run.json stands for the runs in it, and in its folders.
/// @throws runs::RunError where there is none.
std::vector<std::filesystem::path> find_runs(const std::vector<std::filesystem::path>&);

/// @throws runs::RunError where a run cannot be read or the runs are of different apparatus.
Comparison compare_runs(const std::vector<std::filesystem::path>&, const Options& = {});

/// The words: findings and fair, from everything else.
void describe(Comparison&);

nlohmann::ordered_json to_json(const Comparison&);

/// Writes comparison.json, measures.csv, profiles.csv, index.html and the gauge of every run: spread.csv,
/// velocity.csv, front.csv or discharged.csv.
void write_comparison(const Comparison&, const std::filesystem::path& report);

/// Writes the page's figures for papers into `report`/figures, as SVG and PNG.
/// @return how many files.
/// @throws runs::MissingProgram where gnuplot is not installed.
std::size_t write_figures(const Comparison&, const std::filesystem::path& report);

/// Writes particles beside cells as a clip, WebM or GIF by its name.
/// @throws runs::RunError where no run left its states; runs::MissingProgram where gnuplot or ffmpeg is not
/// installed.
void write_clip(const Comparison&, const std::filesystem::path& clip);

}  // namespace flowrest::compare
