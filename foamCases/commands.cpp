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
  bool json = false;
  bool quiet = false;
};

void run_command(const FoamArguments& arguments) {
  scenes::Overrides overrides{arguments.set, std::nullopt};
  if (!arguments.model.empty()) overrides.model = scenes::model_from_name(arguments.model);
  const auto scene = scenes::load_scene(arguments.scene, overrides);
  RunOptions options;
  options.quiet = arguments.quiet;
  options.directory = arguments.directory.empty() ? std::filesystem::path("out") / scene.name /
                                                        ("foam-" + scenes::to_string(scene.material.model))
                                                  : std::filesystem::path(arguments.directory);
  const auto outcome = run_scene(scene, options);
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
  if (outcome.status == runs::Status::interrupted) throw CLI::RuntimeError(130);
}

}  // namespace

void add_commands(CLI::App& app) {
  auto* command = app.add_subcommand("foam", "Run a scene in interFoam: fills the case, runs it, gauges it");
  auto arguments = std::make_shared<FoamArguments>();
  command->add_option("SCENE", arguments->scene, "A scene's name, or the path of its file")->required();
  command->add_option("--model", arguments->model,
                      "elasto-viscoplastic, papanastasiou, bi-viscous or newtonian");
  command
      ->add_option("--set", arguments->set, "KEY=VALUE: overrides a key of the scene, e.g. foam.cell=0.005")
      ->take_all()
      ->expected(1);
  command->add_option("-o,--output", arguments->directory,
                      "The run directory; out/SCENE/foam-MODEL unless given");
  command->add_flag("--json", arguments->json, "Print a machine-readable last line");
  command->add_flag("--quiet", arguments->quiet, "Print no progress");
  command->callback([arguments] { run_command(*arguments); });
}

}  // namespace flowrest::foam
