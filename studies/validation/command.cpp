#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "compare/measures/gauges.h"
#include "compare/words.h"
#include "runs/run_directory.h"
#include "scenes/text.h"
#include "studies/ledger.h"
#include "studies/validation/validation.h"

namespace flowrest::studies::validation {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  Options options;
  std::string model, solver, output = "out/validation";
  WorkflowOptions workflow;
  bool list = false, report_only = false, json = false;
  std::shared_ptr<ledger::Asked> ledger = {};
};

/// What would be run, and for how long.
void print_list(const std::vector<SceneWanted>& wanted, const Folder& folder) {
  double left = 0.0;
  for (const SceneWanted& scene : wanted)
    for (const Wanted& run : scene.runs) {
      const bool there = outcome_of(folder, run.point).ending != Ending::missing;
      const double cpu = expected_cost(run.point).cpu_seconds;
      left += there ? 0.0 : cpu;
      fmt::print("{}: {}\n", run.point.label,
                 there ? "is there" : fmt::format("about {} of CPU", compare::words::duration(cpu)));
    }
  fmt::print("About {} of CPU to go, less where runs come to rest before their end\n",
             compare::words::duration(left));
}

/// The published numbers as a table that a terminal can show.
void print_numbers(const Validation& validation) {
  fmt::print("{:<20} {:<22} {:>10} {:>14} {}\n", "scene", "solver and law", "published", "ours", "verdict");
  for (const SceneFound& scene : validation.scenes)
    for (const Number& n : scene.numbers) {
      const auto reading = compare::reading_named(n.published.quantity);
      const auto target = n.published.target();
      // ± takes two bytes and one column.
      const std::string ours =
          n.ours ? compare::words::reading(*n.ours, n.uncertainty, reading.unit, n.grain) : "-";
      const std::size_t width = ours.find("±") == std::string::npos ? 14 : 15;
      fmt::print("{:<20} {:<22} {:>10} {:>{}} {}{}\n", scene.name,
                 fmt::format("{} {}", n.solver == Solver::mpm ? "MPM" : "OpenFOAM",
                             laws::can_rest(n.model) ? "solid" : scenes::to_string(n.model)),
                 target ? fmt::format("{:.4g} {}", *target, reading.unit) : "-", ours, width,
                 reading.name + ": " + n.words,
                 n.doubt.any() ? fmt::format("; {}: {}", n.doubt.word(), n.doubt.why) : "");
    }
}

void print_notes(const Validation& validation) {
  for (const SceneFound& scene : validation.scenes)
    for (const std::string& note : scene.notes) scenes::print_notes({scene.name + ": " + note});
}

/// A run came to no end of its own.
bool has_failure(const Validation& validation) {
  for (const SceneFound& scene : validation.scenes)
    for (const Found& run : scene.runs)
      if (run.outcome.ending != Ending::finished && run.outcome.ending != Ending::missing) return true;
  return false;
}

void run(Arguments& arguments) {
  Options& options = arguments.options;
  options.folder = arguments.output;
  if (!arguments.model.empty()) options.model = scenes::model_from_name(arguments.model);
  if (!arguments.solver.empty()) options.solver = arguments.solver == "mpm" ? Solver::mpm : Solver::foam;
  const auto wanted = plan(options);
  const Folder folder{fs::absolute(options.folder)};
  if (arguments.list) return print_list(wanted, folder);
  check_folder(folder, arguments.workflow);
  const runs::FolderLock lock(folder.root);
  constexpr double day = 86400.0;
  Study study;
  study.name = "validation";
  study.longest_run = day;
  const auto points = points_of(wanted);
  const std::size_t missing = prepare(folder, study, points);
  int code = 0;
  if (missing > 0 && !arguments.report_only) code = run_workflow(folder, study, points, arguments.workflow);
  const Validation validation = collect(folder, wanted, options);
  write(validation, folder.root);
  print_notes(validation);
  print_numbers(validation);
  const fs::path page = (folder.root / "index.html").lexically_normal();
  fmt::print("\nThe validation: {}\n", page.string());
  if (arguments.json) {
    nlohmann::ordered_json verdicts = nlohmann::ordered_json::object();
    for (const SceneFound& scene : validation.scenes)
      for (const Number& n : scene.numbers) {
        auto& count = verdicts[to_string(n.verdict)];
        count = (count.is_null() ? 0 : count.get<int>()) + 1;
      }
    fmt::print("{}\n", nlohmann::ordered_json{{"validation", (folder.root / "validation.json").string()},
                                              {"page", page.string()},
                                              {"verdicts", verdicts}}
                           .dump());
  }
  const bool as_good = ledger::enter(*arguments.ledger, ledger::entries_of(validation));
  if (code == 130) fmt::print(stderr, "Interrupted; the same command goes on with it.\n");
  constexpr int numerics_failed = 3;
  if (code == 0 && (has_failure(validation) || !as_good)) code = numerics_failed;
  if (code != 0) throw CLI::RuntimeError(code);
}

}  // namespace

void add_command(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  Options& options = arguments->options;
  CLI::App* command = app.add_subcommand(
      "validate", "Run the papers' scenes at two resolutions and hold them against what is published");
  command->add_option("scene", options.scenes, "Scenes, by name or path (every scene of scenes/papers.csv)");
  command->add_option("-o,--output", arguments->output, "Folder of the runs and the results")
      ->capture_default_str();
  command->add_option("--model", arguments->model, "Only runs of this model, of those that the scenes name");
  command->add_option("--solver", arguments->solver, "Only runs of this solver")
      ->check(CLI::IsMember({"mpm", "foam"}));
  command->add_option("--set", options.set, "KEY=VALUE: override a key in all of them")
      ->allow_extra_args(false);
  command->add_option("--coarsening", options.coarsening, "Cells of the second resolution over the scene's")
      ->check(CLI::Range(1.2, 4.0))
      ->capture_default_str();
  auto* jobs = command->add_option("-j,--jobs", arguments->workflow.cores, "Cores to use (all)")
                   ->check(CLI::PositiveNumber);
  auto* profile =
      command
          ->add_option("--profile", arguments->workflow.profile,
                       "A Snakemake profile: where the runs are made, such as studies/workflow/slurm")
          ->excludes(jobs);
  command->add_flag("--any-version", options.any_version,
                    "Take whole runs of the same settings by other versions of flowrest too");
  auto* report_only =
      command->add_flag("--report-only", arguments->report_only, "Make no run; report on those there are")
          ->excludes(jobs)
          ->excludes(profile);
  auto* json = command->add_flag("--json", arguments->json, "End with a machine-readable line");
  command->add_flag("--list", arguments->list, "Say what would be run and for how long; run nothing")
      ->excludes(jobs)
      ->excludes(profile)
      ->excludes(report_only)
      ->excludes(json);
  command->add_flag("--quiet", arguments->workflow.quiet, "Print no progress");
  arguments->ledger = ledger::add_options(*command);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace flowrest::studies::validation
