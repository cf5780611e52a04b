#include "cli/run_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "runs/console.h"
#include "runs/cores.h"
#include "runs/folder.h"
#include "runs/folder_lock.h"
#include "runs/material_state.h"
#include "runs/process.h"
#include "runs/run_directory.h"
#include "runs/run_folder.h"
#include "scenes/installation.h"
#include "scenes/plausibility.h"
#include "scenes/scene.h"
#ifdef FLOWREST_HAS_COMPARE
#include "compare/words.h"
#include "studies/accuracy.h"
#include "studies/quantities.h"
#endif

namespace flowrest::cli {

namespace {

namespace fs = std::filesystem;

struct RunCommandOptions {
  std::vector<std::string> scenes, set;
  std::string output = "out", accuracy;
  int jobs = 0;
  bool force = false;
};

/// One run of one scene, as a call of this program.
struct Job {
  std::string name;  ///< "roussel-slump foam-papanastasiou"
  fs::path directory;
  std::vector<std::string> arguments;
};

/// Passes on what the programs of a scene say: notes to stderr as everywhere, each once though every run of
/// the scene has it, all else to stdout.
class Relay {
 public:
  void note(const std::vector<std::string>& notes) {
    for (const std::string& text : notes) pass("Note: " + text);
  }
  void pass(const std::string& line) {
    const bool is_note = line.starts_with("Note: ");
    if (is_note && !noted_.insert(line).second) return;
    runs::say(is_note ? stderr : stdout, line + "\n");
  }

 private:
  std::set<std::string> noted_;
};

/// A job under way: its process and how much of its log has been shown.
class RunningJob {
 public:
  RunningJob(Job job, const fs::path& program, const fs::path& logs, Relay& relay)
      : relay_(relay),
        job_(std::move(job)),
        log_(logs / (job_.directory.filename().string() + ".log")),
        process_(program, job_.arguments, fs::current_path(), log_, {}) {}

  const Job& job() const { return job_; }
  std::optional<runs::ProcessEnd> poll() { return process_.poll(); }
  void hand_on_interrupts() { process_.hand_on_interrupts(); }

  /// Prints the whole lines that the log has gained.
  void show_progress() {
    std::ifstream file(log_);
    file.seekg(shown_);
    for (std::string line; std::getline(file, line) && !file.eof();) {
      relay_.pass(line);
      shown_ = file.tellg();
    }
  }

