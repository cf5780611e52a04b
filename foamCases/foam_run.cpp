#include "foamCases/foam_run.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "foamCases/apparatus/apparatus.h"
#include "foamCases/case_fields.h"
#include "foamCases/case_filler.h"
#include "foamCases/cost.h"
#include "foamCases/field_file.h"
#include "foamCases/hand_over.h"
#include "foamCases/openfoam.h"
#include "foamCases/plug_in.h"
#include "foamCases/ranks.h"
#include "foamCases/run_state.h"
#include "foamCases/solver_log.h"
#include "foamCases/step_rules.h"
#include "runs/command.h"
#include "runs/console.h"
#include "runs/cores.h"
#include "runs/machine.h"
#include "runs/process.h"
#include "runs/progress.h"
#include "runs/rest.h"
#include "runs/run_folder.h"
#include "runs/temporary_folder.h"
#include "runs/verdict.h"
#include "scenes/pieces.h"

namespace flowrest::foam {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using runs::Status;
using Json = nlohmann::ordered_json;

namespace {

constexpr double poll_interval = 0.05;  // s
/// By what share the concrete in the mesh may differ from the scene's body at the start: all cases fill it to
/// round-off.
constexpr double initial_volume_allowed = 1e-3;
/// A step this much below the largest, this often in succession, gets nowhere.
constexpr double collapsed_step = 1e-5;
constexpr int collapsed_steps = 20;

constexpr const char* overstresses_header = "time_s,overstress\n";

/// A program and what it is called with.
struct Call {
  fs::path program;
  std::vector<std::string> arguments;
  bool parallel = false;  ///< under mpirun, which tells its ranks the real path of the folder it is in
};

/// What makes a case's mesh and initial fields, in order, what cuts it up and puts it together, and what
/// solves it.
struct Programs {
  std::vector<Call> prepare;
  std::optional<Call> decompose, reconstruct;  ///< of a parallel run
  Call solve;
};

/// `from_state`: the initial fields are those of a state, which no program makes.
Programs needed_programs(const ApparatusCase& apparatus, int ranks, bool from_state) {
  Programs programs;
  programs.prepare.push_back({openfoam_program("blockMesh"), {}});
  for (const Utility& utility : from_state ? std::vector<Utility>{} : apparatus.utilities())
    programs.prepare.push_back({openfoam_program(utility.program), utility.arguments});
  programs.solve = {openfoam_program("interFoam"), {}};
  if (ranks <= 1) return programs;
  programs.decompose = Call{openfoam_program("decomposePar"), {"-force", "-latestTime"}};
  programs.reconstruct = Call{openfoam_program("reconstructPar"), {"-newTimes"}};
  // More ranks than cores must not spin against each other.
  programs.solve = {openfoam_mpirun(),
                    {"--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1", "-np",
                     std::to_string(ranks), programs.solve.program.string(), "-parallel"},
                    true};
  return programs;
}

/// How the steps are bounded, in words.
std::string step_rule(const ApparatusCase& apparatus, bool plug_in) {
  const scenes::Scene& scene = apparatus.scene();
  const char* bound = "cell^2 density / plastic viscosity";
  if (scene.foam.max_time_step) {
    bound = "foam.max_time_step";
  } else if (laws::can_rest(scene.material.model)) {
    bound = "1.5 cells at the speed of shear waves";
  }
  const double first = largest_step(apparatus), most = grown_step(apparatus);
  std::string rule = fmt::format("Courant number at most {:g}, step at most {:.4g} s ({})",
                                 scene.foam.max_courant, first, bound);
  if (plug_in && most > first)
    rule += fmt::format(" or, where that is more, 1/{:g} of the time passed, up to {:.4g} s",
                        1.0 / step_of_time, most);
  return rule;
}

/// A program of OpenFOAM's at work on a case, which it is told by a name that it can read.
/// What the cases' control dictionaries watch for: interFoam ends its step, writes and stops.
constexpr const char* stop_file = "stop";

std::unique_ptr<runs::Process> start(const Call& call, const runs::PlainName& place, const fs::path& log) {
  auto arguments = call.arguments;
  arguments.insert(arguments.end(), {"-case", place.path().string()});
  return std::make_unique<runs::Process>(call.program, arguments,
                                         call.parallel ? place.plain_folder() : place.path(), log,
                                         openfoam_environment());
}

void remove_parts(const fs::path& case_directory) {
  for (int rank = CaseFields::ranks_in(case_directory); rank-- > 0;)
    fs::remove_all(case_directory / fmt::format("processor{}", rank));
}

using Start = std::optional<runs::MaterialState>;

/// One run from the filled case, or from the state it is gone on from, to the summary.
class CaseRun {
 public:
  /// `start`: what the run begins with in place of the scene's body; `state`: where it is gone on from.
  CaseRun(const scenes::Scene& scene, const RunOptions& options, Programs programs, runs::RunWriter writer,
          const Start& begins_with, const std::optional<RunState>& state = std::nullopt)
      : scene_(scene),
        apparatus_(case_of(scene)),
        options_(options),
        programs_(std::move(programs)),
        begins_with_(begins_with),
        state_(state),
        place_(options.directory / "case"),
        writer_(std::move(writer)),
        case_(options.directory / "case"),
        plug_in_(plug_in_for(scene)),
        rest_(scene),
        progress_(fmt::format("foam {}", scenes::to_string(scene.material.model)), scene.time.end,
                  options.quiet) {}

