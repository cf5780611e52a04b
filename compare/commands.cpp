#include "compare/commands.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/exact/exact_run.h"
#include "compare/fields/surface.h"
#include "elements/commands.h"
#include "runs/run_directory.h"
#include "scenes/plausibility.h"
#include "scenes/scene.h"
#include "scenes/text.h"

namespace flowrest::compare {

namespace {

void add_exact(CLI::App& app) {
  struct Arguments {
    std::string scene, output;
    std::vector<std::string> set;
    bool thin_film = false;
    std::optional<double> flocculation;
    bool force = false, json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("exact", "Write the scene's exact or asymptotic solutions as runs");
  command->add_option("SCENE", arguments->scene, "A scene file, or the name of one in scenes/")->required();
  command->add_option(
      "-o,--output", arguments->output,
      "Folder that receives a run for each solution (out/SCENE/exact); with --elements the run "
      "directory (out/SCENE/exact/elements)");
  command->add_option("--set", arguments->set, "Override a key: material.yield_stress=100")
      ->allow_extra_args(false);
  command->add_flag("--thin-film", arguments->thin_film,
                    "Add a slump's approach to rest in time, as a thin film of Bingham material, "
                    "with and without the pull of its plug");
  command->add_option(
      "--flocculation", arguments->flocculation,
      "Structure with which a thixotropic material comes to rest: the last flocculation_mean of a "
      "run; 0: broken down");
  command->add_flag("--force", arguments->force, "Replace whatever runs stand in the way");
  command->add_flag("--json", arguments->json, "Print a machine-readable last line");
  const auto by_elements = elements::add_options(*command, {"--thin-film", "--flocculation"});
  command->callback([arguments, by_elements] {
    const auto scene =
        scenes::load_scene(arguments->scene, scenes::overrides_of_command_line(arguments->set));
    scenes::print_notes(scenes::plausibility_notes(scene));
    if (by_elements->chosen) {
      elements::run_command(scene, *by_elements, arguments->output, arguments->force, arguments->json);
      return;
    }
    if (arguments->thin_film) exact::check_film(scene);
    const std::string output = arguments->output.empty() ? "out/" + scene.name + "/exact" : arguments->output;
    nlohmann::ordered_json json = {{"runs", nlohmann::ordered_json::array()}};
    const auto replace = arguments->force ? runs::Replace::anything : runs::Replace::unfinished;
    auto written = exact::write_exact_runs(scene, output, arguments->flocculation, replace);
    if (arguments->thin_film) {
      const std::filesystem::path folder(output);
      written.push_back(exact::write_film_run(scene, folder / "thin-film", false, replace));
      written.push_back(exact::write_film_run(scene, folder / "thin-film-under-plug", true, replace));
    }
    for (const auto& run : written) {
      fmt::print("{}\n  {}\n", run.summary, run.directory.string());
      json["runs"].push_back(run.directory.string());
    }
    if (arguments->json) fmt::print("{}\n", json.dump());
  });
}

/// A report without figures for papers is still a report.
void try_figures(const Comparison& comparison, const std::string& report) {
  try {
    write_figures(comparison, report);
  } catch (const runs::MissingProgram& missing) {
    scenes::print_notes({fmt::format("no figures for papers: {}", missing.what())});
  }
}

/// Says where they are, or that there are none.
void write_all_surfaces(const Comparison& comparison, const std::filesystem::path& folder) {
  const auto files = fields::write_surfaces(comparison, folder);
  for (const auto& file : files) fmt::print("Surface: {}\n", file.string());
  if (files.empty())
    scenes::print_notes({"no surface: none of these runs has snapshots of particles in space"});
}

void add_compare(CLI::App& app) {
  struct Arguments {
    std::vector<std::string> runs;
    std::string output = "report";
    std::optional<double> spread_rate_mm;
    Options options;
    bool no_figures = false, surface = false, json = false;
    std::string clip;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("compare", "Compare runs and write a report");
  command->add_option("RUN", arguments->runs, "Run directories, or folders of them")->required();
  command->add_option("-o,--output", arguments->output, "Folder of the report")->capture_default_str();
  command
      ->add_option("--rest-shear-rate", arguments->options.rest_shear_rate,
                   "At rest once the 99th percentile of the shear rate stays below, 1/s "
                   "(gauges.rest_shear_rate of the first run unless given: 0.05 of the standard apparatus)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--rest-spread-rate", arguments->spread_rate_mm,
                   "At rest once the spread grows by less, mm/s (gauges.rest_rate of the first run unless "
                   "given: 0.5 of the standard apparatus)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--residual-window", arguments->options.residual_window,
                   "The last seconds of a run over which its residual speed is taken, s (2.5 times "
                   "gauges.rate_window unless given: 5 of the standard apparatus)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--no-figures", arguments->no_figures,
                    "Leave out the figures for papers (figures/*.svg and *.png)");
  command->add_flag(
      "--surface", arguments->surface,
      "Also write the body of each run of material points in space, at its last snapshot, as STL into "
      "the report's folder surfaces/");
  command
      ->add_option(
          "--clip", arguments->clip,
          "Also write particles beside cells as a clip into the report's folder: NAME.webm or NAME.gif")
      ->check([](const std::string& name) {
        return name.ends_with(".webm") || name.ends_with(".gif")
                   ? ""
                   : "'" + name + "' ends neither in .webm nor in .gif";
      });
  command->add_flag("--json", arguments->json, "Print a machine-readable last line");
  command->callback([arguments] {
    if (arguments->spread_rate_mm) arguments->options.rest_spread_rate = 1e-3 * *arguments->spread_rate_mm;
    const std::vector<std::filesystem::path> named(arguments->runs.begin(), arguments->runs.end());
    const Comparison comparison = compare_runs(find_runs(named), arguments->options);
    const runs::FolderLock lock(arguments->output);
    write_comparison(comparison, arguments->output);
    if (!arguments->no_figures) try_figures(comparison, arguments->output);
    if (!arguments->clip.empty())
      write_clip(comparison, std::filesystem::path(arguments->output) / arguments->clip);
    if (arguments->surface)
      write_all_surfaces(comparison, std::filesystem::path(arguments->output) / "surfaces");
    scenes::print_notes(comparison.notes);
    for (const Finding& finding : comparison.findings) fmt::print("{}\n", finding.text);
    const std::string page =
        (std::filesystem::absolute(arguments->output) / "index.html").lexically_normal().string();
    fmt::print("\nThe report: {}\n", page);
    if (arguments->json) {
      nlohmann::ordered_json json = {
          {"report", page}, {"runs", comparison.runs.size()}, {"findings", to_json(comparison)["findings"]}};
      fmt::print("{}\n", json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    }
  });
}

}  // namespace

void add_commands(CLI::App& app) {
  add_exact(app);
  add_compare(app);
}

}  // namespace flowrest::compare
