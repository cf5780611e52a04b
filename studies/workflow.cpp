#include "studies/workflow.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "runs/console.h"
#include "runs/cores.h"
#include "runs/folder.h"
#include "runs/process.h"
#include "runs/progress.h"
#include "runs/run_directory.h"
#include "runs/temporary_folder.h"
#include "scenes/installation.h"
#include "studies/quantities.h"

namespace flowrest::studies {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Points that are runs to be made, each once.
std::vector<const Point*> runs_of(const std::vector<Point>& points) {
  std::vector<const Point*> runs;
  std::set<std::string> seen;
  for (const Point& point : points)
    if (point.scene && seen.insert(point.id).second) runs.push_back(&point);
  return runs;
}

Json job_of(const Study& study, const Point& point) {
  constexpr double mebibyte = 1048576.0, minute = 60.0;
  const scenes::Cost cost = expected_cost(point);
  const int threads = point.solver == Solver::mpm ? std::max(1, point.scene->mpm.threads) : 1;
  Json of = Json::array(), by = Json::array();
  const auto note = [](Json& list, const std::string& name) {
    if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
  };
  for (const std::string& quantity : study.quantities)
    if (const auto derivative = derivative_named(quantity); derivative && point.solver == Solver::mpm) {
      note(of, derivative->of);
      note(by, derivative->by);
    }
  Json job = {{"id", point.id},
              {"label", point.label},
              {"solver", to_string(point.solver)},
              {"threads", threads},
              {"memory_mb", static_cast<std::int64_t>(std::ceil(200.0 + 1.5 * cost.memory / mebibyte))},
              {"minutes", static_cast<std::int64_t>(std::ceil(study.longest_run / minute)) + 1},
              {"expected_cpu_s", cost.cpu_seconds},
              {"settings", Json::parse(scenes::resolved_json(*point.scene))}};
  if (!of.empty()) job["derivatives"] = {{"of", of}, {"by", by}};
  return job;
}

/// The long runs first, so that no core waits for one at the end.
std::vector<Json> jobs_of(const Study& study, const std::vector<Point>& points) {
  std::vector<Json> jobs;
  for (const Point* point : runs_of(points)) jobs.push_back(job_of(study, *point));
  std::stable_sort(jobs.begin(), jobs.end(), [](const Json& a, const Json& b) {
    return a["expected_cpu_s"].get<double>() > b["expected_cpu_s"].get<double>();
  });
  return jobs;
}

void write_if_new(const fs::path& path, const std::string& text) {
  std::ifstream file(path, std::ios::binary);
  const std::string there{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file || there != text) runs::write_atomically(path, text);
}

void copy_workflow(const Folder& folder) {
  const fs::path from = scenes::shared_folder("workflow") / "Snakefile";
  std::error_code error;
  if (!fs::exists(from, error))
    throw runs::RunError(fmt::format(
        "{}: the workflow of studies is not there: flowrest is not installed whole", from.string()));
  runs::copy_writable(from, folder.root / "Snakefile");
}

std::size_t ended(const Folder& folder, const std::vector<const Point*>& runs) {
  return static_cast<std::size_t>(std::count_if(
      runs.begin(), runs.end(), [&](const Point* p) { return fs::exists(folder.mark(p->id)); }));
}

/// A profile by a name that Snakemake takes: it looks for the characters of patterns in it.
std::optional<runs::PlainName> profile_of(const WorkflowOptions& options) {
  if (options.profile.empty()) return std::nullopt;
  return std::optional<runs::PlainName>(std::in_place, options.profile);
}

/// What Snakemake and the jobs below it are told. Jobs are runs of this program, so what that is told goes
/// along; its cache and what it looks for in a home lie in the study's folder, which every machine of a
/// cluster sees.
runs::Environment snakemake_environment(const Folder& folder) {
  auto environment = runs::Environment::with_home(folder.root / ".snakemake" / "home");
  return environment.set("PYTHONNOUSERSITE", "1").keep("TMPDIR=").keep("LD_LIBRARY_PATH=").keep("OMP_");
}

std::vector<std::string> snakemake_arguments(const std::optional<runs::PlainName>& profile,
                                             const WorkflowOptions& options) {
  const int cores = options.cores > 0 ? options.cores : runs::cores();
  // The lock of the folder is ours and dies with its holders; Snakemake's would outlive a kill. It is at home
  // in the folder, whose name means nothing to it.
  std::vector<std::string> arguments = {"--snakefile",      "Snakefile",  "--nolock",
                                        "--keep-going",     "--no-hooks", "--rerun-incomplete",
                                        "--rerun-triggers", "mtime"};
  if (!profile)
    arguments.insert(arguments.end(), {"--cores", std::to_string(cores)});
  else
    arguments.insert(arguments.end(), {"--profile", profile->path().string()});
  arguments.insert(arguments.end(), options.more.begin(), options.more.end());
  return arguments;
}

/// How long a run that was interrupted may take to leave a state that can be gone on from, s.
constexpr double longest_goodbye = 120.0;

/// What went wrong, for the user: the tail of Snakemake's own log.
std::string tail_of(const fs::path& log) {
  std::ifstream file(log);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    lines.push_back(line);
    if (lines.size() > 20) lines.erase(lines.begin());
  }
  std::string text;
  for (const auto& line : lines) text += fmt::format("  {}\n", line);
  return text;
}

}  // namespace