  RunOutcome run() {
    const runs::InterruptGuard guard;
    try {
      begin();
      if (status_ == Status::at_rest) {
        sampler_->sample_before(std::numeric_limits<double>::infinity());
      } else if (prepare()) {
        solve();
      }
      put_together();
      // So that it can be prolonged.
      if (status_ == Status::end_time) complete_last_state(case_, last_step_, time_step_before_, steps_);
    } catch (const std::exception&) {
      const runs::Failure failure = runs::failure_at_hand(estimate(scene_).cost.memory);
      fail(failure.reason, failure.fault);
    }
    summarise();
    if (status_ == Status::failed) raise();
    return {status_, reason_, verdict(), time(), gauges()};
  }

 private:
  int ranks() const { return options_.ranks.value_or(1); }
  double time() const { return sampler_ ? sampler_->time() : 0.0; }
  nlohmann::ordered_json gauges() const {
    return sampler_ ? sampler_->summary() : nlohmann::ordered_json::object();
  }
  [[noreturn]] void raise() const {
    const std::string what =
        fmt::format("{}; the logs are in {}", reason_, (options_.directory / "case").string());
    if (fault_ == runs::Fault::machine) throw runs::MachineError(what);
    throw runs::NumericsError(what);
  }
  /// Of the noise, of what the flow must keep, and of what the cells must resolve.
  std::string verdict() const {
    const std::string unresolved =
        sampler_ ? sampler_->resolution().fault(passage_ / scene_.foam.cell, std::nullopt) : "";
    return runs::with_resolution(noise_verdict(), unresolved);
  }
  std::string noise_verdict() const {
    const std::string noise = monitor_.verdict(), doubt = sampler_ ? sampler_->doubt() : "";
    if (doubt.empty()) return noise;
    return noise.starts_with("noisy") ? fmt::format("{}; {}", noise, doubt) : "noisy: " + doubt;
  }
  std::size_t cells() const { return sampler_ ? sampler_->cells() : 0; }

  /// The first reason is the one that counts. Programs that find no room on the disk leave half a file, or
  /// end without a word.
  void fail(const std::string& reason, runs::Fault fault = runs::Fault::numerics) {
    if (status_ == Status::failed) return;
    status_ = Status::failed;
    fault_ = fault;
    reason_ = reason;
    name_case_as_reader_knows_it();
    if (fault == runs::Fault::machine || !runs::disk_is_full(options_.directory)) return;
    fault_ = runs::Fault::machine;
    reason_ += "; the disk is full";
  }

