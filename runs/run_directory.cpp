#include "runs/run_directory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <system_error>

#include "runs/command.h"
#include "runs/depth.h"
#include "runs/gauges.h"
#include "scenes/pieces.h"
#include "scenes/plausibility.h"

namespace flowrest::runs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

const std::array<std::pair<Status, const char*>, 5> status_names = {{{Status::running, "running"},
                                                                     {Status::at_rest, "at-rest"},
                                                                     {Status::end_time, "end-time"},
                                                                     {Status::interrupted, "interrupted"},
                                                                     {Status::failed, "failed"}}};

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw RunError(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw RunError(fmt::format("{}: cannot be read to its end", path.string()));
  return text;
}

/// A number as CSV has it; what reads nothing is an empty cell.
std::string number(double value) { return std::isnan(value) ? "" : fmt::format("{:.17g}", value); }

/// What runs leave beside run.json. Nothing else in a run directory is ever removed.
void remove_outputs(const fs::path& directory) {
  for (const char* name : {"history.csv", "profiles.csv", "particles", "case", "fields"})
    fs::remove_all(directory / name);
  std::vector<fs::path> leftovers;
  for (const auto& entry : fs::directory_iterator(directory))
    if (entry.path().filename().string().starts_with("checkpoint")) leftovers.push_back(entry.path());
  for (const auto& path : leftovers) fs::remove_all(path);
}

std::vector<Profile> profiles_of(const Table& table, const fs::path& path) {
  if (table.columns.size() != 3 || table.names.front() != "time_s")
    throw RunError(
        fmt::format("{}:1: the columns are '{}'; three are expected: time_s, a coordinate, a value",
                    path.string(), csv_header(table.names)));
  std::vector<Profile> profiles;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double time = table.columns[0][row];
    if (profiles.empty() || time != profiles.back().time) {
      if (!std::isfinite(time) || (!profiles.empty() && time < profiles.back().time))
        throw RunError(fmt::format("{}:{}: time {} does not follow {}; times must ascend", path.string(),
                                   table.lines[row], time, profiles.empty() ? 0.0 : profiles.back().time));
      profiles.push_back({time, {}, {}});
    }
    profiles.back().coordinate.push_back(table.columns[1][row]);
    profiles.back().value.push_back(table.columns[2][row]);
  }
  return profiles;
}

}  // namespace

std::string to_string(Status status) {
  for (const auto& [known, text] : status_names)
    if (status == known) return text;
  throw std::logic_error("a status without a name");
}

std::optional<Status> status_from(const std::string& name) {
  for (const auto& [status, text] : status_names)
    if (name == text) return status;
  return std::nullopt;
}

std::optional<Json> read_info(const fs::path& path, std::string& problem) {
  if (!fs::exists(path)) return std::nullopt;
  Json info = Json::parse(read_text(path), nullptr, false);
  if (info.is_discarded() || !info.is_object()) {
    problem = "it is not a JSON object";
    return std::nullopt;
  }
  const auto name = info.find("format");
  const auto version = info.find("format_version");
  if (name == info.end() || *name != run_format || version == info.end() || !version->is_number_integer()) {
    problem = fmt::format("it does not say \"format\": \"{}\" with a \"format_version\"", run_format);
    return std::nullopt;
  }
  if (*version != run_format_version) {
    problem =
        fmt::format("its format_version is {}, this flowrest reads {}", version->dump(), run_format_version);
    return std::nullopt;
  }
  return info;
}

double simulated_time(const Json& info) {
  for (const char* key : {"simulated_s", "time_reached_s"})
    if (const auto found = info.find(key); found != info.end() && found->is_number()) return *found;
  return 0.0;
}

void write_atomically(const fs::path& path, const std::string& text) {
  const fs::path partial = path.string() + ".part";
  std::error_code error;
  try {
    OutputFile file(partial, true);
    file.append(text);
    file.close();
    fs::rename(partial, path, error);
    if (error) cannot_be_written(path, error.value());
  } catch (...) {
    fs::remove(partial, error);
    throw;
  }
}

RunWriter::RunWriter(FolderLock lock, std::string profile_header, Json info)
    : lock_(std::move(lock)), info_(std::move(info)), profile_header_(std::move(profile_header)) {
  lock_.keep_room();
}

