#include "foamCases/foam_run.h"

#include <fmt/format.h>
#include <signal.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>

#include "foamCases/case_filler.h"
#include "foamCases/field_file.h"
#include "foamCases/plug_in.h"
#include "foamCases/slump_sampler.h"
#include "foamCases/solver_log.h"
#include "foamCases/wedge_grid.h"
#include "runs/process.h"
#include "runs/progress.h"

namespace flowrest::foam {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using runs::Status;

namespace {

constexpr double poll_interval = 0.05;    // s
constexpr double rim_depth_bound = 3e-3;  // m, the depth at which the spread is read
constexpr double volume_bound = 0.1;      // relative; a bounded phase fraction keeps the volume to 1e-6
/// A step this much below the largest, this often in succession, gets nowhere.
constexpr double collapsed_step = 1e-5;
constexpr int collapsed_steps = 20;

struct Programs {
  fs::path block_mesh, set_alpha_field, set_fields, inter_foam;
};

fs::path needed_program(const std::string& name) {
  if (const auto found = runs::find_program(name)) return *found;
  throw runs::MissingProgram(fmt::format(
      "{} is not on the PATH: `flowrest foam` needs OpenFOAM (Debian: apt-get install openfoam)", name));
}

Programs needed_programs() {
  return {needed_program("blockMesh"), needed_program("setAlphaField"), needed_program("setFields"),
          needed_program("interFoam")};
}

/// Debian's OpenFOAM needs to be told where its etc folder is, and nothing else.
std::map<std::string, std::string> openfoam_environment() {
  static const char* folder = "/usr/share/openfoam";
  if (std::getenv("WM_PROJECT_DIR") != nullptr || !fs::exists(fs::path(folder) / "etc")) return {};
  return {{"WM_PROJECT_DIR", folder}};
}

/// One run from the filled case to the summary.
class SlumpRun {
 public:
  SlumpRun(const scenes::Scene& scene, const RunOptions& options, Programs programs)
      : scene_(scene),
        options_(options),
        programs_(std::move(programs)),
        writer_(options.directory, scene, "foam"),
        case_(options.directory / "case"),
        plug_in_(plug_in_for(scene)),
        progress_(fmt::format("foam {}", scenes::to_string(scene.material.model)), scene.time.end,
                  options.quiet) {}

  RunOutcome run() {
    const runs::InterruptGuard guard;
    try {
      fill_case(scene_, case_, plug_in_);
      writer_.info()["cells"] = wedge_grid(scene_).cells();
      if (prepare()) solve();
    } catch (const std::exception& fault) {
      fail(fault.what());
    }
    summarise();
    return {status_, reason_, monitor_.verdict(), state().time, state().spread};
  }

 private:
  SlumpState state() const { return sampler_ ? sampler_->state() : SlumpState{}; }

  /// The first reason is the one that counts.
  void fail(const std::string& reason) {
    if (status_ == Status::failed) return;
    status_ = Status::failed;
    reason_ = reason;
  }

  /// Mesh and initial fields. False where it went wrong or was interrupted.
  bool prepare() {
    return run_to_end(programs_.block_mesh) && run_to_end(programs_.set_alpha_field) &&
           run_to_end(programs_.set_fields);
  }

  bool run_to_end(const fs::path& program) {
    const std::string name = program.filename().string();
    const fs::path log_path = case_ / ("log." + name);
    runs::Process process(program, {}, case_, log_path, openfoam_environment());
    while (!process.wait(poll_interval))
      if (runs::InterruptGuard::count() > 0) {
        status_ = Status::interrupted;
        return false;
      }
    cpu_by_program_[name] = process.poll()->cpu_s;
    if (process.poll()->good()) return true;
    SolverLog log;
    log.feed(FileTail(log_path).read());
    fail(fmt::format("{} ended with {}{}", name, process.poll()->how(),
                     log.fault().empty() ? "" : ": " + log.fault()));
    return false;
  }

  void solve() {
    sampler_.emplace(scene_, case_, writer_);
    sampler_->sample_before(std::numeric_limits<double>::min());  // the initial fields
    const fs::path log_path = case_ / "log.interFoam";
    runs::Process solver(programs_.inter_foam, {}, case_, log_path, openfoam_environment());
    FileTail tail(log_path);
    bool running = true;
    while (running) {
      running = !solver.wait(poll_interval);
      follow(tail.read(), running);
      if (!running) break;
      if (runs::InterruptGuard::count() > 0) {
        status_ = Status::interrupted;
        stop(solver);
      } else if (status_ == Status::failed) {
        stop(solver);
      } else {
        continue;
      }
      follow(tail.read(), false);
      running = false;
    }
    conclude(*solver.poll());
  }

  /// Takes in what the log has gained, and what the solver has written.
  void follow(const std::string& text, bool running) {
    log_.feed(text);
    for (const auto& step : log_.take_steps()) count(step);
    try {
      sampler_->sample_before(running ? log_.time_begun().value_or(0.0)
                                      : std::numeric_limits<double>::infinity());
    } catch (const FieldError& fault) {
      // The last directory of a solver that was cut off may be half written; in a running one it must be
      // whole.
      if (running) fail(fault.what());
    }
    watch();
    progress_.update(state().time,
                     fmt::format("{:.2f} s, spread {:.1f} mm", state().time, 1e3 * state().spread));
  }

  void count(const SolverStep& step) {
    sampler_->note(step);
    monitor_.add(step);
    ++steps_;
    max_courant_ = std::max(max_courant_, step.courant);
    max_time_step_ = std::max(max_time_step_, step.time_step);
    small_steps_ = step.time_step < collapsed_step * largest_time_step(scene_) ? small_steps_ + 1 : 0;
    if (small_steps_ == collapsed_steps)
      fail(fmt::format("the time step collapsed to {:.2g} s at {:.4g} s: the flow diverges", step.time_step,
                       step.time));
  }

