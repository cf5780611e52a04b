#include "foamCases/commands.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "foamCases/foam_run.h"

namespace flowrest::foam {

namespace {

struct FoamArguments {
  std::string scene;
  std::string model;
  std::vector<std::string> set;
  std::string directory;
  std::string resume;
  int ranks = 1;
  bool json = false;
  bool quiet = false;
};

/// Makes a run or goes on with one; fills in the directory.
RunOutcome run_or_resume(const FoamArguments& arguments, RunOptions& options) {
  if (!arguments.resume.empty()) {
    options.directory = arguments.resume;
    return resume_run(options);
  }
  scenes::Overrides overrides{arguments.set, std::nullopt};
  if (!arguments.model.empty()) overrides.model = scenes::model_from_name(arguments.model);
  const auto scene = scenes::load_scene(arguments.scene, overrides);
  options.directory = arguments.directory.empty() ? std::filesystem::path("out") / scene.name /
                                                        ("foam-" + scenes::to_string(scene.material.model))
                                                  : std::filesystem::path(arguments.directory);
  return run_scene(scene, options);
}

void run_command(const FoamArguments& arguments) {
  RunOptions options;
  options.quiet = arguments.quiet;
  options.ranks = arguments.ranks;
  const auto outcome = run_or_resume(arguments, options);
  if (arguments.json) {
    nlohmann::ordered_json line{{"run", options.directory.string()},
                                {"status", runs::to_string(outcome.status)},
                                {"reason", outcome.reason},
                                {"verdict", outcome.verdict},
                                {"time_s", outcome.time}};
    line.update(outcome.gauges);
    fmt::print("{}\n", line.dump());
  } else {
    fmt::print("{}\n", options.directory.string());
  }
  // As the shell does for a program that Ctrl-C ended.
  if (outcome.status == runs::Status::interrupted) {
    fmt::print(stderr, "{}\n", outcome.reason);
    throw CLI::RuntimeError(130);
  }
}

}  // namespace

void add_commands(CLI::App& app) {
  auto* command = app.add_subcommand("foam", "Run a scene in interFoam: fills the case, runs it, gauges it");
  auto arguments = std::make_shared<FoamArguments>();
  auto* scene = command->add_option("SCENE", arguments->scene, "A scene's name, or the path of its file");
  command->add_option("--model", arguments->model,
                      "elasto-viscoplastic, papanastasiou, bi-viscous or newtonian");
  command
      ->add_option("--set", arguments->set, "KEY=VALUE: overrides a key of the scene, e.g. foam.cell=0.005")
      ->take_all()
      ->expected(1);
  command->add_option("-o,--output", arguments->directory,
                      "The run directory; out/SCENE/foam-MODEL unless given");
  auto* resume =
      command
          ->add_option("--resume", arguments->resume,
                       "Go on with the run in this directory from its latest state; needs no scene")
          ->excludes(scene);
  command->add_option("--ranks", arguments->ranks, "Ranks to solve with, under mpirun (1: without)")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--json", arguments->json, "Print a machine-readable last line");
  command->add_flag("--quiet", arguments->quiet, "Print no progress");
  command->callback([arguments, scene, resume] {
    if (scene->count() == 0 && resume->count() == 0) throw CLI::RequiredError("a scene, or --resume RUN");
    run_command(*arguments);
  });
}

}  // namespace flowrest::foam
