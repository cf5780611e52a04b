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

#include "foamCases/case_fields.h"
#include "foamCases/case_filler.h"
#include "foamCases/duct_sampler.h"
#include "foamCases/field_file.h"
#include "foamCases/plug_in.h"
#include "foamCases/rest_monitor.h"
#include "foamCases/run_state.h"
#include "foamCases/slump_sampler.h"
#include "foamCases/solver_log.h"
#include "foamCases/vessel_mesh.h"
#include "foamCases/vessel_sampler.h"
#include "runs/process.h"
#include "runs/progress.h"
#include "scenes/step_limits.h"

namespace flowrest::foam {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using runs::Status;
using Json = nlohmann::ordered_json;

namespace {

constexpr double poll_interval = 0.05;  // s
/// A step this much below the largest, this often in succession, gets nowhere.
constexpr double collapsed_step = 1e-5;
constexpr int collapsed_steps = 20;

/// A program and what it is called with.
struct Call {
  fs::path program;
  std::vector<std::string> arguments;
};

/// What makes a case's mesh and initial fields, in order, what cuts it up and puts it together, and what
/// solves it.
struct Programs {
  std::vector<Call> prepare;
  std::optional<Call> decompose, reconstruct;  ///< of a parallel run
  Call solve;
};

fs::path needed_program(const std::string& name) {
  if (const auto found = runs::find_program(name)) return *found;
  throw runs::MissingProgram(fmt::format(
      "{} is not on the PATH: `flowrest foam` needs OpenFOAM (Debian: apt-get install openfoam)", name));
}

Programs needed_programs(const scenes::Scene& scene, int ranks) {
  Programs programs;
  programs.prepare.push_back({needed_program("blockMesh"), {}});
  if (scene.kind == scenes::Kind::slump && scene.geometry.dimension != scenes::Dimension::quarter) {
    programs.prepare.push_back({needed_program("setAlphaField"), {}});
    programs.prepare.push_back({needed_program("setFields"), {}});
  }
  if (gate_of(scene)) programs.prepare.push_back({needed_program("createBaffles"), {"-overwrite"}});
  if (is_vessel(scene)) programs.prepare.push_back({needed_program("setFields"), {}});
  programs.solve = {needed_program("interFoam"), {}};
  if (ranks <= 1) return programs;
  programs.decompose = Call{needed_program("decomposePar"), {"-force", "-latestTime"}};
  programs.reconstruct = Call{needed_program("reconstructPar"), {"-newTimes"}};
  // More ranks than cores must not spin against each other.
  programs.solve = {needed_program("mpirun"),
                    {"--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1", "-np",
                     std::to_string(ranks), programs.solve.program.string(), "-parallel"}};
  return programs;
}

std::unique_ptr<Sampler> make_sampler(const scenes::Scene& scene, const CaseFields& fields,
                                      runs::RunWriter& writer, bool plug_in) {
  if (is_vessel(scene)) return std::make_unique<VesselSampler>(scene, fields, writer, plug_in);
  if (scene.kind == scenes::Kind::duct) return std::make_unique<DuctSampler>(scene, fields, writer, plug_in);
  return std::make_unique<SlumpSampler>(scene, fields, writer, plug_in);
}

/// Debian's OpenFOAM needs to be told where its etc folder is, and nothing else; Open MPI that root may use
/// it.
std::map<std::string, std::string> openfoam_environment() {
  static const char* folder = "/usr/share/openfoam";
  std::map<std::string, std::string> environment{{"OMPI_ALLOW_RUN_AS_ROOT", "1"},
                                                 {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"}};
  if (std::getenv("WM_PROJECT_DIR") == nullptr && fs::exists(fs::path(folder) / "etc"))
    environment["WM_PROJECT_DIR"] = folder;
  return environment;
}

/// Components of the velocity that a case solves for: those whose residuals tell of noise.
std::string components(const scenes::Scene& scene) {
  return scene.geometry.dimension == scenes::Dimension::quarter ||
                 scene.geometry.dimension == scenes::Dimension::half
             ? "xyz"
             : "xz";
}

/// Which of the scene's walls the case does not have, in words; empty where it has them all.
std::string walls_differ(const scenes::Scene& scene) {
  if (scene.kind == scenes::Kind::slump && scene.slump().mould_lift_velocity)
    return "no mould: the cone is released at once";
  return "";
}

/// How the steps are bounded, in words.
std::string step_rule(const scenes::Scene& scene, bool plug_in) {
  const char* bound = "cell^2 density / plastic viscosity";
  if (scene.foam.max_time_step) {
    bound = "foam.max_time_step";
  } else if (scene.material.model == scenes::Model::elasto_viscoplastic) {
    bound = "1.5 cells at the speed of shear waves";
  }
  const double first = scenes::largest_foam_step(scene), most = scenes::grown_foam_step(scene);
  std::string rule = fmt::format("Courant number at most {:g}, step at most {:.4g} s ({})",
                                 scene.foam.max_courant, first, bound);
  if (plug_in && most > first)
    rule += fmt::format(" or, where that is more, 1/{:g} of the time passed, up to {:.4g} s",
                        1.0 / scenes::foam_step_of_time, most);
  return rule;
}

void remove_parts(const fs::path& case_directory) {
  for (int rank = CaseFields::ranks_in(case_directory); rank-- > 0;)
    fs::remove_all(case_directory / fmt::format("processor{}", rank));
}

/// One run from the filled case, or from the state it is gone on from, to the summary.
class CaseRun {
 public:
  CaseRun(const scenes::Scene& scene, const RunOptions& options, Programs programs,
          const std::optional<RunState>& state = std::nullopt)
      : scene_(scene),
        options_(options),
        programs_(std::move(programs)),
        state_(state),
        writer_(state ? runs::RunWriter::resume(options.directory, scene, state->time)
                      : runs::RunWriter(options.directory, scene, "foam")),
        case_(options.directory / "case"),
        plug_in_(plug_in_for(scene)),
        rest_(scene),
        progress_(fmt::format("foam {}", scenes::to_string(scene.material.model)), scene.time.end,
                  options.quiet) {}

  RunOutcome run() {
    const runs::InterruptGuard guard;
    try {
      begin();
      if (prepare()) solve();
      put_together();
    } catch (const std::exception& fault) {
      fail(fault.what());
    }
    summarise();
    return {status_, reason_, verdict(), time(), gauges()};
  }

 private:
  double time() const { return sampler_ ? sampler_->time() : 0.0; }
  nlohmann::ordered_json gauges() const {
    return sampler_ ? sampler_->summary() : nlohmann::ordered_json::object();
  }
  /// Of the noise, and of what the flow must keep.
  std::string verdict() const {
    const std::string noise = monitor_.verdict(), doubt = sampler_ ? sampler_->doubt() : "";
    if (doubt.empty()) return noise;
    return noise.starts_with("noisy") ? fmt::format("{}; {}", noise, doubt) : "noisy: " + doubt;
  }
  std::size_t cells() const { return sampler_ ? sampler_->cells() : 0; }

  /// The first reason is the one that counts.
  void fail(const std::string& reason) {
    if (status_ == Status::failed) return;
    status_ = Status::failed;
    reason_ = reason;
  }

  void begin() {
    if (!state_) fill_case(scene_, case_, plug_in_, options_.ranks);
    sampler_ = make_sampler(scene_, CaseFields(case_, options_.ranks), writer_, plug_in_.has_value());
    if (state_) go_on();
    auto& info = writer_.info();
    info["cells"] = sampler_->cells();
    info["ranks"] = options_.ranks;
    if (const std::string differ = walls_differ(scene_); !differ.empty()) info["walls_differ"] = differ;
    writer_.write();
  }

  /// Counts what the run has behind it as if it had just been followed.
  void go_on() {
    if (const fs::path history = options_.directory / "history.csv"; fs::exists(history))
      sampler_->continue_from(runs::read_csv(history));
    for (const auto& step : state_->steps) tally(step);
    cpu_by_program_ = state_->cpu_by_program;
    wall_before_ = state_->wall;
  }

  /// Mesh and initial fields, and their parts. False where it went wrong or was interrupted.
  bool prepare() {
    const auto done = [&](const Call& call) { return run_to_end(call); };
    if (!state_ && !std::all_of(programs_.prepare.begin(), programs_.prepare.end(), done)) return false;
    return !programs_.decompose || done(*programs_.decompose);
  }

  /// One case again, whatever became of the run; where that fails the parts stay.
  void put_together() {
    if (!programs_.reconstruct || !fs::exists(case_ / "processor0")) return;
    const fs::path log_path = case_ / "log.reconstructPar";
    runs::Process process(programs_.reconstruct->program, programs_.reconstruct->arguments, case_, log_path,
                          openfoam_environment());
    while (!process.wait(poll_interval)) {
    }
    cpu_by_program_["reconstructPar"] += process.poll()->cpu_s;
    if (process.poll()->good()) {
      remove_parts(case_);
    } else if (status_ != Status::failed) {
      fail(fmt::format("reconstructPar ended with {}", process.poll()->how()));
    }
  }

  bool run_to_end(const Call& call) {
    const std::string name = call.program.filename().string();
    const fs::path log_path = case_ / ("log." + name);
    runs::Process process(call.program, call.arguments, case_, log_path, openfoam_environment());
    while (!process.wait(poll_interval))
      if (runs::InterruptGuard::count() > 0) {
        status_ = Status::interrupted;
        return false;
      }
    cpu_by_program_[name] += process.poll()->cpu_s;
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
    runs::Process solver(programs_.solve.program, programs_.solve.arguments, case_, log_path,
                         openfoam_environment());
    FileTail tail(log_path);
    bool running = true;
    while (running) {
      running = !solver.wait(poll_interval);
      follow(tail.read(), running);
      if (!running) break;
      if (runs::InterruptGuard::count() > 0) {
        status_ = Status::interrupted;
        stop(solver);
      } else if (status_ == Status::failed || status_ == Status::at_rest) {
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
    tally(step);
    small_steps_ = step.time_step < collapsed_step * scenes::largest_foam_step(scene_) ? small_steps_ + 1 : 0;
    if (small_steps_ == collapsed_steps)
      fail(fmt::format("the time step collapsed to {:.2g} s at {:.4g} s: the flow diverges", step.time_step,
                       step.time));
  }

  void tally(const SolverStep& step) {
    monitor_.add(step);
    ++steps_;
    max_courant_ = std::max(max_courant_, step.courant);
    max_time_step_ = std::max(max_time_step_, step.time_step);
  }

  /// Ends a run that can give no answer any more.
  void watch() {
    if (const auto fault = log_.fault(); !fault.empty())
      fail(fmt::format("interFoam at {:.4g} s: {}", log_.time_begun().value_or(0.0), fault));
    if (const auto fault = sampler_->fault(); !fault.empty()) fail(fault);
    if (sampler_->time() > 0.0 && status_ == Status::running) {
      rest_.add(sampler_->time(), sampler_->shear_rate());
      if (rest_.at_rest()) status_ = Status::at_rest;
    }
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
    cpu_by_program_["interFoam"] += end.cpu_s;
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
    const double wall = wall_before_ + std::chrono::duration<double>(Clock::now() - start_).count();
    if (status_ == Status::interrupted && reason_.empty())
      reason_ = fmt::format("interrupted at {:.4g} s; go on with: flowrest foam --resume {}", time(),
                            options_.directory.string());
    write_info(wall);
    writer_.finish(status_, reason_, verdict());
    progress_.finish(
        fmt::format("{} at {:.4g} s, {}, {}; {} steps, {:.3g} steps/s, {:.3g} cell-steps/s, {:.4g} "
                    "simulated s an hour",
                    runs::to_string(status_), time(), sampler_ ? sampler_->progress() : "nothing run",
                    verdict(), steps_, static_cast<double>(steps_) / wall,
                    static_cast<double>(steps_ * cells()) / wall, 3600.0 * time() / wall));
  }

  void write_info(double wall) {
    auto& info = writer_.info();
    cpu_by_program_["flowrest"] += runs::cpu_seconds() - own_cpu_before_;
    double cpu = 0.0;
    for (const auto& [program, seconds] : cpu_by_program_) cpu += seconds;
    if (!log_.build().empty()) info["openfoam"] = log_.build();
    info["laws"] = plug_in_ ? "plug-in" : "built-in";
    info["time_reached_s"] = time();
    info["steps"] = steps_;
    info["wall_s"] = wall;
    info["cpu_s"] = cpu;
    info["cpu_by_program_s"] = cpu_by_program_;
    info["cell_steps_per_cpu_s"] = static_cast<double>(steps_ * cells()) / cpu;
    info["cpu_s_per_simulated_s"] = time() > 0.0 ? Json(cpu / time()) : Json();
    const auto growth = rest_.growth_to_come();
    info["growth_to_come"] = growth ? Json(*growth) : Json();
    const auto rest_time = rest_.rest_time();
    info["rest_time_s"] = rest_time ? Json(*rest_time) : Json();  // a fluid has none
    info.update(gauges());
    info["courant_max"] = max_courant_;
    info["time_step_max_s"] = max_time_step_;
    info["time_step_rule"] = step_rule(scene_, plug_in_.has_value());
    info["noise"] = {{"measure", fmt::format("{}, median of blocks of steps", monitor_.measure().name)},
                     {"block_steps", NoiseMonitor::block_steps},
                     {"bound", monitor_.measure().bound},
                     {"largest_median", monitor_.largest_median()},
                     {"largest_residual_median", monitor_.largest_residual_median()},
                     {"noisy_share", monitor_.noisy_share()},
                     {"path_m", monitor_.path()},
                     {"path_allowed_m", NoiseMonitor::path_allowed * scene_.body_height()}};
  }

  const scenes::Scene& scene_;
  const RunOptions& options_;
  Programs programs_;
  std::optional<RunState> state_;
  runs::RunWriter writer_;
  fs::path case_;
  std::optional<fs::path> plug_in_;
  RestMonitor rest_;
  runs::Progress progress_;
  std::unique_ptr<Sampler> sampler_;
  SolverLog log_{components(scene_)};
  NoiseMonitor monitor_{scene_.body_height()};
  Status status_ = Status::running;
  std::string reason_;
  std::size_t steps_ = 0;
  double max_courant_ = 0.0;
  double max_time_step_ = 0.0;
  int small_steps_ = 0;
  std::map<std::string, double> cpu_by_program_;
  Clock::time_point start_ = Clock::now();
  double wall_before_ = 0.0;
  double own_cpu_before_ = runs::cpu_seconds();
};

void check_ranks(const scenes::Scene& scene, int ranks) {
  if (ranks > 1 && scene.kind == scenes::Kind::duct)
    throw scenes::SceneError(
        fmt::format("{}: --ranks {}: a duct is one column of cells; allowed: 1", scene.path.string(), ranks));
}

RunOutcome finished(const RunOutcome& outcome, const RunOptions& options) {
  if (outcome.status == Status::failed)
    throw runs::NumericsError(
        fmt::format("{}; the logs are in {}", outcome.reason, (options.directory / "case").string()));
  return outcome;
}

}  // namespace

RunOutcome run_scene(const scenes::Scene& given, const RunOptions& options) {
  // What is missing is said before anything is written.
  const scenes::Scene scene = settled(given, plug_in_for(given).has_value());
  check_supported(scene);
  check_ranks(scene, options.ranks);
  return finished(CaseRun(scene, options, needed_programs(scene, options.ranks)).run(), options);
}

RunOutcome resume_run(const RunOptions& options) {
  const EarlierRun earlier = read_earlier_run(options.directory);
  check_ranks(earlier.scene, options.ranks);
  plug_in_for(earlier.scene);
  const Programs programs = needed_programs(earlier.scene, options.ranks);
  const fs::path case_directory = options.directory / "case";
  if (CaseFields::ranks_in(case_directory) > 1) {
    // It was cut off before its parts were put together.
    remove_cut_off_times(case_directory, earlier.scene);
    const fs::path log = case_directory / "log.reconstructPar";
    runs::Process process(needed_program("reconstructPar"), {"-newTimes"}, case_directory, log,
                          openfoam_environment());
    while (!process.wait(poll_interval)) {
    }
    if (!process.poll()->good())
      throw runs::RunError(
          fmt::format("{}: its parts cannot be put together: reconstructPar ended with {} ({})",
                      case_directory.string(), process.poll()->how(), log.string()));
    remove_parts(case_directory);
  }
  const auto state = latest_state(options.directory, earlier);
  if (!state) return run_scene(earlier.scene, options);
  fill_parameters(earlier.scene, case_directory, earlier.plug_in, options.ranks);
  return finished(CaseRun(earlier.scene, options, programs, state).run(), options);
}

}  // namespace flowrest::foam