  /// Ends a run that can give no answer any more.
  void watch() {
    if (const auto fault = log_.fault(); !fault.empty())
      fail(fmt::format("interFoam at {:.4g} s: {}", log_.time_begun().value_or(0.0), fault));
    const auto now = state();
    if (now.rim_depth > rim_depth_bound)
      fail(fmt::format(
          "the concrete reached the rim of the mesh at {:.4g} s: geometry.domain_radius = {:g} m must be "
          "larger",
          now.time, scene_.slump().domain_radius));
    if (!(now.volume_error < volume_bound))
      fail(fmt::format("the volume of concrete is off by {:.0f} % at {:.4g} s: the flow diverges",
                       100.0 * now.volume_error, now.time));
  }

  /// Asks the solver to end its step and write; insists where it does not, or where the user asks again.
  void stop(runs::Process& solver) {
    const auto deadline = Clock::now() + std::chrono::duration<double>(options_.grace);
    const int asked = runs::InterruptGuard::count();
    solver.signal(SIGUSR2);
    while (Clock::now() < deadline && runs::InterruptGuard::count() <= asked)
      if (solver.wait(poll_interval)) return;
    solver.signal(SIGTERM);
    if (solver.wait(1.0)) return;
    solver.signal(SIGKILL);
    while (!solver.wait(1.0)) {
    }
  }

  void conclude(const runs::ProcessEnd& end) {
    cpu_by_program_["interFoam"] = end.cpu_s;
    if (status_ != Status::running) return;
    if (!end.good()) {
      fail(fmt::format("interFoam ended with {}", end.how()));
    } else if (!log_.ended() || steps_ == 0) {
      fail("interFoam stopped before its end time");
    } else {
      status_ = Status::end_time;
    }
  }

  void summarise() {
    monitor_.finish();
    const double wall = std::chrono::duration<double>(Clock::now() - start_).count();
    if (status_ == Status::interrupted && reason_.empty())
      reason_ = fmt::format("interrupted at {:.4g} s", state().time);
    write_info(wall);
    writer_.finish(status_, reason_, monitor_.verdict());
    progress_.finish(fmt::format(
        "{} at {:.4g} s, spread {:.1f} mm, {}; {} steps, {:.3g} steps/s, {:.3g} cell-steps/s, {:.4g} "
        "simulated s an hour",
        runs::to_string(status_), state().time, 1e3 * state().spread, monitor_.verdict(), steps_,
        static_cast<double>(steps_) / wall, static_cast<double>(steps_ * wedge_grid(scene_).cells()) / wall,
        3600.0 * state().time / wall));
  }

  void write_info(double wall) {
    auto& info = writer_.info();
    const auto now = state();
    double cpu = runs::cpu_seconds() - own_cpu_before_;
    cpu_by_program_["flowrest"] = cpu;
    for (const auto& [program, seconds] : cpu_by_program_)
      if (program != "flowrest") cpu += seconds;
    info["openfoam"] = log_.build();
    info["laws"] = plug_in_ ? "plug-in" : "built-in";
    info["time_reached_s"] = now.time;
    info["steps"] = steps_;
    info["wall_s"] = wall;
    info["cpu_s"] = cpu;
    info["cpu_by_program_s"] = cpu_by_program_;
    info["cell_steps_per_cpu_s"] = static_cast<double>(steps_ * wedge_grid(scene_).cells()) / cpu;
    info["rest_time_s"] = nullptr;  // a fluid is never at rest
    info["spread_mm"] = 1e3 * now.spread;
    info["front_mm"] = 1e3 * now.front;
    info["height_mm"] = 1e3 * now.height;
    info["initial_volume_error"] = now.first_volume / scene_.slump().volume() - 1.0;
    info["volume_error"] = now.volume_error;
    info["courant_max"] = max_courant_;
    info["time_step_max_s"] = max_time_step_;
    info["noise"] = {{"measure", "initial residual of U, median of blocks of steps"},
                     {"block_steps", NoiseMonitor::block_steps},
                     {"bound", NoiseMonitor::bound},
                     {"largest_median", monitor_.largest_median()},
                     {"noisy_share", monitor_.noisy_share()}};
  }

  const scenes::Scene& scene_;
  const RunOptions& options_;
  Programs programs_;
  runs::RunWriter writer_;
  fs::path case_;
  std::optional<fs::path> plug_in_;
  runs::Progress progress_;
  std::optional<SlumpSampler> sampler_;
  SolverLog log_;
  NoiseMonitor monitor_;
  Status status_ = Status::running;
  std::string reason_;
  std::size_t steps_ = 0;
  double max_courant_ = 0.0;
  double max_time_step_ = 0.0;
  int small_steps_ = 0;
  std::map<std::string, double> cpu_by_program_;
  Clock::time_point start_ = Clock::now();
  double own_cpu_before_ = runs::cpu_seconds();
};

}  // namespace

RunOutcome run_scene(const scenes::Scene& scene, const RunOptions& options) {
  check_supported(scene);
  plug_in_for(scene);  // it says what is missing before anything is written
  const auto outcome = SlumpRun(scene, options, needed_programs()).run();
  if (outcome.status == Status::failed)
    throw runs::NumericsError(
        fmt::format("{}; the logs are in {}", outcome.reason, (options.directory / "case").string()));
  return outcome;
}

}  // namespace flowrest::foam
