#include "scenes/commands.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "scenes/plausibility.h"
#include "scenes/scene.h"
#include "scenes/summary.h"
#include "scenes/text.h"

namespace flowrest::scenes {

namespace {

void print_scenes() {
  std::size_t width = 0;
  const std::vector<SceneSummary> summaries = list_scenes();
  for (const SceneSummary& summary : summaries) width = std::max(width, summary.name.size());
  for (const SceneSummary& summary : summaries) {
    fmt::print("{:<{}}  {}\n", summary.name, width,
               summary.error.empty() ? summary.title : "cannot be used: " + summary.error);
  }
}

void add_scenes(CLI::App& app) {
  auto keys = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("scenes", "List the scenes there are, one line each");
  command->add_flag("--keys", *keys, "Print every key a scene can have instead");
  command->callback([keys] {
    if (*keys) {
      fmt::print("{}", key_reference());
    } else {
      print_scenes();
    }
  });
}

/// What the command line of `flowrest check` gives.
struct CheckOptions {
  std::string scene;
  std::string model;
  std::vector<std::string> set;
  bool json = false;
};

void add_check(CLI::App& app, const Estimates& estimates) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command =
      app.add_subcommand("check", "Show what a scene resolves to, its step limits and what a run will cost");
  command->add_option("scene", options->scene, "A scene's name, or the path of its file")->required();
  command->add_option("--model", options->model, "The model to run, in place of material.model");
  // One value for each --set, so that the scene may follow it.
  command->add_option("--set", options->set, "KEY=VALUE: override a key by its dotted path")
      ->allow_extra_args(false);
  command->add_flag("--json", options->json, "Add a machine-readable last line");
  command->callback([options, estimates] {
    const Scene scene = load_scene(options->scene, overrides_of_command_line(options->set, options->model));
    print_notes(plausibility_notes(scene));
    fmt::print("{}", check_text(scene, estimates));
    if (options->json) fmt::print("{}\n", check_json(scene, estimates));
  });
}

}  // namespace

void add_commands(CLI::App& app, const Estimates& estimates) {
  add_scenes(app);
  add_check(app, estimates);
}

}  // namespace flowrest::scenes
