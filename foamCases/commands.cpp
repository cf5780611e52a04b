#include "foamCases/commands.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "foamCases/foam_run.h"
#include "runs/console.h"
#include "runs/earlier_run.h"
#include "runs/process.h"
#include "runs/run_folder.h"
#include "scenes/plausibility.h"
#include "scenes/text.h"

namespace flowrest::foam {

namespace {

struct FoamArguments {
  std::string scene;
  std::string model;
  std::vector<std::string> set;
  std::string directory;
  std::string resume;
  std::string from;
  runs::StateReader read_state;
  std::optional<int> ranks;
  bool force = false;
  bool json = false;
  bool quiet = false;
};

/// Makes a run or goes on with one; fills in the directory.
RunOutcome run_or_resume(const FoamArguments& arguments, RunOptions& options) {
  if (!arguments.resume.empty()) {
    options.directory = arguments.resume;
    return resume_run(options, arguments.set);
  }
  const auto scene =
      scenes::load_scene(arguments.scene, scenes::overrides_of_command_line(arguments.set, arguments.model));
  scenes::print_notes(scenes::plausibility_notes(scene));
  options.directory = arguments.directory.empty() ? std::filesystem::path("out") / scene.name /
                                                        ("foam-" + scenes::to_string(scene.material.model))
                                                  : std::filesystem::path(arguments.directory);
  return run_scene(scene, options);
}

/// @throws scenes::SceneError, runs::RunError where an option would be without effect.
void check_options(const FoamArguments& arguments) {
  if (!arguments.model.empty()) scenes::model_from_name(arguments.model);
  if (arguments.resume.empty()) return;
  std::vector<std::string> without_effect;
  if (!arguments.model.empty()) without_effect.emplace_back("--model");
  if (!arguments.directory.empty()) without_effect.emplace_back("--output");
  if (!arguments.from.empty()) without_effect.emplace_back("--from");
  runs::refuse_beside_resume(without_effect, "--set, --ranks, --json, --quiet");
}

void run_command(const FoamArguments& arguments) {
  check_options(arguments);
  RunOptions options;
  const runs::InterruptGuard guard;
  options.quiet = arguments.quiet;
  options.force = arguments.force;
  options.from = arguments.from;
  options.read_state = arguments.read_state;
  options.ranks = arguments.ranks;
  const auto outcome = run_or_resume(arguments, options);
  if (arguments.json) {
    nlohmann::ordered_json line{{"run", options.directory.string()},
                                {"status", runs::to_string(outcome.status)},
                                {"reason", outcome.reason},
                                {"verdict", outcome.verdict},
                                {"time_s", outcome.time}};
    line.update(outcome.gauges);
    runs::say(stdout, line.dump() + "\n");
  } else {
    runs::say(stdout, options.directory.string() + "\n");
  }
  // As the shell does for a program that Ctrl-C ended.
  if (outcome.status == runs::Status::interrupted) {
    runs::say(stderr, outcome.reason + "\n");
    throw CLI::RuntimeError(130);
  }
}

}  // namespace

void add_commands(CLI::App& app, const runs::StateReader& read_state) {
  auto* command = app.add_subcommand("foam", "Run a scene in interFoam: fills the case, runs it, gauges it");
  auto arguments = std::make_shared<FoamArguments>();
  arguments->read_state = read_state;
  auto* scene = command->add_option("SCENE", arguments->scene, "A scene's name, or the path of its file");
  command->add_option("--model", arguments->model, laws::all_names());
  command
      ->add_option("--set", arguments->set, "KEY=VALUE: overrides a key of the scene, e.g. foam.cell=0.005")
      ->take_all()
      ->expected(1);
  command->add_option("-o,--output", arguments->directory,
                      "The run directory; out/SCENE/foam-MODEL unless given");
  auto* resume =
      command
          ->add_option("--resume", arguments->resume,
                       "Go on with the run in this directory from its latest state; needs no scene. --set "
                       "time.end=... prolongs it, finished or not")
          ->excludes(scene);
  command
      ->add_option("--ranks", arguments->ranks,
                   "Ranks to solve with, under mpirun (1: without; with --resume, as many as the run had)")
      ->check(CLI::Range(1, 1024));
  command->add_option("--from", arguments->from, runs::from_help);
  command->add_flag("--force", arguments->force, runs::force_help)->excludes(resume);
  command->add_flag("--json", arguments->json, "Print a machine-readable last line");
  command->add_flag("--quiet", arguments->quiet, "Print no progress");
  command->callback([arguments, scene, resume] {
    if (scene->count() == 0 && resume->count() == 0) throw CLI::RequiredError("a scene, or --resume RUN");
    run_command(*arguments);
  });
}

}  // namespace flowrest::foam
