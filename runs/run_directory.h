#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/scene.h"

/// The run directory: what every run leaves and the comparison reads, whoever made it.
namespace flowrest::runs {

/// A run directory that cannot be written or read. what() names the file, what is wrong and what is expected.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The numerics failed (exit 3): the run directory stays, with the reason.
class NumericsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A program that is needed is missing (exit 4). what() says which and how to get it.
class MissingProgram : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The result of run.json's `status`.
enum class Status { running, at_rest, end_time, interrupted, failed };
std::string to_string(Status);

/// Replaces a file atomically: a reader sees the old text or the new one, never a part.
/// @throws RunError where it cannot be written.
void write_atomically(const std::filesystem::path&, const std::string& text);

/// Writes a run directory. CSV rows are appended and flushed as they come, so an interrupted run is readable;
/// run.json is replaced atomically. Numbers are written with 17 significant digits; a gauge that
/// reads nothing (`runs::nothing`) as an empty cell.
class RunWriter {
 public:
  /// Creates `directory` and writes a first run.json with status "running". `solver` is "mpm", "foam" or
  /// "exact".
  /// @throws RunError where the directory exists and is neither empty nor a run of flowrest (run.json marks
  /// one). An earlier run in it is removed first (only files a run leaves).
  RunWriter(const std::filesystem::path& directory, const scenes::Scene&, const std::string& solver);

  /// Opens a run to go on with: history.csv and profiles.csv are cut back to rows with time_s <= `time`.
  static RunWriter resume(const std::filesystem::path& directory, const scenes::Scene&, double time);

  /// Names the columns of history.csv; the first is time_s. Call once, before the first row (not on a resumed
  /// run, where the same columns are checked against the file's).
  void history_columns(const std::vector<std::string>& names);
  void history(std::span<const double> row);

  /// Appends one profile: rows (time, coordinate, value). The columns follow the scene's kind:
  /// slump time_s,r_m,depth_m; duct time_s,y_m,velocity_m_s; others time_s,x_m,depth_m.
  void profile(double time, std::span<const double> coordinate, std::span<const double> value);

  /// run.json: any key may be set; written out by `write` and by `finish`.
  nlohmann::ordered_json& info() { return info_; }
  void write();
  /// Writes the final run.json: status, reason (may be empty) and verdict ("sound" or "noisy: why").
  void finish(Status, const std::string& reason, const std::string& verdict);

  const std::filesystem::path& directory() const { return directory_; }

 private:
  RunWriter() = default;
  std::filesystem::path directory_;
  nlohmann::ordered_json info_;
  std::ofstream history_, profiles_;
  std::vector<std::string> history_columns_;
  std::string profile_header_;
};

/// A table read from CSV: named columns of equal length.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  bool has(const std::string& name) const;
  /// @throws RunError naming the columns there are.
  const std::vector<double>& at(const std::string& name) const;
  std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};
/// A last line that does not end in a newline was cut off by an interruption and is left out, unless
/// `complete` says that whoever wrote the file came to the end of it. An empty cell reads nothing
/// (`runs::nothing`).
/// @throws RunError with file:line of the first malformed row.
Table read_csv(const std::filesystem::path&, bool complete = false);

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

/// The most memory that this process, or any one child it has waited for, has held at once, bytes.
double peak_memory_bytes();

/// CPU seconds of this process and, where `children`, of its finished children.
double cpu_seconds(bool children = false);

}  // namespace flowrest::runs
