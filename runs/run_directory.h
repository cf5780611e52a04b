#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runs/columns.h"
#include "runs/csv.h"
#include "runs/errors.h"
#include "runs/folder_lock.h"
#include "runs/machine.h"
#include "runs/output_file.h"
#include "runs/run_folder.h"
#include "scenes/scene.h"

/// The run directory: what every run leaves and the comparison reads, whoever made it.
namespace flowrest::runs {

/// What run.json says of itself.
inline constexpr const char* run_format = "flowrest run";
inline constexpr int run_format_version = 1;

/// The result of run.json's `status`.
enum class Status { running, at_rest, end_time, interrupted, failed };
std::string to_string(Status);

std::optional<Status> status_from(const std::string&);

/// A run.json, where it is one of ours; else nothing, and `problem` says why. It stays what it is where there
/// is no such file.
std::optional<nlohmann::ordered_json> read_info(const std::filesystem::path&, std::string& problem);

/// The time that a run has reached, s; 0 where its run.json does not say. Runs by OpenFOAM of version 0.1.0
/// call it `time_reached_s`.
double simulated_time(const nlohmann::ordered_json& info);

/// Replaces a file atomically: a reader sees the old text or the new one, never a part.
/// @throws RunError where it cannot be written, MachineError where that is the machine's fault.
void write_atomically(const std::filesystem::path&, const std::string& text);

/// Where a run is gone on with, s. The end of a run may have left rows that a longer one does not have.
struct Continuation {
  Continuation(double at) : time(at), history(at), profiles(at) {}
  Continuation(double at, double last_row, double last_profile)
      : time(at), history(last_row), profiles(last_profile) {}
  double time;
  double history, profiles;  ///< until when rows and profiles are kept
};

/// Writes a run directory and holds it while it lives. CSV rows are appended as they come, so an interrupted
/// run is readable; run.json is replaced atomically. Numbers are written with 17 significant digits, a gauge
/// that reads nothing (`runs::nothing`) as an empty cell. Every method that writes throws MachineError where
/// the disk is full; run.json can be written all the same, as some room is kept for it.
class RunWriter {
 public:
  /// Writes a first run.json with status "running"; an earlier run in the folder is removed (only files a run
  /// leaves).
  explicit RunWriter(RunFolder);
  /// The same, where the folder may be taken: see RunFolder. `solver` is "mpm", "foam" or "exact".
  RunWriter(const std::filesystem::path& directory, const scenes::Scene&, const std::string& solver,
            Replace = Replace::failed);
  ~RunWriter() = default;
  RunWriter(RunWriter&&) = default;

  /// Opens a run to go on with, under the scene's settings, which may have a later end: history.csv and
  /// profiles.csv are cut back.
  static RunWriter resume(const std::filesystem::path& directory, const scenes::Scene&, const Continuation&);
  static RunWriter resume(FolderLock, const scenes::Scene&, const Continuation&);

  /// Names the columns of history.csv; the first is time_s. Call once, before the first row (not on a resumed
  /// run, where the same columns are checked against the file's).
  void history_columns(const std::vector<std::string>& names);
  /// Appends a row; each time once: a second row of the same time is left out.
  void history(std::span<const double> row);

  /// The same by column: the first row names them.
  void history(const Row&);

  /// Appends one profile, each time once: rows (time, coordinate, value). The columns are those of
  /// the pieces' profile axis: time_s,r_m,depth_m about an axis, time_s,x_m,depth_m along a plane or a channel,
  /// time_s,y_m,velocity_m_s between plates.
  void profile(double time, std::span<const double> coordinate, std::span<const double> value);

  std::optional<double> last_profile() const { return last_profile_; }  ///< s

  /// run.json: any key may be set; written out by `write` and by `finish`.
  nlohmann::ordered_json& info() { return info_; }
  void write();
  /// Writes the final run.json: status, reason (may be empty) and verdict: "sound", or what is in doubt and
  /// why (runs/verdict.h). A run that failed is never sound, whatever the verdict says.
  void finish(Status, const std::string& reason, const std::string& verdict);
  /// The same of a run that failed: its verdict is that of the failure, or the one given where that knows of
  /// noise.
  void fail(const Failure&, const std::string& verdict = "");

  const std::filesystem::path& directory() const { return lock_.folder(); }

 private:
  RunWriter(FolderLock, std::string profile_header, nlohmann::ordered_json info);
  std::filesystem::path file(const char* name) const { return directory() / name; }
  void cut_back_to(const Continuation&);

  FolderLock lock_;
  nlohmann::ordered_json info_;
  std::optional<OutputFile> history_, profiles_;
  std::vector<std::string> history_columns_;
  std::string profile_header_;
  std::optional<double> last_row_, last_profile_;  ///< s
};

struct Profile {
  double time = 0.0;               ///< s
  std::vector<double> coordinate;  ///< m
  std::vector<double> value;       ///< depth in m, or velocity in m/s
};

/// A run as read back.
struct Run {
  std::filesystem::path directory;
  nlohmann::ordered_json info;
  Table history;
  std::vector<Profile> profiles;  ///< ascending in time
  /// run.json's `label` where it has one, else solver and model: "MPM elasto-viscoplastic"; made unique by
  /// the comparison where needed.
  std::string label() const;
  Status status() const;
};
/// @throws RunError where something is missing or malformed; an interrupted or failed run reads as far as it
/// came. Either CSV file may be missing (measured data need not have both), but a finished run must have one.
Run read_run(const std::filesystem::path&);

/// Provenance keys every run.json carries: versions, git hash, compiler, CPU model, cores.
nlohmann::ordered_json provenance();

/// The version of flowrest in a provenance, to the commit: "1.0.0 (commit 1a2b3c, modified)".
std::string version_in(const nlohmann::ordered_json& provenance);

/// The most memory that this process, or any one child it has waited for, has held at once, bytes.
double peak_memory_bytes();

/// Seconds by a clock that only goes on, for wall times.
double wall_seconds();

/// CPU seconds of this process and, where `children`, of its finished children.
double cpu_seconds(bool children = false);

}  // namespace flowrest::runs
