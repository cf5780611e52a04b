#include "studies/job.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "runs/machine.h"
#include "runs/process.h"
#include "runs/run_directory.h"
#include "scenes/installation.h"

namespace flowrest::studies {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::pair<Ending, const char*> ending_names[] = {
    {Ending::missing, "missing"}, {Ending::finished, "finished"}, {Ending::stopped, "stopped"},
    {Ending::refused, "refused"}, {Ending::crashed, "crashed"},   {Ending::too_long, "too long"}};

Json read_json(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return file ? Json::parse(file, nullptr, false) : Json(Json::value_t::discarded);
}

bool by_machine(const Json& info) {
  return info.value("failure", "") == runs::to_string(runs::Fault::machine);
}

/// How the run directory says that this run ended; missing where it says anything else.
Outcome ending_in(const fs::path& directory, const std::string& solver, const Json& settings) {
  try {
    const runs::Run run = runs::read_run(directory);
    if (!runs::same_settings(solver, run.info.value("settings", Json()), settings)) return {};
    const std::string reason = run.info.value("reason", "");
    switch (run.status()) {
      case runs::Status::at_rest:
      case runs::Status::end_time:
        return {Ending::finished, reason};
      case runs::Status::failed:
        return by_machine(run.info) ? Outcome{} : Outcome{Ending::stopped, reason};
      default:
        return {};
    }
  } catch (const runs::RunError&) {
    return {};
  } catch (const Json::exception&) {
    return {};
  }
}

struct Job {
  std::string id, solver;
  Json settings;
  double longest_run = 0.0;      ///< s
  std::string of = {}, by = {};  ///< parted by commas: derivatives that are wanted of it; else empty