RunWriter::RunWriter(RunFolder folder)
    : RunWriter(std::move(folder.lock_), std::move(folder.profile_header_), std::move(folder.info_)) {
  // First the new run.json: killed at any moment, the folder stays recognisable, can be gone on with and no
  // old status vouches for new data.
  write();
  remove_outputs(directory());
}

RunWriter::RunWriter(const fs::path& directory, const scenes::Scene& scene, const std::string& solver,
                     Replace replace)
    : RunWriter(RunFolder(directory, scene, solver, replace)) {}

RunWriter RunWriter::resume(const fs::path& directory, const scenes::Scene& scene, const Continuation& at) {
  return resume(FolderLock(directory), scene, at);
}

RunWriter RunWriter::resume(FolderLock lock, const scenes::Scene& scene, const Continuation& at) {
  const fs::path directory = lock.folder(), path = directory / "run.json";
  std::string problem = "it is missing";
  auto info = read_info(path, problem);
  if (!info) throw RunError(fmt::format("{}: cannot be resumed: {}", path.string(), problem));
  RunWriter writer(std::move(lock), scenes::pieces_of(scene).profile.header(), std::move(*info));
  if (const std::string there = header_of_csv(directory / "profiles.csv");
      !there.empty() && there != writer.profile_header_)
    throw RunError(fmt::format("{}:1: the columns are '{}', a {} writes '{}'",
                               (directory / "profiles.csv").string(), there,
                               scenes::name_of(scene.geometry.apparatus), writer.profile_header_));
  writer.info_["status"] = to_string(Status::running);
  writer.info_["reason"] = "";
  writer.info_["verdict"] = "";
  writer.info_.erase("failure");
  writer.info_["resumed_at_s"].push_back(at.time);
  writer.info_["provenance"] = provenance();
  if (writer.info_.contains("request")) writer.info_["request"] = request_json(scene.request);
  writer.info_["settings"] = Json::parse(scenes::resolved_json(scene));
  writer.info_["resolved_toml"] = scenes::resolved_toml(scene);
  writer.write();
  try {
    writer.cut_back_to(at);
  } catch (const std::exception&) {
    writer.fail(failure_at_hand(0.0));
    throw;
  }
  return writer;
}

void RunWriter::cut_back_to(const Continuation& at) {
  last_row_ = cut_csv_back(file("history.csv"), at.history);
  last_profile_ = cut_csv_back(file("profiles.csv"), at.profiles);
  if (const std::string header = header_of_csv(file("history.csv")); !header.empty()) {
    std::istringstream names(header);
    for (std::string name; std::getline(names, name, ',');) history_columns_.push_back(name);
    history_.emplace(file("history.csv"));
  }
  if (!header_of_csv(file("profiles.csv")).empty()) profiles_.emplace(file("profiles.csv"));
}

void RunWriter::history_columns(const std::vector<std::string>& names) {
  if (names.empty() || names.front() != "time_s")
    throw std::invalid_argument("the first column must be time_s");
  const fs::path path = file("history.csv");
  if (!history_columns_.empty()) {
    if (names != history_columns_)
      throw RunError(fmt::format("{}:1: the columns are '{}', this run would write '{}'", path.string(),
                                 csv_header(history_columns_), csv_header(names)));
    return;
  }
  history_columns_ = names;
  history_.emplace(path);
  history_->append(csv_header(names) + '\n');
}

void RunWriter::history(std::span<const double> row) {
  if (row.empty() || row.size() != history_columns_.size())
    throw std::invalid_argument(
        fmt::format("{} numbers for {} columns", row.size(), history_columns_.size()));
  if (row.front() == last_row_) return;
  last_row_ = row.front();
  std::string line;
  for (const double value : row) line += number(value) + ',';
  line.pop_back();
  line += '\n';
  history_->append(line);
}

void RunWriter::history(const Row& row) {
  history_columns(row.names());
  history(std::span<const double>(row.values()));
}

void RunWriter::profile(double time, std::span<const double> coordinate, std::span<const double> value) {
  if (coordinate.size() != value.size())
    throw std::invalid_argument("a profile needs as many values as coordinates");
  if (time == last_profile_) return;
  last_profile_ = time;
  std::string text;
  if (!profiles_) {
    profiles_.emplace(file("profiles.csv"));
    text = profile_header_ + '\n';
  }
  const std::string time_text = number(time);
  for (std::size_t i = 0; i < coordinate.size(); ++i)
    text += time_text + ',' + number(coordinate[i]) + ',' + number(value[i]) + '\n';
  profiles_->append(text);
}

