#include "mpm/commands.h"

#include <fmt/format.h>

#include <memory>

#include "mpm/output/run.h"
#include "mpm/solver/kernels.h"
#include "runs/console.h"
#include "runs/earlier_run.h"
#include "runs/process.h"
#include "runs/run_folder.h"
#include "scenes/plausibility.h"
#include "scenes/scene.h"
#include "scenes/text.h"

namespace flowrest::mpm {

namespace {

struct MpmOptions {
  std::string scene, model, output, resume, from, instruction_set, method = "fast";
  std::vector<std::string> set;
  bool force = false, json = false, quiet = false;
  runs::StateReader read_state;
};

RunResult run_or_resume(const MpmOptions& options) {
  RunOptions run_options;
  run_options.quiet = options.quiet;
  run_options.force = options.force;
  run_options.from = options.from;
  run_options.read_state = options.read_state;
  run_options.instruction_set = options.instruction_set;
  if (options.method == "plain") run_options.method = Method::plain;
  const runs::InterruptGuard guard;
  run_options.interrupted = [] { return runs::InterruptGuard::count() > 0; };
  if (!options.resume.empty()) {
    run_options.directory = options.resume;
    return resume(run_options, options.set);
  }
  const scenes::Scene scene =
      scenes::load_scene(options.scene, scenes::overrides_of_command_line(options.set, options.model));
  scenes::print_notes(scenes::plausibility_notes(scene));
  run_options.directory = options.output.empty() ? std::filesystem::path("out") / scene.name /
                                                       ("mpm-" + scenes::to_string(scene.material.model) +
                                                        (options.method == "plain" ? "-plain" : ""))
                                                 : std::filesystem::path(options.output);
  return run(scene, run_options);
}

/// @throws scenes::SceneError, runs::RunError where an option would be without effect.
void check_options(const MpmOptions& options) {
  if (!options.model.empty()) scenes::model_from_name(options.model);
  if (options.resume.empty()) return;
  std::vector<std::string> without_effect;
  if (!options.model.empty()) without_effect.emplace_back("--model");
  if (!options.output.empty()) without_effect.emplace_back("--output");
  if (!options.from.empty()) without_effect.emplace_back("--from");
  runs::refuse_beside_resume(without_effect, "--set, --instruction-set, --json, --quiet");
}

}  // namespace

void add_commands(CLI::App& app, const runs::StateReader& read_state) {
  auto options = std::make_shared<MpmOptions>();
  options->read_state = read_state;
  CLI::App* command = app.add_subcommand("mpm", "Run a scene with the material point solver");
  auto* scene = command->add_option("scene", options->scene, "A scene's name, or the path of its file");
  command->add_option("--model", options->model, laws::all_names() + ", in place of material.model");
  command->add_option("--set", options->set, "KEY=VALUE: override a key by its dotted path")
      ->allow_extra_args(false);
  command->add_option("-o,--output", options->output, "The run directory (out/SCENE/mpm-MODEL)");
  auto* resume_option =
      command
          ->add_option(
              "--resume", options->resume,
              "Go on with the run in this directory; needs no scene. --set time.end=... prolongs it, "
              "finished or not")
          ->excludes(scene);
  command->add_option("--from", options->from, runs::from_help);
  command->add_flag("--force", options->force, runs::force_help)->excludes(resume_option);
  command
      ->add_option("--instruction-set", options->instruction_set,
                   "avx512, avx2 or generic (the best this machine runs)")
      ->check(CLI::IsMember(instruction_sets()));
  command
      ->add_option("--method", options->method,
                   "fast, or plain: the same steps by the readable code of mpm/plain, several times slower")
      ->check(CLI::IsMember({"fast", "plain"}))
      ->excludes(resume_option);
  command->add_flag("--json", options->json, "End with a machine-readable line");
  command->add_flag("--quiet", options->quiet, "Print no progress");
  command->callback([options, scene, resume_option] {
    if (scene->count() == 0 && resume_option->count() == 0)
      throw CLI::RequiredError("a scene, or --resume RUN");
    if (options->method == "plain" && !options->instruction_set.empty())
      throw CLI::ExcludesError("--method plain", "--instruction-set");
    check_options(*options);
    const RunResult result = run_or_resume(*options);
    if (options->json)
      runs::say(stdout, nlohmann::ordered_json{{"status", runs::to_string(result.status)},
                                               {"reason", result.reason},
                                               {"time_s", result.time},
                                               {"gauge", result.headline}}
                                .dump() +
                            "\n");
    if (result.status == runs::Status::interrupted) {
      runs::say(stderr, result.reason + "\n");
      throw CLI::RuntimeError(130);
    }
  });
}

}  // namespace flowrest::mpm
