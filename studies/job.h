#pragma once

#include <filesystem>
#include <string>

#include "studies/study.h"

/// One run of a study: how it is made, and when it counts.
namespace flowrest::studies {

/// What is kept of a study on disk. Every path is below one folder:
/// jobs.json and jobs/ID.toml (what is to be run), runs/ID (run directories), logs/ID.log, and ended/ID.json,
/// which is written when a run has come to an end of its own and never before.
struct Folder {
  std::filesystem::path root;
  std::filesystem::path jobs_file() const { return root / "jobs.json"; }
  std::filesystem::path scene(const std::string& id) const { return root / "jobs" / (id + ".toml"); }
  std::filesystem::path run(const std::string& id) const { return root / "runs" / id; }
  std::filesystem::path log(const std::string& id) const { return root / "logs" / (id + ".log"); }
  std::filesystem::path mark(const std::string& id) const { return root / "ended" / (id + ".json"); }
};

/// How a run ended.
enum class Ending {
  missing,   ///< not made, or not to its end
  finished,  ///< at rest or at its end time
  stopped,   ///< by the solver, with a reason
  refused,   ///< before it began
  crashed,   ///< by a signal or an error that nobody foresaw
  too_long   ///< took longer than the study allows
};
std::string to_string(Ending);

struct Outcome {
  Ending ending = Ending::missing;
  std::string reason;
};

/// How the run of a point ended. A mark counts only if the run directory itself says that the run ended, that
/// it was this run (the same resolved settings), and can be read.
Outcome outcome_of(const Folder&, const Point&);

/// Whether the machine ended a run, as where the disk is full: it is to be gone on with and says nothing of
/// the settings.
bool ended_by_machine(const Folder&, const std::string& id);

/// Makes the run of one job of jobs.json, or goes on with it, and marks it as ended. Called by the workflow.
/// @return the exit code: 0 where the run has ended, whatever way; 130 where it was interrupted; 4 where a
/// program is missing; 5 where the machine failed; 1 where it was killed.
int run_job(const std::filesystem::path& root, const std::string& id);

}  // namespace flowrest::studies