 private:
  Relay& relay_;
  Job job_;
  fs::path log_;
  std::streamoff shown_ = 0;
  runs::Process process_;
};

void add_settings(std::vector<std::string>& arguments, const std::vector<std::string>& set) {
  for (const auto& s : set) arguments.insert(arguments.end(), {"--set", s});
}

/// What the scene's runs start from: as it is named from here, else in the folder that receives the runs.
std::string start_of_runs(const scenes::Scene& scene, const RunCommandOptions& options) {
  const std::string& from = scene.runs.from;
  if (from.empty() || fs::exists(runs::state_name(from).run)) return from;
  const fs::path there = fs::path(options.output) / from;
  return fs::exists(runs::state_name(there.string()).run) ? there.string() : from;
}

/// What makes a run of a scene, or goes on with it where its folder holds a part of it.
std::vector<std::string> begin_or_go_on(const std::string& solver, const std::string& named,
                                        const fs::path& directory, const std::vector<std::string>& chosen,
                                        const std::optional<scenes::Model>& model,
                                        const RunCommandOptions& options) {
  std::vector<std::string> set = options.set;
  set.insert(set.end(), chosen.begin(), chosen.end());
  const scenes::Scene scene = scenes::load_scene(named, {set, model});
  const std::string from = start_of_runs(scene, options);
  if (!options.force && runs::standing_in(directory, scene, solver, from) == runs::Standing::unfinished)
    return {solver, "--resume", directory.string()};
  std::vector<std::string> arguments = {solver, named, "-o", directory.string()};
  if (model) arguments.insert(arguments.end(), {"--model", scenes::to_string(*model)});
  if (!from.empty()) arguments.insert(arguments.end(), {"--from", from});
  if (options.force) arguments.push_back("--force");
  add_settings(arguments, set);
  return arguments;
}

#ifdef FLOWREST_HAS_COMPARE
/// What writes exact solutions of a scene.
std::vector<std::string> exact_arguments(const std::string& named, const fs::path& directory,
                                         const RunCommandOptions& options) {
  std::vector<std::string> arguments = {"exact", named, "-o", directory.string()};
  if (options.force) arguments.push_back("--force");
  add_settings(arguments, options.set);
  return arguments;
}
#endif

/// The runs a scene names, the longest kind first so that no core waits for it at the end.
std::deque<Job> jobs_of(const scenes::Scene& scene, const std::string& named, const fs::path& folder,
                        const RunCommandOptions& options, bool share_cores) {
  std::deque<Job> jobs;
  const auto add = [&](const std::string& solver, scenes::Model model, bool one_thread) {
    Job job;
    const std::string model_name = scenes::to_string(model);
    job.name = fmt::format("{} {} {}", scene.name, solver, model_name);
    job.directory = folder / (solver + "-" + model_name);
    const std::vector<std::string> threads =
        one_thread ? std::vector<std::string>{"mpm.threads=1"} : std::vector<std::string>{};
    job.arguments = begin_or_go_on(solver, named, job.directory, threads, model, options);
    jobs.push_back(std::move(job));
  };
#ifdef FLOWREST_HAS_FOAM
  for (const auto model : scene.runs.foam) add("foam", model, false);
#endif
  const bool one_thread =
      share_cores && scene.mpm.threads == 0 && !scenes::gives_key(options.set, "mpm.threads");
  for (const auto model : scene.runs.mpm) add("mpm", model, one_thread);
#ifdef FLOWREST_HAS_COMPARE
  if (scene.runs.elements) {
    // One that was interrupted is made anew.
    Job job;
    job.name = scene.name + " elements";
    job.directory = folder / "elements";
    job.arguments = exact_arguments(named, job.directory, options);
    job.arguments.push_back("--elements");
    jobs.push_back(std::move(job));
  }
#endif
  return jobs;
}

class Scheduler {
 public:
  Scheduler(std::deque<Job> jobs, int at_once, fs::path logs, Relay& relay)
      : waiting_(std::move(jobs)), at_once_(at_once), logs_(std::move(logs)), relay_(relay) {}