  bool is_gradient() const { return !of.empty(); }
};

std::string parted_by_commas(const Json& list) {
  std::vector<std::string> texts;
  for (const Json& item : list) texts.push_back(item.get<std::string>());
  return fmt::format("{}", fmt::join(texts, ","));
}

Job read_job(const Folder& folder, const std::string& id) {
  const Json jobs = read_json(folder.jobs_file());
  if (!jobs.is_object() || !jobs.contains("jobs"))
    throw runs::RunError(folder.jobs_file().string() + ": is not the list of jobs of a study");
  for (const Json& job : jobs["jobs"])
    if (job.value("id", "") == id) {
      const Json wanted = job.value("derivatives", Json::object());
      return {id,
              job.value("solver", "mpm"),
              job.value("settings", Json()),
              jobs.value("longest_run_s", 3600.0),
              parted_by_commas(wanted.value("of", Json::array())),
              parted_by_commas(wanted.value("by", Json::array()))};
    }
  throw runs::RunError(fmt::format("{}: has no job {}", folder.jobs_file().string(), id));
}

void mark(const Folder& folder, const Job& job, const Outcome& outcome, double wall) {
  const Json text = {{"id", job.id},
                     {"ending", to_string(outcome.ending)},
                     {"reason", outcome.reason},
                     {"wall_s", wall},
                     {"settings", job.settings}};
  fs::create_directories(folder.mark(job.id).parent_path());
  runs::write_atomically(folder.mark(job.id),
                         text.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// Whether the run directory holds a part of this run that can be gone on with.
bool has_begun(const Folder& folder, const Job& job) {
  const Json info = read_json(folder.run(job.id) / "run.json");
  return info.is_object() && runs::same_settings(job.solver, info.value("settings", Json()), job.settings) &&
         (info.value("status", "") != to_string(runs::Status::failed) || by_machine(info));
}

/// From the last checkpoint where this run left one, else from the start.
std::vector<std::string> arguments_of(const Folder& folder, const Job& job, bool begun) {
  const fs::path run = folder.run(job.id);
  if (job.is_gradient())
    return {"gradient", folder.scene(job.id).string(), "--of", job.of, "--by", job.by, "-o", run.string(),
            "--force"};
  std::vector<std::string> arguments = {job.solver};
  if (begun)
    arguments.insert(arguments.end(), {"--resume", run.string()});
  else
    arguments.insert(arguments.end(), {folder.scene(job.id).string(), "-o", run.string(), "--force"});
  return arguments;
}

/// Nobody may be writing there still: a run that outlived who waited for it, say.
void remove_run(const fs::path& run) {
  const runs::FolderLock lock(run);
  fs::remove_all(run);
}

/// A run directory that cannot be gone on with makes room for a new one.
void clear_unusable(const Folder& folder, const Job& job) {
  const fs::path run = folder.run(job.id);
  const Json info = read_json(run / "run.json");
  if (fs::exists(run) &&
      (!info.is_object() || !runs::same_settings(job.solver, info.value("settings", Json()), job.settings)))
    remove_run(run);
}

Outcome outcome_of_end(const Folder& folder, const Job& job, const runs::ProcessEnd& end, bool too_long) {
  constexpr int refused = 2, failed = 3, interrupted = 130;
  if (too_long) return {Ending::too_long, fmt::format("took longer than {:g} s", job.longest_run)};
  if (end.signal == SIGKILL || end.signal == SIGTERM || end.signal == SIGINT || end.signal == SIGHUP)
    return {};
  if (end.signal != 0) return {Ending::crashed, end.how()};
  if (end.exit_code == interrupted) return {};
  const Outcome said = ending_in(folder.run(job.id), job.solver, job.settings);
  if ((end.exit_code == 0 || end.exit_code == failed) && said.ending != Ending::missing) return said;
  const std::string why = runs::last_words(folder.log(job.id));
  if (end.exit_code == refused) return {Ending::refused, why};
  return {Ending::crashed, fmt::format("{}: {}", end.how(), why)};
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Starts the run or goes on with it, and waits for its end; it has what is left of the longest time since
/// `begin`.
Outcome attempt(const Folder& folder, const Job& job, bool begun, Clock::time_point begin) {
  runs::Process process(scenes::program_file(), arguments_of(folder, job, begun), fs::current_path(),
                        folder.log(job.id), {});
  bool too_long = false;
  while (!process.poll()) {
    process.hand_on_interrupts();
    if (!too_long && seconds_since(begin) > job.longest_run) {
      process.signal(SIGINT);
      too_long = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const runs::ProcessEnd end = *process.poll();
  constexpr int program_missing = 4, machine_failed = 5;
  if (end.exit_code == program_missing && end.signal == 0)
    throw runs::MissingProgram(runs::last_words(folder.log(job.id)));
  if (end.exit_code == machine_failed && end.signal == 0)
    throw runs::MachineError(runs::last_words(folder.log(job.id)));
  return outcome_of_end(folder, job, end, too_long);
}

}  // namespace

std::string to_string(Ending ending) {
  for (const auto& [known, name] : ending_names)
    if (known == ending) return name;
  throw std::logic_error("an ending without a name");
}

Outcome outcome_of(const Folder& folder, const Point& point) {
  if (!point.scene) return {Ending::refused, point.refused};
  const Json marked = read_json(folder.mark(point.id));
  if (!marked.is_object()) return {};
  const Json settings = Json::parse(scenes::resolved_json(*point.scene));
  const std::string ending = marked.value("ending", ""), reason = marked.value("reason", "");
  const std::string solver = to_string(point.solver);
  if (!runs::same_settings(solver, marked.value("settings", Json()), settings)) return {};
  for (const Ending without_data : {Ending::refused, Ending::crashed, Ending::too_long})
    if (ending == to_string(without_data)) return {without_data, reason};
  return ending_in(folder.run(point.id), solver, settings);
}

bool ended_by_machine(const Folder& folder, const std::string& id) {
  const Json info = read_json(folder.run(id) / "run.json");
  return info.is_object() && by_machine(info);
}

int run_job(const fs::path& root, const std::string& id) {
  const Folder folder{root};
  const Job job = read_job(folder, id);
  const auto begin = Clock::now();
  const bool whole = !job.is_gradient() || fs::exists(folder.run(id) / "gradient.json");
  if (const Outcome there = ending_in(folder.run(id), job.solver, job.settings);
      whole && there.ending == Ending::finished) {
    mark(folder, job, there, 0.0);  // it ended, but whoever waited for it was killed before it could say so
    return 0;
  }
  fs::create_directories(folder.log(id).parent_path());
  fs::create_directories(folder.run(id).parent_path());
  clear_unusable(folder, job);
  const runs::InterruptGuard guard;
  const bool begun = !job.is_gradient() && has_begun(folder, job);
  Outcome outcome = attempt(folder, job, begun, begin);
  if (begun && (outcome.ending == Ending::crashed || outcome.ending == Ending::refused)) {
    // What it left could not be gone on with, which says nothing of the run.
    remove_run(folder.run(id));
    outcome = attempt(folder, job, false, begin);
  }
  constexpr int interrupted = 130;
  if (outcome.ending == Ending::missing) return runs::InterruptGuard::count() > 0 ? interrupted : 1;
  mark(folder, job, outcome, seconds_since(begin));
  return 0;
}

}  // namespace flowrest::studies