void RunWriter::write() {
  // Whatever bytes a message holds, run.json is written: invalid UTF-8 is replaced, never thrown at.
  const std::string text = info_.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
  try {
    write_atomically(file("run.json"), text);
  } catch (const MachineError&) {
    lock_.give_room();
    write_atomically(file("run.json"), text);
  }
}

void RunWriter::finish(Status status, const std::string& reason, const std::string& verdict) {
  info_["status"] = to_string(status);
  info_["reason"] = reason;
  info_["verdict"] =
      status == Status::failed && verdict == "sound" ? verdict_of_failure(Fault::numerics) : verdict;
  info_["peak_memory_bytes"] = peak_memory_bytes();
  write();
}

void RunWriter::fail(const Failure& failure, const std::string& verdict) {
  info_["failure"] = to_string(failure.fault);
  finish(Status::failed, failure.reason,
         verdict.starts_with("noisy") ? verdict : verdict_of_failure(failure.fault));
}

std::string Run::label() const {
  if (const auto label = info.find("label"); label != info.end() && label->is_string())
    return label->get<std::string>();
  const std::string solver = info.at("solver").get<std::string>();
  const std::string shown = solver == "mpm" ? "MPM" : solver == "foam" ? "OpenFOAM" : solver;
  const auto model = info.find("model");
  return model != info.end() && model->is_string() && !model->get<std::string>().empty()
             ? shown + " " + model->get<std::string>()
             : shown;
}

Status Run::status() const { return *status_from(info.at("status").get<std::string>()); }

Run read_run(const fs::path& directory) {
  Run run;
  run.directory = directory;
  const fs::path path = directory / "run.json";
  if (!fs::exists(path))
    throw RunError(fmt::format("{}: there is no run.json; a run directory is expected", directory.string()));
  std::string problem;
  auto info = read_info(path, problem);
  if (!info) throw RunError(fmt::format("{}: not a run of flowrest: {}", path.string(), problem));
  run.info = std::move(*info);
  for (const char* key : {"title", "kind", "solver", "status"})
    if (!run.info.contains(key) || !run.info[key].is_string())
      throw RunError(fmt::format("{}: the text '{}' is missing", path.string(), key));
  const auto status = status_from(run.info["status"].get<std::string>());
  if (!status)
    throw RunError(
        fmt::format("{}: status '{}' is unknown; allowed: running, at-rest, end-time, interrupted, failed",
                    path.string(), run.info["status"].get<std::string>()));
  const bool complete = *status == Status::at_rest || *status == Status::end_time;
  const fs::path history = directory / "history.csv";
  const fs::path profiles = directory / "profiles.csv";
  if (fs::exists(history)) {
    run.history = read_csv(history, complete);
    if (!run.history.names.empty() && run.history.names.front() != "time_s")
      throw RunError(fmt::format("{}:1: the first column is '{}'; time_s is expected", history.string(),
                                 run.history.names.front()));
    for (std::size_t row = 0; row < run.history.rows(); ++row) {
      const auto& time = run.history.columns.front();
      if (!std::isfinite(time[row]) || (row > 0 && time[row] < time[row - 1]))
        throw RunError(
            fmt::format("{}: time {} in data row {} does not ascend", history.string(), time[row], row + 1));
    }
  }
  if (fs::exists(profiles)) {
    const Table table = read_csv(profiles, complete);
    if (!table.names.empty()) run.profiles = profiles_of(table, profiles);
    // A profile cut off in the middle would read as material that ends there.
    if (const auto count = run.profiles.size();
        !complete && count > 1 &&
        run.profiles[count - 1].coordinate.size() < run.profiles[count - 2].coordinate.size())
      run.profiles.pop_back();
  }
  if (complete && run.history.rows() == 0 && run.profiles.empty())
    throw RunError(fmt::format("{}: the run is '{}' but has neither history.csv nor profiles.csv",
                               directory.string(), run.info["status"].get<std::string>()));
  return run;
}

}  // namespace flowrest::runs