  /// Where the case has another name for OpenFOAM, the reader knows it by its own.
  void name_case_as_reader_knows_it() {
    const std::string name = place_.path().string(), own = fs::absolute(case_).lexically_normal().string();
    for (auto at = reason_.find(name); name != own && at != std::string::npos;
         at = reason_.find(name, at + own.size()))
      reason_.replace(at, name.size(), own);
  }

  /// A program that ended badly did so by itself, or because the machine failed it, or because somebody who
  /// ends us, too, was quicker to end it.
  void fail_of(const std::string& program, const runs::ProcessEnd& end, const SolverLog& log) {
    if (runs::InterruptGuard::count() > 0) {
      if (status_ == Status::running) status_ = Status::interrupted;
      return;
    }
    const std::string fault = log.fault().empty() ? log.machine_fault() : log.fault();
    fail(fmt::format("{} ended with {}{}", program, end.how(), fault.empty() ? "" : ": " + fault),
         end.from_outside() || !log.machine_fault().empty() ? runs::Fault::machine : runs::Fault::numerics);
  }

  void begin() {
    if (!state_) fill();
    sampler_ = apparatus_->sampler(CaseFields(case_, ranks()), writer_, plug_in_.has_value());
    if (state_)
      go_on();
    else if (begins_with_)
      sampler_->begin_at(begins_with_->time);
    auto& info = writer_.info();
    info["cells"] = sampler_->cells();
    info["ranks"] = ranks();
    info["openfoam_program"] = openfoam_program("interFoam").string();
    if (ranks() > 1) info["mpirun_program"] = openfoam_mpirun().string();
    if (const std::string note = too_many_ranks(scene_, ranks(), runs::cores()); !note.empty()) {
      info["ranks_note"] = note;
      progress_.note(note);
    }
    if (const std::string differ = apparatus_->walls_differ(); !differ.empty()) info["walls_differ"] = differ;
    writer_.write();
  }

  void fill() {
    fill_case(scene_, case_, plug_in_, ranks());
    if (begins_with_) write_state(scene_, *begins_with_, case_);
  }

  /// Counts what the run has behind it as if it had just been followed.
  void go_on() {
    if (const fs::path history = options_.directory / "history.csv"; fs::exists(history))
      sampler_->continue_from(runs::read_csv(history));
    for (const auto& step : state_->steps) {
      tally(step);
      if (!(step.time < state_->last_row + 0.5 * step.time_step)) sampler_->note(step);
    }
    take_up_rest();
    cpu_by_program_ = state_->cpu_by_program;
    wall_before_ = state_->wall;
  }

  void take_up_rest() {
    const auto& samples = state_->overstresses;
    std::string kept = overstresses_header;
    for (std::size_t row = 0; row < samples.rows(); ++row) {
      // As while it ran: what came after its rest, while the solver ended, does not count.
      if (!rest_.at_rest()) rest_.add(samples.columns[0][row], samples.columns[1][row]);
      kept += fmt::format("{},{}\n", samples.columns[0][row], samples.columns[1][row]);
      last_overstress_time_ = samples.columns[0][row];
    }
    runs::write_atomically(case_ / overstresses_file, kept);
    if (rest_.at_rest()) status_ = Status::at_rest;
  }

  /// Mesh and initial fields, and their parts. False where it went wrong or was interrupted.
  bool prepare() {
    const auto done = [&](const Call& call) { return run_to_end(call); };
    if (!state_ && !std::all_of(programs_.prepare.begin(), programs_.prepare.end(), done)) return false;
    return !programs_.decompose || done(*programs_.decompose);
  }

