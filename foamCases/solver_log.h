#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runs/noise.h"

/// Follows interFoam's log while it is written, and judges from it whether the run can be trusted.
namespace flowrest::foam {

/// One time step as the log tells it.
struct SolverStep {
  double time = 0.0;                ///< s, at its end
  double time_step = 0.0;           ///< s
  double courant = 0.0;             ///< largest in the mesh
  double initial_residual_u = 0.0;  ///< the largest of the components that count
  /// What of the velocity's change over the step before the change before that did not foretell, over the
  /// mean speed; nothing where the plug-in does not watch, and in the first steps.
  std::optional<double> chatter = std::nullopt;
  std::optional<double> noise = std::nullopt;  ///< the same as a speed, m/s
};

/// Turns log text, fed in any pieces, into steps; a line counts once it is whole.
class SolverLog {
 public:
  /// `components`: those of U that are solved for; the swirl of a wedge, y, is empty.
  explicit SolverLog(std::string components = "xz") : components_(std::move(components)) {}

  void feed(std::string_view text);

  /// Steps that ended since the last call.
  std::vector<SolverStep> take_steps();

  /// The time the solver last began a step to; what was written for earlier times is complete. s
  std::optional<double> time_begun() const { return time_begun_; }
  bool ended() const { return ended_; }                      ///< by itself, with "End"
  const std::string& build() const { return build_; }        ///< e.g. "OPENFOAM=1912 patch=200626"
  double execution_time() const { return execution_time_; }  ///< s, CPU of one rank
  /// Why the solver cannot go on, from its own message or from a number that is none; empty while all is
  /// well.
  std::string fault() const;
  /// The first line that says that the machine failed the solver, as a full disk does; empty where none does.
  std::string machine_fault() const { return machine_; }

 private:
  void read_line(std::string_view line);
  void read_fault(std::string_view line);

  std::string components_;
  std::string partial_;
  SolverStep step_;
  std::optional<double> chatter_, noise_;  ///< the log tells them after the step's end
  std::vector<SolverStep> steps_;
  std::optional<double> time_begun_;
  double execution_time_ = 0.0;
  bool ended_ = false;
  bool in_step_ = false;
  std::string build_;
  std::string fatal_, machine_;
  int fatal_lines_left_ = 0;
  std::string not_a_number_;
};

/// Reads what a growing file has gained.
class FileTail {
 public:
  explicit FileTail(std::filesystem::path path) : path_(std::move(path)) {}
  /// Empty where there is nothing new, or no file yet.
  std::string read();

 private:
  std::filesystem::path path_;
  std::streamoff at_ = 0;
};

/// The noise monitor. Where splitting or step fail the velocity chatters from step to step, and the chatter
/// can spread the concrete. The plug-in measures it: below 0.01 in a sound run, 0.05 to 4 in a noisy one.
/// Where it does not watch, the initial residual of U tells, by which a sound run stays below 0.02 once the
/// concrete is released (0.07 while it still falls in steps of 18 ms, on 20 mm cells) and a noisy one at 0.2
/// to 1; but it also rises in some runs whose velocity is smooth. Blocks of steps are judged by their median,
/// the first one (the release) not at all. What hardly moves any more chatters at no cost: a run is noisy
/// where the noise of the blocks that chatter could have moved the concrete by a share of the body's height,
/// as in MPM.
class NoiseMonitor {
 public:
  /// A measure of noise, and what a median of it must not pass.
  struct Measure {
    const char* name;
    double bound;
  };
  static constexpr Measure chatter{"chatter of the velocity", 0.05};
  static constexpr Measure residual{"initial residual of U", 0.1};
  static constexpr double path_allowed = runs::noise_path_allowed;
  static constexpr std::size_t block_steps = 50;
  /// What a block cut short by the end must have to be judged.
  static constexpr std::size_t fewest_steps = 10;

  /// `body_height` in m.
  explicit NoiseMonitor(double body_height) : body_height_(body_height) {}

  void add(const SolverStep&);
  /// Judges the block the run ended in.
  void finish();

  /// "sound", "noisy: " with when and how much, or "unjudged: " with why.
  std::string verdict() const;
  /// What the latest block was judged by.
  const Measure& measure() const { return *measure_; }
  double noisy_share() const;  ///< of the blocks judged
  /// By how much noise could have moved the concrete while it passed its bound, m; 0 where only the residual
  /// is known.
  double path() const { return path_; }
  /// Largest median of a block, by what it was judged by, and of the residual in any case.
  double largest_median() const { return largest_median_; }
  double largest_residual_median() const { return largest_residual_median_; }

 private:
  void end_block();
  bool noisy() const;

  double body_height_;
  const Measure* measure_ = &residual;
  std::vector<SolverStep> block_;
  std::size_t blocks_ = 0;
  std::size_t noisy_ = 0;
  double first_noisy_ = 0.0;
  double last_noisy_ = 0.0;
  double largest_median_ = 0.0;
  double largest_residual_median_ = 0.0;
  double path_ = 0.0;
  bool unmeasured_ = false;  ///< noisy in a block whose noise is not known as a speed
};

}  // namespace flowrest::foam
