#include "studies/commands.h"

#include <fmt/format.h>
#include <unistd.h>

#include <memory>
#include <set>

#include "compare/words.h"
#include "runs/folder_lock.h"
#include "runs/process.h"
#include "runs/run_directory.h"
#include "scenes/installation.h"
#include "scenes/text.h"
#include "studies/accuracy.h"
#include "studies/cards/card.h"
#include "studies/gradient/gradient.h"
#include "studies/ledger.h"
#include "studies/results.h"
#include "studies/validation/validation.h"
#include "studies/verification/verification.h"
#include "studies/workflow.h"

namespace flowrest::studies {

namespace {

namespace fs = std::filesystem;

struct StudyOptions {
  std::string study, output, cut;
  WorkflowOptions workflow;
  bool list = false, report_only = false, keep = false, json = false;
};

/// What would be run, and for how long.
void print_list(const std::vector<Point>& points) {
  double total = 0.0;
  std::set<std::string> seen;
  for (const Point& point : points) {
    if (!point.scene) {
      fmt::print("{}: refused: {}\n", point.label, point.refused);
      continue;
    }
    const double cpu = expected_cost(point).cpu_seconds;
    if (seen.insert(point.id).second) total += cpu;
    fmt::print("{}: about {} of CPU\n", point.label, compare::words::duration(cpu));
  }
  fmt::print("{} runs, about {} of CPU, less where they come to rest before their end\n", seen.size(),
             compare::words::duration(total));
}

void print_results(const Results& results, const Folder& folder, bool json) {
  scenes::print_notes(results.notes);
  for (const std::string& finding : results.findings) fmt::print("{}\n", finding);
  const fs::path page = fs::absolute(folder.root / "index.html").lexically_normal();
  fmt::print("\nThe study: {}\n", page.string());
  if (json)
    fmt::print("{}\n", nlohmann::ordered_json{{"study", (folder.root / "study.json").string()},
                                              {"points", results.results.size()},
                                              {"notes", results.notes},
                                              {"findings", results.findings}}
                           .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

/// Something that must never happen happened: a run that is silently wrong, or that crashed.
bool has_failure(const Results& results) {
  for (const Result& r : results.results)
    if (r.verdict == Verdict::unsound || r.verdict == Verdict::crashed) return true;
  return false;
}

/// A folder as it is named from here, else the profile of that name that flowrest brings.
WorkflowOptions with_profile(WorkflowOptions options) {
  const fs::path ours = scenes::shared_folder("workflow") / options.profile;
  std::error_code error;
  if (!options.profile.empty() && !fs::exists(options.profile, error) &&
      fs::exists(ours / "config.yaml", error))
    options.profile = ours.string();
  return options;
}

fs::path kept_file(const Study& study) {
  return scenes::scenes_folder() / "studies" / (study.name + ".known.json");
}

/// Before hours of runs: whoever installed flowrest may keep what was found beside its scenes, others may
/// not.
void check_may_be_kept(const Study& study) {
  const fs::path folder = kept_file(study).parent_path();
  if (access(folder.c_str(), W_OK) == 0) return;
  throw scenes::SceneError(fmt::format(
      "--keep: {} cannot be written into; allowed: FLOWREST_SCENES naming a copy of {} that can be",
      folder.string(), folder.parent_path().string()));
}

void run_study(const StudyOptions& options) {
  const Study study = load_study(options.study);
  if (options.keep) check_may_be_kept(study);
  const std::vector<Point> points = expand(study, options.cut);
  if (options.list) return print_list(points);
  const Folder folder{fs::absolute(options.output.empty() ? "out/studies/" + study.name : options.output)};
  check_folder(folder, options.workflow);
  const runs::FolderLock lock(folder.root);
  const std::size_t missing = prepare(folder, study, points);
  int code = 0;
  if (missing > 0 && !options.report_only)
    code = run_workflow(folder, study, points, with_profile(options.workflow));
  const Results results = collect(folder, study, points, options.cut);
  write_results(folder, results);
  print_results(results, folder, options.json);
  if (options.keep) {
    const fs::path kept = kept_file(study);
    runs::write_atomically(kept, knowledge_json(results).dump(1) + "\n");
    fmt::print("Kept for `flowrest run --accuracy`: {}\n", kept.string());
  }
  if (code == 130) fmt::print(stderr, "Interrupted; the same command goes on with it.\n");
  constexpr int numerics_failed = 3;
  if (code == 0 && has_failure(results)) code = numerics_failed;
  if (code != 0) throw CLI::RuntimeError(code);
}

void add_study(CLI::App& app) {
  auto options = std::make_shared<StudyOptions>();
  CLI::App* command = app.add_subcommand("study", "Sweep settings of a scene: accuracy against cost");
  command->add_option("study", options->study, "A study's name, or the path of its file")->required();
  auto* output = command->add_option("-o,--output", options->output,
                                     "Folder of the runs and the results (out/studies/STUDY)");
  command->add_option("--cut", options->cut, "A named part of the study, such as quick");
  auto* jobs = command->add_option("-j,--jobs", options->workflow.cores, "Cores to use (all)")
                   ->check(CLI::PositiveNumber);
  auto* profile =
      command
          ->add_option(
              "--profile", options->workflow.profile,
              "A Snakemake profile: where the runs are made, a folder, or slurm, which flowrest brings")
          ->excludes(jobs);
  auto* report_only =
      command->add_flag("--report-only", options->report_only, "Make no run; report on those there are")
          ->excludes(jobs)
          ->excludes(profile);
  auto* keep = command->add_flag(
      "--keep", options->keep,
      "Keep what was found for `flowrest run --accuracy`, in scenes/studies/STUDY.known.json");
  auto* json = command->add_flag("--json", options->json, "End with a machine-readable line");
  command->add_flag("--list", options->list, "Say what would be run and for how long; run nothing")
      ->excludes(output)
      ->excludes(jobs)
      ->excludes(profile)
      ->excludes(report_only)
      ->excludes(keep)
      ->excludes(json);
  command->add_flag("--quiet", options->workflow.quiet, "Print no progress");
  command->callback([options] { run_study(*options); });
}

void add_job(CLI::App& app) {
  struct Arguments {
    std::string folder, id;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("study-job", "One run of a study; called by its workflow")->group("");
  command->add_option("folder", arguments->folder, "The study's folder")->required();
  command->add_option("id", arguments->id, "The job")->required();
  command->callback([arguments] {
    if (const int code = run_job(arguments->folder, arguments->id); code != 0) throw CLI::RuntimeError(code);
  });
}

std::string names_of(const std::vector<verification::Case>& cases) {
  std::string names;
  for (const auto& c : cases) names += fmt::format("  {}, {}\n", c.name, c.variant);
  return names;
}

/// @return the exit code
int run_verification(const fs::path& folder, const verification::Options& options,
                     const ledger::Asked& asked) {
  const auto findings = verification::verify(verification::all_cases(), folder, options);
  if (findings.empty())
    throw scenes::SceneError(fmt::format("no case is named so; allowed: a part of the name of one:\n{}",
                                         names_of(verification::all_cases())));
  runs::write_atomically(folder / "verification.json", verification::to_json(findings).dump(1) + "\n");
  runs::write_atomically(folder / "verification.csv", verification::to_csv(findings));
  runs::write_atomically(folder / "index.html", report::render(verification::page_of(findings)));
  bool all = true;
  for (const auto& f : findings) {
    fmt::print("{} {}, {}: {}\n",
               !f.judged  ? "  "
               : f.passed ? "ok"
                          : "!!",
               f.of.name, f.of.variant, f.verdict);
    all = all && (f.passed || !f.judged);
  }
  fmt::print("\nThe verification: {}\n", fs::absolute(folder / "index.html").lexically_normal().string());
  all = ledger::enter(asked, ledger::entries_of(findings)) && all;
  constexpr int numerics_failed = 3;
  return all ? 0 : numerics_failed;
}

void add_ledger(CLI::App& app) {
  struct Arguments {
    std::string file = "docs/measured/ledger.csv", output = "out/ledger";
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("ledger", "A page of the accuracy ledger: each quantity, commit by commit");
  command->add_option("file", arguments->file, "The ledger")->capture_default_str();
  command->add_option("-o,--output", arguments->output, "Folder of the page")->capture_default_str();
  command->callback([arguments] {
    const auto entries = ledger::read(arguments->file);
    if (entries.empty())
      throw scenes::SceneError(arguments->file +
                               ": there are no rows; allowed: a ledger, such as `flowrest verify "
                               "--ledger FILE` writes");
    const runs::FolderLock lock(arguments->output);
    const fs::path page = fs::path(arguments->output) / "index.html";
    runs::write_atomically(page, report::render(ledger::page_of(entries)));
    fmt::print("The ledger: {}\n", fs::absolute(page).lexically_normal().string());
  });
}

void add_verify(CLI::App& app) {
  auto options = std::make_shared<verification::Options>();
  auto output = std::make_shared<std::string>("out/verification");
  CLI::App* command =
      app.add_subcommand("verify", "Every exactly known case on three grids: errors and orders");
  command->add_option("-o,--output", *output, "Folder of the results")->capture_default_str();
  command->add_flag("--quick", options->quick, "The part that takes three minutes instead of twenty");
  command->add_option("--only", options->only, "Cases whose name or variant holds this text");
  command->add_option("-j,--jobs", options->jobs, "Computations at once (as many as there are cores)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--quiet", options->quiet, "Print no progress");
  const auto asked = ledger::add_options(*command);
  command->callback([options, output, asked] {
    const runs::FolderLock lock(*output);
    const int code = run_verification(*output, *options, *asked);
    if (code != 0) throw CLI::RuntimeError(code);
  });
}

void add_judge(CLI::App& app) {
  struct Arguments {
    std::string card, answer;
    bool json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("judge", "Hold an answer against a benchmark card, whoever computed it");
  command->add_option("card", arguments->card, "A card's name or file; without one they are listed");
  auto* answer =
      command->add_option("answer", arguments->answer,
                          "A run directory, or a CSV file: time_s and a column for each quantity, or "
                          "quantity and value; without one the card is shown");
  command->add_flag("--json", arguments->json, "End with a machine-readable line")->needs(answer);
  command->callback([arguments] {
    if (arguments->card.empty()) {
      for (const std::string& name : cards::card_names())
        fmt::print("{}: {}\n", name, cards::load_card(name).title);
      return;
    }
    const cards::Card card = cards::load_card(arguments->card);
    if (arguments->answer.empty()) {
      fmt::print("{}", cards::shown(card));
      return;
    }
    const auto judged = cards::judge(card, arguments->answer);
    fmt::print("{}", cards::shown(judged));
    if (arguments->json) fmt::print("{}\n", cards::to_json(card, judged));
    constexpr int numerics_failed = 3;
    if (!cards::agrees(judged)) throw CLI::RuntimeError(numerics_failed);
  });
}

}  // namespace

void add_commands(CLI::App& app) {
  add_study(app);
  add_verify(app);
  gradient::add_command(app);
  validation::add_command(app);
  add_judge(app);
  add_ledger(app);
  add_job(app);
}

}  // namespace flowrest::studies