void check_folder(const Folder& folder, const WorkflowOptions& options) {
  const std::string path = folder.root.string();
  if (options.profile.empty() || path.find_first_of("$`\"\\") == std::string::npos) return;
  throw runs::RunError(
      fmt::format("{}: with --profile Snakemake hands this path to a shell, which would read $, `, \" and \\ "
                  "in it; allowed: a folder (-o) without them",
                  path));
}

std::size_t prepare(const Folder& folder, const Study& study, const std::vector<Point>& points) {
  for (const char* name : {"jobs", "runs", "logs", "ended"}) fs::create_directories(folder.root / name);
  std::size_t missing = 0;
  for (const Point* point : runs_of(points)) {
    write_if_new(folder.scene(point->id), scenes::resolved_toml(*point->scene));
    if (outcome_of(folder, *point).ending != Ending::missing) continue;
    fs::remove(folder.mark(point->id));
    ++missing;
  }
  const Json jobs = {{"flowrest", scenes::program_file().string()},
                     {"study", study.name},
                     {"longest_run_s", study.longest_run},
                     {"jobs", jobs_of(study, points)}};
  write_if_new(folder.jobs_file(), jobs.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  copy_workflow(folder);
  return missing;
}

int run_workflow(const Folder& folder, const Study& study, const std::vector<Point>& points,
                 const WorkflowOptions& options) {
  const auto snakemake = runs::find_program("snakemake");
  if (!snakemake)
    throw runs::MissingProgram(
        "snakemake is not installed; on Debian: apt-get install snakemake (or scripts/setup)");
  const auto runs = runs_of(points);
  const runs::InterruptGuard guard;
  runs::Progress progress("study " + study.name, static_cast<double>(runs.size()), options.quiet);
  const fs::path log = folder.root / "snakemake.log";
  const auto profile = profile_of(options);
  runs::Process process(*snakemake, snakemake_arguments(profile, options), folder.root, log,
                        snakemake_environment(folder));
  bool interrupted = false;
  std::size_t shown = runs.size() + 1;
  while (!process.poll()) {
    interrupted = process.hand_on_interrupts();
    const std::size_t done = ended(folder, runs);
    if (done != shown)
      progress.update(static_cast<double>(done), fmt::format("{} of {} runs", done, runs.size()));
    shown = done;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  // Interrupted again, Snakemake may leave the runs that it was waiting for.
  if (interrupted) process.end_survivors(longest_goodbye);
  const std::size_t done = ended(folder, runs);
  progress.finish(fmt::format("{} of {} runs have ended", done, runs.size()));
  if (interrupted) return 130;
  if (process.poll()->good() && done == runs.size()) return 0;
  runs::say(stderr, fmt::format("Some runs could not be made ({}); the end of {}:\n{}", process.poll()->how(),
                                log.string(), tail_of(log)));
  constexpr int machine_failed = 5;
  return std::any_of(runs.begin(), runs.end(),
                     [&](const Point* p) { return ended_by_machine(folder, p->id); })
             ? machine_failed
             : 1;
}

}  // namespace flowrest::studies