  /// One case again, whatever became of the run; where that fails the parts stay.
  void put_together() {
    if (!programs_.reconstruct || !fs::exists(case_ / "processor0") || fault_ == runs::Fault::machine) return;
    const int asked = runs::InterruptGuard::count();
    const fs::path log_path = case_ / "log.reconstructPar";
    const auto process = start(*programs_.reconstruct, place_, log_path);
    while (!process->wait(poll_interval))
      if (runs::InterruptGuard::count() > std::max(asked, 1)) return;
    cpu_by_program_["reconstructPar"] += process->poll()->cpu_s;
    if (process->poll()->good()) {
      remove_parts(case_);
    } else {
      SolverLog log;
      log.feed(FileTail(log_path).read());
      fail_of("reconstructPar", *process->poll(), log);
    }
  }

  bool run_to_end(const Call& call) {
    const std::string name = call.program.filename().string();
    const fs::path log_path = case_ / ("log." + name);
    const auto process = start(call, place_, log_path);
    while (!process->wait(poll_interval))
      if (runs::InterruptGuard::count() > 0) {
        status_ = Status::interrupted;
        return false;
      }
    cpu_by_program_[name] += process->poll()->cpu_s;
    if (process->poll()->good()) return true;
    SolverLog log;
    log.feed(FileTail(log_path).read());
    fail_of(name, *process->poll(), log);
    return false;
  }

  void solve() {
    const double begin = begins_with_ ? begins_with_->time : 0.0;
    sampler_->sample_before(
        std::nextafter(begin, std::numeric_limits<double>::infinity()));  // the initial fields
    if (!state_ && !starts_with_the_body()) return;
    const fs::path log_path = case_ / "log.interFoam";
    fs::remove(case_ / stop_file);
    const auto solver = start(programs_.solve, place_, log_path);
    FileTail tail(log_path);
    bool running = true;
    while (running) {
      running = !solver->wait(poll_interval);
      follow(tail.read(), running);
      if (!running) break;
      if (runs::InterruptGuard::count() > 0) {
        status_ = Status::interrupted;
        stop(*solver);
      } else if (status_ == Status::failed || status_ == Status::at_rest) {
        stop(*solver);
      } else {
        continue;
      }
      follow(tail.read(), false);
      running = false;
    }
    conclude(*solver->poll());
  }

  /// What the programs left as the initial fields holds the scene's body. False where it does not.
  bool starts_with_the_body() {
    const double error = gauges().value("initial_volume_error", 0.0);
    if (std::abs(error) <= initial_volume_allowed) return true;
    fail(fmt::format(
        "the concrete in the mesh differs by {:.3g} % from the scene's body at the start, where "
        "{:g} % are allowed: what {} left are not its initial fields",
        100.0 * error, 100.0 * initial_volume_allowed, programs_.prepare.back().program.string()));
    return false;
  }

  /// Takes in what the log has gained, and what the solver has written.
  void follow(const std::string& text, bool running) {
    log_.feed(text);
    say_which();
    for (const auto& step : log_.take_steps()) count(step);
    try {
      sampler_->sample_before(
          running ? log_.time_begun().value_or(0.0) : std::numeric_limits<double>::infinity(),
          [this] { follow_rest(); });
    } catch (const FieldError& fault) {
      // The last directory of a solver that was cut off may be half written; in a running one it must be
      // whole.
      if (running) fail(fault.what());
    }
    watch();
    progress_.update(time(), fmt::format("{:.2f} s, {}", time(), sampler_->progress()));
  }

  /// Which OpenFOAM it is, once its log tells.
  void say_which() {
    if (log_.build().empty() || std::exchange(said_which_, true)) return;
    writer_.info()["openfoam"] = log_.build();
    writer_.write();
    progress_.note(fmt::format("{} ({})", log_.build(), openfoam_program("interFoam").string()));
  }

