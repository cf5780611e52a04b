#include "mpm/commands.h"

#include <fmt/format.h>

#include <memory>

#include "mpm/output/run.h"
#include "mpm/solver/kernels.h"
#include "runs/process.h"
#include "scenes/scene.h"

namespace flowrest::mpm {

namespace {

struct MpmOptions {
  std::string scene, model, output, resume, instruction_set;
  std::vector<std::string> set;
  bool json = false, quiet = false;
};

RunResult run_or_resume(const MpmOptions& options) {
  RunOptions run_options;
  run_options.quiet = options.quiet;
  run_options.instruction_set = options.instruction_set;
  const runs::InterruptGuard guard;
  run_options.interrupted = [] { return runs::InterruptGuard::count() > 0; };
  if (!options.resume.empty()) {
    run_options.directory = options.resume;
    return resume(run_options);
  }
  scenes::Overrides overrides;
  overrides.set = options.set;
  if (!options.model.empty()) overrides.model = scenes::model_from_name(options.model);
  const scenes::Scene scene = scenes::load_scene(options.scene, overrides);
  run_options.directory = options.output.empty() ? std::filesystem::path("out") / scene.name /
                                                       ("mpm-" + scenes::to_string(scene.material.model))
                                                 : std::filesystem::path(options.output);
  return run(scene, run_options);
}

}  // namespace

void add_commands(CLI::App& app) {
  auto options = std::make_shared<MpmOptions>();
  CLI::App* command = app.add_subcommand("mpm", "Run a scene with the material point solver");
  auto* scene = command->add_option("scene", options->scene, "A scene's name, or the path of its file");
  command->add_option(
      "--model", options->model,
      "elasto-viscoplastic, papanastasiou, bi-viscous or newtonian, in place of material.model");
  command->add_option("--set", options->set, "KEY=VALUE: override a key by its dotted path")
      ->allow_extra_args(false);
  command->add_option("-o,--output", options->output, "The run directory (out/SCENE/mpm-MODEL)");
  auto* resume_option =
      command->add_option("--resume", options->resume, "Go on with the run in this directory; needs no scene")
          ->excludes(scene);
  command
      ->add_option("--instruction-set", options->instruction_set,
                   "avx512, avx2 or generic (the best this machine runs)")
      ->check(CLI::IsMember(instruction_sets()));
  command->add_flag("--json", options->json, "End with a machine-readable line");
  command->add_flag("--quiet", options->quiet, "Print no progress");
  command->callback([options, scene, resume_option] {
    if (scene->count() == 0 && resume_option->count() == 0)
      throw CLI::RequiredError("a scene, or --resume RUN");
    const RunResult result = run_or_resume(*options);
    if (options->json)
      fmt::print("{}\n", nlohmann::ordered_json{{"status", runs::to_string(result.status)},
                                                {"reason", result.reason},
                                                {"time_s", result.time},
                                                {"gauge", result.headline}}
                             .dump());
    if (result.status == runs::Status::interrupted) {
      fmt::print(stderr, "{}\n", result.reason);
      throw CLI::RuntimeError(130);
    }
  });
}

}  // namespace flowrest::mpm