  /// Runs everything; returns the exit code to end with: that of the first job that failed, 130 where
  /// interrupted.
  int run() {
    const runs::InterruptGuard guard;
    const fs::path program = scenes::program_file();
    while (!waiting_.empty() || !running_.empty()) {
      if (runs::InterruptGuard::count() > 0) interrupt();
      while (!waiting_.empty() && static_cast<int>(running_.size()) < at_once_) {
        runs::say(stdout, fmt::format("{}: started, in {}\n", waiting_.front().name,
                                      waiting_.front().directory.string()));
        running_.push_back(std::make_unique<RunningJob>(std::move(waiting_.front()), program, logs_, relay_));
        waiting_.pop_front();
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      for (auto& job : running_) job->show_progress();
      collect();
    }
    return code_;
  }

 private:
  void interrupt() {
    waiting_.clear();
    for (auto& job : running_) job->hand_on_interrupts();
    code_ = 130;
  }

  void collect() {
    std::erase_if(running_, [&](const std::unique_ptr<RunningJob>& job) {
      const auto end = job->poll();
      if (!end) return false;
      job->show_progress();
      if (!end->good()) {
        runs::say(stdout, fmt::format("{}: ended with {}\n", job->job().name, end->how()));
        if (code_ == 0) code_ = end->signal ? 1 : end->exit_code;
      }
      return true;
    });
  }

  std::deque<Job> waiting_;
  int at_once_;
  fs::path logs_;
  Relay& relay_;
  std::vector<std::unique_ptr<RunningJob>> running_;
  int code_ = 0;
};

#ifdef FLOWREST_HAS_COMPARE
/// Runs another of this program's commands, its output going where ours goes; returns its exit code.
int call(const std::vector<std::string>& arguments, const fs::path& log, Relay& relay) {
  runs::Process process(scenes::program_file(), arguments, fs::current_path(), log, {});
  bool interrupted = false;
  while (!process.poll()) {
    interrupted = process.hand_on_interrupts();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::ifstream file(log);
  for (std::string line; std::getline(file, line);) relay.pass(line);
  if (interrupted) return 130;
  const auto end = process.poll();
  return end->signal ? 1 : end->exit_code;
}

/// Exact solutions and the report over every run that left a directory; returns the first exit code that is
/// not 0.
int compare_runs(const scenes::Scene& scene, const std::string& named, const fs::path& folder,
                 std::vector<fs::path> made, const RunCommandOptions& options, Relay& relay) {
  int code = 0;
  if (scene.runs.exact) {
    code = call(exact_arguments(named, folder / "exact", options), folder / "logs" / "exact.log", relay);
    if (code == 130) return code;
    if (code == 0) made.push_back(folder / "exact");
  }
  std::vector<std::string> arguments = {"compare"};
  for (const auto& run : made)
    if (fs::exists(run)) arguments.push_back(run.string());
  if (arguments.size() == 1) return code;
  arguments.insert(arguments.end(), {"-o", (folder / "report").string()});
  const int compared = call(arguments, folder / "logs" / "compare.log", relay);
  return code == 0 ? compared : code;
}
#endif

#ifdef FLOWREST_HAS_COMPARE
Job accuracy_job(const std::string& named, const fs::path& directory, const RunCommandOptions& options,
                 const std::vector<std::string>& chosen) {
  Job job;
  job.name = fmt::format("{} {}", fs::path(named).stem().string(), directory.filename().string());
  job.directory = directory;
  job.arguments = begin_or_go_on("mpm", named, directory, chosen, std::nullopt, options);
  return job;
}

/// Whether the run and its coarser twin agree with what was expected, in words and in accuracy.json.
/// @return the exit code
int check_accuracy(const fs::path& folder, const studies::Choice& choice, double wanted) {
  const runs::Run run = runs::read_run(folder / "mpm"), twin = runs::read_run(folder / "mpm-coarser-twin");
  const std::string& quantity = choice.quantity;
  const auto value = studies::measure(run, quantity), other = studies::measure(twin, quantity);
  if (!value || !other || *value == 0.0) {
    fmt::print(
        "The accuracy cannot be checked: a run did not come to its end, or has no {} to be held against.\n",
        quantity);
    return 3;
  }
  const double coarser = choice.twin_cell / choice.cell,
               error = studies::error_by_twin(*value, *other, coarser);
  const bool held = error <= wanted;
  fmt::print(
      "{} = {:.4g} {}. On cells {:.2g} times as wide it is {:.4g}: at first order that leaves an error of "
      "{}. The {} "
      "asked for {}.\n",
      quantity, *value, studies::unit_of(quantity), coarser, *other, compare::words::percent(error),
      compare::words::percent(wanted), held ? "hold" : "are not shown to hold");
  const nlohmann::ordered_json json = {
      {"quantity", quantity},
      {"value", *value},
      {"wanted", wanted},
      {"expected_error", choice.expected_error},
      {"why", choice.why},
      {"cell_m", choice.cell},
      {"twin_cell_m", choice.twin_cell},
      {"twin_value", *other},
      {"error_by_twin", error},
      {"held", held},
      {"cpu_s", run.info.value("cpu_s", 0.0) + twin.info.value("cpu_s", 0.0)}};
  runs::write_atomically(folder / "accuracy.json", json.dump(1) + "\n");
  return held ? 0 : 3;
}

/// What is known to reach the accuracy that is asked for.
/// @throws scenes::SceneError where nothing is, or a setting is given that is chosen here.
studies::Choice choice_for(const scenes::Scene& scene, const RunCommandOptions& options) {
  const double wanted = studies::accuracy_from(options.accuracy);
  const studies::Choice choice = studies::choose(studies::stored_knowledge(), scene, wanted);
  for (const auto& chosen : choice.set) {
    const std::string key = chosen.substr(0, chosen.find('='));
    if (scenes::gives_key(options.set, key))
      throw scenes::SceneError(
          fmt::format("--set {}: --accuracy chooses it; allowed: every key but those it chooses", key));
  }
  return choice;
}

/// Runs a scene with the cheapest settings that are known to reach an accuracy, and a coarser twin that
/// checks it.
int run_accurately(const scenes::Scene& scene, const std::string& named, const RunCommandOptions& options) {
  const double wanted = studies::accuracy_from(options.accuracy);
  const studies::Choice choice = choice_for(scene, options);
  Relay relay;
  relay.note(scenes::plausibility_notes(scene));
  fmt::print(
      "Chosen for {}: {}.\nExpected error {}, expected cost {} of CPU with the coarser twin (cells of {:g} "
      "m) that "
      "checks it.\n",
      compare::words::percent(wanted), choice.why, compare::words::percent(choice.expected_error),
      compare::words::duration(choice.expected_cpu), choice.twin_cell);
  std::fflush(stdout);
  const fs::path folder = fs::path(options.output) / scene.name / "accuracy";
  const runs::FolderLock lock(folder);
  runs::make_folder(folder / "logs");
  std::deque<Job> jobs = {accuracy_job(named, folder / "mpm", options, choice.set),
                          accuracy_job(named, folder / "mpm-coarser-twin", options, choice.twin_set)};
  const int at_once = options.jobs > 0 ? options.jobs : runs::cores();
  const int code = Scheduler(std::move(jobs), at_once, folder / "logs", relay).run();
  return code != 0 ? code : check_accuracy(folder, choice, wanted);
}
#endif

int run_scene(const scenes::Scene& scene, const std::string& named, const RunCommandOptions& options) {
  const fs::path folder = fs::path(options.output) / scene.name;
  const fs::path logs = folder / "logs";
  const runs::FolderLock lock(folder);
  runs::make_folder(logs);
  const runs::InterruptGuard guard;
  const int at_once = options.jobs > 0 ? options.jobs : runs::cores();
  auto jobs = jobs_of(scene, named, folder, options, at_once > 1);
  Relay relay;
  relay.note(scenes::plausibility_notes(scene));
  std::vector<fs::path> made;
  for (const auto& job : jobs) made.push_back(job.directory);
  int code = Scheduler(std::move(jobs), at_once, logs, relay).run();
#ifdef FLOWREST_HAS_COMPARE
  if (code != 130) {
    const int compared = compare_runs(scene, named, folder, made, options, relay);
    if (code == 0) code = compared;
  }
#endif
  return code;
}

/// The scenes that are asked for, all of them read before the first is run.
std::vector<scenes::Scene> scenes_of(const RunCommandOptions& options) {
  std::vector<scenes::Scene> all;
  const scenes::Overrides overrides = scenes::overrides_of_command_line(options.set);
  for (const auto& named : options.scenes) {
    const scenes::Scene& scene = all.emplace_back(scenes::load_scene(named, overrides));
#ifdef FLOWREST_HAS_COMPARE
    if (!options.accuracy.empty()) {
      choice_for(scene, options);
      continue;
    }
#endif
    scenes::check_model_has_effect(scene, options.set);
    if (scene.runs.mpm.empty() && scene.runs.foam.empty() && !scene.runs.exact && !scene.runs.elements)
      throw scenes::SceneError(fmt::format(
          "{}: names no runs; allowed: runs = {{ mpm = [...], foam = [...], exact = true, elements = true }}",
          scene.path.string()));
  }
  return all;
}

}  // namespace

void add_run_command(CLI::App& app) {
  auto options = std::make_shared<RunCommandOptions>();
  CLI::App* command =
      app.add_subcommand("run", "Make every run that a scene names, then compare them: the main job");
  command->add_option("scene", options->scenes, "Scenes, by name or path")->required();
  command->add_option("--set", options->set, "KEY=VALUE: override a key in all of them")
      ->allow_extra_args(false);
  command->add_option("-o,--output", options->output, "Folder that receives SCENE/RUN and SCENE/report")
      ->capture_default_str();
#ifdef FLOWREST_HAS_COMPARE
  command->add_option(
      "--accuracy", options->accuracy,
      "Instead, one MPM run with the cheapest settings that are known to reach this, such as 2%");
#endif
  command->add_flag(
      "--force", options->force,
      "Make every run anew, whatever stands in its folder. Without it finished runs of the same "
      "settings and version are taken as they are, and unfinished ones are gone on with");
  command->add_option("-j,--jobs", options->jobs, "Runs at once (as many as there are cores)")
      ->check(CLI::PositiveNumber);
  command->callback([options] {
    int code = 0;
    const auto all = scenes_of(*options);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::string& named = options->scenes[i];
#ifdef FLOWREST_HAS_COMPARE
      const int scene_code = options->accuracy.empty() ? run_scene(all[i], named, *options)
                                                       : run_accurately(all[i], named, *options);
#else
      const int scene_code = run_scene(all[i], named, *options);
#endif
      if (code == 0) code = scene_code;
      if (scene_code == 130) break;
    }
    if (code != 0) throw CLI::RuntimeError(code);
  });
}

}  // namespace flowrest::cli