  void count(const SolverStep& step) {
    sampler_->note(step);
    tally(step);
    small_steps_ = step.time_step < collapsed_step * largest_step_ ? small_steps_ + 1 : 0;
    if (small_steps_ == collapsed_steps)
      fail(fmt::format("the time step collapsed to {:.2g} s at {:.4g} s: the flow diverges", step.time_step,
                       step.time));
  }

  void tally(const SolverStep& step) {
    monitor_.add(step);
    ++steps_;
    time_step_before_ = last_step_.time_step;
    last_step_ = step;
    max_courant_ = std::max(max_courant_, step.courant);
    max_time_step_ = std::max(max_time_step_, step.time_step);
  }

  /// Ends a run that can give no answer any more.
  void watch() {
    if (const auto fault = log_.fault(); !fault.empty())
      fail(fmt::format("interFoam at {:.4g} s: {}", log_.time_begun().value_or(0.0), fault),
           log_.machine_fault().empty() ? runs::Fault::numerics : runs::Fault::machine);
    if (const auto fault = sampler_->fault(); !fault.empty()) fail(fault);
  }

  /// Takes in the last sample, and keeps it for whoever goes on with the run.
  void follow_rest() {
    if (!(sampler_->time() > last_overstress_time_)) return;
    last_overstress_time_ = sampler_->time();
    const fs::path path = case_ / overstresses_file;
    std::ofstream file(path, std::ios::app);
    if (file.tellp() == 0) file << overstresses_header;
    file << fmt::format("{},{}\n", sampler_->time(), sampler_->overstress()) << std::flush;
    if (!file) throw runs::RunError(fmt::format("{}: cannot be written", path.string()));
    if (status_ != Status::running) return;
    rest_.add(sampler_->time(), sampler_->overstress());
    if (rest_.at_rest()) status_ = Status::at_rest;
  }

  /// Asks the solver to end its step and write; insists where it does not, or where the user asks again.
  void stop(runs::Process& solver) {
    const auto deadline = Clock::now() + std::chrono::duration<double>(options_.grace);
    const int asked = runs::InterruptGuard::count();
    if (ranks() > 1) {
      std::ofstream(case_ / stop_file);  // a signal would reach the ranks in different steps
    } else {
      solver.signal(SIGUSR2);
    }
    while (Clock::now() < deadline && runs::InterruptGuard::count() <= asked)
      if (solver.wait(poll_interval)) return;
    solver.signal(SIGTERM);
    if (solver.wait(1.0)) return;
    solver.kill_all();
    while (!solver.wait(1.0)) {
    }
  }

