#include "foamCases/foam_run.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "foamCases/case_filler.h"
#include "foamCases/duct_sampler.h"
#include "foamCases/field_file.h"
#include "foamCases/plug_in.h"
#include "foamCases/slump_sampler.h"
#include "foamCases/solver_log.h"
#include "runs/process.h"
#include "runs/progress.h"
#include "scenes/step_limits.h"

namespace flowrest::foam {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using runs::Status;

namespace {

constexpr double poll_interval = 0.05;  // s
/// A step this much below the largest, this often in succession, gets nowhere.
constexpr double collapsed_step = 1e-5;
constexpr int collapsed_steps = 20;

/// What makes a case's mesh and initial fields, in order, and what solves it.
struct Programs {
  std::vector<fs::path> prepare;
  fs::path inter_foam;
};

fs::path needed_program(const std::string& name) {
  if (const auto found = runs::find_program(name)) return *found;
  throw runs::MissingProgram(fmt::format(
      "{} is not on the PATH: `flowrest foam` needs OpenFOAM (Debian: apt-get install openfoam)", name));
}

/// @throws SceneError
void refuse_what_no_case_has(const scenes::Scene& scene) {
  const auto refuse = [&](const std::string& what) {
    throw scenes::SceneError(
        fmt::format("{}: OpenFOAM has no {} yet; allowed: slumps and ducts between walls without "
                    "friction, without a mould",
                    scene.path.string(), what));
  };
  if (scene.kind != scenes::Kind::slump && scene.kind != scenes::Kind::duct)
    refuse("case of a " + scenes::to_string(scene.kind));
  if (scene.base.law == scenes::Wall::friction) refuse("wall with friction");
  if (scene.kind == scenes::Kind::slump && scene.slump().mould_lift_velocity) refuse("mould that is lifted");
}

Programs needed_programs(const scenes::Scene& scene) {
  if (scene.kind == scenes::Kind::duct) return {{needed_program("blockMesh")}, needed_program("interFoam")};
  return {{needed_program("blockMesh"), needed_program("setAlphaField"), needed_program("setFields")},
          needed_program("interFoam")};
}

std::unique_ptr<Sampler> make_sampler(const scenes::Scene& scene, const fs::path& case_directory,
                                      runs::RunWriter& writer) {
  if (scene.kind == scenes::Kind::duct) return std::make_unique<DuctSampler>(scene, case_directory, writer);
  return std::make_unique<SlumpSampler>(scene, case_directory, writer);
}

/// Debian's OpenFOAM needs to be told where its etc folder is, and nothing else.
std::map<std::string, std::string> openfoam_environment() {
  static const char* folder = "/usr/share/openfoam";
  if (std::getenv("WM_PROJECT_DIR") != nullptr || !fs::exists(fs::path(folder) / "etc")) return {};
  return {{"WM_PROJECT_DIR", folder}};
}

/// One run from the filled case to the summary.
class CaseRun {
 public:
  CaseRun(const scenes::Scene& scene, const RunOptions& options, Programs programs)
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
      sampler_ = make_sampler(scene_, case_, writer_);
      writer_.info()["cells"] = sampler_->cells();
      if (prepare()) solve();
    } catch (const std::exception& fault) {
      fail(fault.what());
    }
    summarise();
    return {status_, reason_, monitor_.verdict(), time(), gauges()};
  }

 private:
  double time() const { return sampler_ ? sampler_->time() : 0.0; }
  nlohmann::ordered_json gauges() const {
    return sampler_ ? sampler_->summary() : nlohmann::ordered_json::object();
  }
  std::size_t cells() const { return sampler_ ? sampler_->cells() : 0; }

  /// The first reason is the one that counts.
  void fail(const std::string& reason) {
    if (status_ == Status::failed) return;
    status_ = Status::failed;
    reason_ = reason;
  }

  /// Mesh and initial fields. False where it went wrong or was interrupted.
  bool prepare() {
    return std::all_of(programs_.prepare.begin(), programs_.prepare.end(),
                       [&](const fs::path& program) { return run_to_end(program); });
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
    progress_.update(time(), fmt::format("{:.2f} s, {}", time(), sampler_->progress()));
  }

  void count(const SolverStep& step) {
    sampler_->note(step);
    monitor_.add(step);
    ++steps_;
    max_courant_ = std::max(max_courant_, step.courant);
    max_time_step_ = std::max(max_time_step_, step.time_step);
    small_steps_ = step.time_step < collapsed_step * scenes::largest_foam_step(scene_) ? small_steps_ + 1 : 0;
    if (small_steps_ == collapsed_steps)
      fail(fmt::format("the time step collapsed to {:.2g} s at {:.4g} s: the flow diverges", step.time_step,
                       step.time));
  }

  /// Ends a run that can give no answer any more.
  void watch() {
    if (const auto fault = log_.fault(); !fault.empty())
      fail(fmt::format("interFoam at {:.4g} s: {}", log_.time_begun().value_or(0.0), fault));
    if (const auto fault = sampler_->fault(); !fault.empty()) fail(fault);
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
      reason_ = fmt::format("interrupted at {:.4g} s", time());
    write_info(wall);
    writer_.finish(status_, reason_, monitor_.verdict());
    progress_.finish(
        fmt::format("{} at {:.4g} s, {}, {}; {} steps, {:.3g} steps/s, {:.3g} cell-steps/s, {:.4g} "
                    "simulated s an hour",
                    runs::to_string(status_), time(), sampler_ ? sampler_->progress() : "nothing run",
                    monitor_.verdict(), steps_, static_cast<double>(steps_) / wall,
                    static_cast<double>(steps_ * cells()) / wall, 3600.0 * time() / wall));
  }

  void write_info(double wall) {
    auto& info = writer_.info();
    double cpu = runs::cpu_seconds() - own_cpu_before_;
    cpu_by_program_["flowrest"] = cpu;
    for (const auto& [program, seconds] : cpu_by_program_)
      if (program != "flowrest") cpu += seconds;
    info["openfoam"] = log_.build();
    info["laws"] = plug_in_ ? "plug-in" : "built-in";
    info["time_reached_s"] = time();
    info["steps"] = steps_;
    info["wall_s"] = wall;
    info["cpu_s"] = cpu;
    info["cpu_by_program_s"] = cpu_by_program_;
    info["cell_steps_per_cpu_s"] = static_cast<double>(steps_ * cells()) / cpu;
    info["rest_time_s"] = nullptr;  // a fluid is never at rest
    info.update(gauges());
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
  std::unique_ptr<Sampler> sampler_;
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
  refuse_what_no_case_has(scene);
  const auto outcome = CaseRun(scene, options, needed_programs(scene)).run();
  if (outcome.status == Status::failed)
    throw runs::NumericsError(
        fmt::format("{}; the logs are in {}", outcome.reason, (options.directory / "case").string()));
  return outcome;
}

}  // namespace flowrest::foam