  void conclude(const runs::ProcessEnd& end) {
    cpu_by_program_["interFoam"] += end.cpu_s;
    if (status_ != Status::running) return;
    if (!end.good()) {
      fail_of("interFoam", end, log_);
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
      reason_ = fmt::format("interrupted at {:.4g} s; go on with: {}", time(),
                            runs::command_to_resume("foam", options_.directory));
    if (status_ == Status::at_rest && reason_.empty() && sampler_)
      reason_ = sampler_->resolution().limit_of_rest();
    write_info(wall);
    if (status_ == Status::failed)
      writer_.fail({fault_, reason_}, verdict());
    else
      writer_.finish(status_, reason_, verdict());
    progress_.finish(
        fmt::format("{} at {:.4g} s, {}, {}; {} steps, {:.3g} steps/s, {:.3g} cell-steps/s, {:.4g} "
                    "simulated s an hour",
                    runs::to_string(status_), time(), sampler_ ? sampler_->progress() : "nothing run",
                    writer_.info()["verdict"].get<std::string>(), steps_, static_cast<double>(steps_) / wall,
                    static_cast<double>(steps_ * cells()) / wall, 3600.0 * time() / wall));
  }

  void write_info(double wall) {
    auto& info = writer_.info();
    cpu_by_program_["flowrest"] += runs::cpu_seconds() - own_cpu_before_;
    double cpu = 0.0;
    for (const auto& [program, seconds] : cpu_by_program_) cpu += seconds;
    info["laws"] = plug_in_ ? "plug-in" : "built-in";
    info["simulated_s"] = time();
    info["steps"] = steps_;
    info["wall_s"] = wall;
    info["cpu_s"] = cpu;
    info["cpu_by_program_s"] = cpu_by_program_;
    info["cell_steps_per_cpu_s"] = static_cast<double>(steps_ * cells()) / cpu;
    info["cpu_s_per_simulated_s"] = time() > 0.0 ? Json(cpu / time()) : Json();
    const auto growth = rest_.growth_to_come();
    info["resolution"] = sampler_ ? sampler_->resolution().json() : Json();
    info["growth_to_come"] = growth ? Json(*growth) : Json();
    const auto rest_time = rest_.rest_time();
    info["rest_time_s"] = rest_time ? Json(*rest_time) : Json();  // a fluid has none
    const auto last = gauges();
    info.update(last);
    info["gauges"] = Json::array();
    for (const auto& gauge : last.items()) info["gauges"].push_back(gauge.key());
    info["courant_max"] = max_courant_;
    info["time_step_max_s"] = max_time_step_;
    info["time_step_rule"] = step_rule(*apparatus_, plug_in_.has_value());
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
  std::unique_ptr<ApparatusCase> apparatus_;
  double largest_step_ = largest_step(*apparatus_);  ///< s, before it grows
  const RunOptions& options_;
  Programs programs_;
  Start begins_with_;
  std::optional<RunState> state_;
  runs::PlainName place_;  ///< of the case
  runs::RunWriter writer_;
  fs::path case_;
  std::optional<fs::path> plug_in_;
  runs::Rest rest_;
  runs::Progress progress_;
  std::unique_ptr<Sampler> sampler_;
  SolverLog log_{solved_components(scene_)};
  NoiseMonitor monitor_{scene_.body_height()};
  double passage_ = scenes::pieces_of(scene_).passage;  ///< m, the narrowest
  Status status_ = Status::running;
  runs::Fault fault_ = runs::Fault::other;
  std::string reason_;
  bool said_which_ = false;
  std::size_t steps_ = 0;
  SolverStep last_step_;
  double time_step_before_ = 0.0;      ///< s, of the step before that
  double last_overstress_time_ = 0.0;  ///< s
  double max_courant_ = 0.0;
  double max_time_step_ = 0.0;
  int small_steps_ = 0;
  std::map<std::string, double> cpu_by_program_;
  Clock::time_point start_ = Clock::now();
  double wall_before_ = 0.0;
  double own_cpu_before_ = runs::cpu_seconds();
};

/// Makes one case of a decomposed one that was cut off before its parts were put together.
void join_parts(const fs::path& case_directory, const StateTime& latest) {
  remove_later_times(case_directory, latest);
  const fs::path log = case_directory / "log.reconstructPar";
  const runs::PlainName place(case_directory);
  const auto process = start({openfoam_program("reconstructPar"), {"-newTimes"}}, place, log);
  while (!process->wait(poll_interval))
    if (runs::InterruptGuard::count() > 0)
      throw runs::Interrupted("interrupted before the run was gone on with");
  if (!process->poll()->good())
    throw runs::RunError(
        fmt::format("{}: its parts cannot be put together: reconstructPar ended with {} ({})",
                    case_directory.string(), process->poll()->how(), log.string()));
  remove_parts(case_directory);
}

/// What a finished run came to.
RunOutcome outcome_of(const Json& info) {
  RunOutcome outcome;
  outcome.status = *runs::status_from(info.value("status", ""));
  outcome.reason = info.value("reason", "");
  outcome.verdict = info.value("verdict", "");
  outcome.time = runs::simulated_time(info);
  for (const auto& gauge : info.value("gauges", Json::array()))
    outcome.gauges[gauge.get<std::string>()] = info.value(gauge.get<std::string>(), Json());
  return outcome;
}

/// What a run begins with where that is not its scene's body. Its time is that which OpenFOAM reads.
Start start_of(const scenes::Scene& scene, const std::string& from, const RunOptions& options) {
  if (from.empty()) return std::nullopt;
  Start start = options.read_state(from, scene);
  start->time = std::stod(folder_of_time(start->time));
  runs::check_start(scene, *start);
  return start;
}

/// Runs a scene from its start in the folder that `open` takes for it.
template <class Open>
RunOutcome begin_run(const scenes::Scene& given, const RunOptions& options, const std::string& from,
                     Open open) {
  // What is missing is said before anything is written.
  const auto plug_in = plug_in_for(given);
  const scenes::Scene scene = settled(given, plug_in.has_value());
  const int ranks = options.ranks.value_or(1);
  check_supported(scene);
  check_ranks(scene, ranks, runs::cores());
  const Start start = start_of(scene, from, options);
  const Programs programs = needed_programs(*case_of(scene), ranks, start.has_value());
  Json beside{{"laws", plug_in ? "plug-in" : "built-in"}};
  if (start) beside[runs::started_from_key] = runs::started_from_json(*start);
  runs::RunFolder folder = open(scene, beside);
  if (folder.is_finished()) {
    if (!options.quiet) runs::say(stderr, folder.finished_words() + "\n");
    return outcome_of(folder.earlier());
  }
  return CaseRun(scene, options, programs, runs::RunWriter(std::move(folder)), start).run();
}

}  // namespace

RunOutcome run_scene(const scenes::Scene& scene, const RunOptions& options) {
  return begin_run(scene, options, options.from, [&](const scenes::Scene& settled, const Json& beside) {
    return runs::RunFolder(options.directory, settled, "foam",
                           options.force ? runs::Replace::anything : runs::Replace::failed, beside);
  });
}

RunOutcome resume_run(const RunOptions& given, const std::vector<std::string>& set) {
  read_earlier_run(given.directory, set);
  runs::FolderLock lock(given.directory);
  // Once more: whoever held it may have gone on with it.
  const EarlierRun earlier = read_earlier_run(given.directory, set);
  RunOptions options = given;
  options.ranks = given.ranks.value_or(earlier.ranks);
  check_ranks(earlier.scene, *options.ranks, runs::cores());
  plug_in_for(earlier.scene);
  const std::string from = runs::started_from(earlier.run.info);
  const Programs programs = needed_programs(*case_of(earlier.scene), *options.ranks, !from.empty());
  const fs::path case_directory = options.directory / "case";
  const auto latest = latest_whole_time(case_directory, earlier);
  if (!latest && !earlier.run.finished())
    return begin_run(earlier.scene, options, from, [&](const scenes::Scene& settled, const Json& beside) {
      return runs::RunFolder(std::move(lock), settled, "foam", runs::Replace::anything, beside);
    });
  if (!latest)
    throw runs::RunError(
        fmt::format("{}: this run is finished, and its case holds no whole state from which it could be "
                    "prolonged; run it anew, in another folder",
                    options.directory.string()));
  check_case(case_directory, earlier);
  if (earlier.scene.time.end != earlier.run.scene.time.end)
    runs::check_end(earlier.run, earlier.scene, latest->time);
  if (CaseFields::ranks_in(case_directory) > 1) join_parts(case_directory, *latest);
  const RunState state = take_up(options.directory, earlier, *latest);
  fill_parameters(earlier.scene, case_directory, earlier.plug_in, *options.ranks);
  auto writer = runs::RunWriter::resume(std::move(lock), earlier.scene,
                                        {state.time, state.last_row, state.last_profile});
  return CaseRun(earlier.scene, options, programs, std::move(writer), std::nullopt, state).run();
}

}  // namespace flowrest::foam
