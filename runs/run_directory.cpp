#include "runs/run_directory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>

#include "runs/depth.h"
#include "runs/folder.h"
#include "runs/gauges.h"

namespace flowrest::runs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* format_name = "flowrest run";
constexpr int format_version = 1;

const std::array<std::pair<Status, const char*>, 5> status_names = {{{Status::running, "running"},
                                                                     {Status::at_rest, "at-rest"},
                                                                     {Status::end_time, "end-time"},
                                                                     {Status::interrupted, "interrupted"},
                                                                     {Status::failed, "failed"}}};

std::optional<Status> status_from(const std::string& name) {
  for (const auto& [status, text] : status_names)
    if (name == text) return status;
  return std::nullopt;
}

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw RunError(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw RunError(fmt::format("{}: cannot be read to its end", path.string()));
  return text;
}

/// Reads and checks run.json's marks; `problem` is set instead where it is not one of ours.
std::optional<Json> read_info(const fs::path& path, std::string& problem) {
  Json info = Json::parse(read_text(path), nullptr, false);
  if (info.is_discarded() || !info.is_object()) {
    problem = "it is not a JSON object";
    return std::nullopt;
  }
  const auto name = info.find("format");
  const auto version = info.find("format_version");
  if (name == info.end() || *name != format_name || version == info.end() || !version->is_number_integer()) {
    problem = fmt::format("it does not say \"format\": \"{}\" with a \"format_version\"", format_name);
    return std::nullopt;
  }
  if (*version != format_version) {
    problem =
        fmt::format("its format_version is {}, this flowrest reads {}", version->dump(), format_version);
    return std::nullopt;
  }
  return info;
}

/// A number as CSV has it; what reads nothing is an empty cell.
std::string number(double value) { return std::isnan(value) ? "" : fmt::format("{:.17g}", value); }

std::string joined(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ",")); }

void append(std::ofstream& file, const fs::path& path, const std::string& text) {
  file << text << std::flush;
  if (!file) throw RunError(fmt::format("{}: cannot be written (is the disk full?)", path.string()));
}

std::ofstream open_to_append(const fs::path& path) {
  std::ofstream file(path, std::ios::binary | std::ios::app);
  if (!file) throw RunError(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
  return file;
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0;;) {
    const auto comma = line.find(',', begin);
    cells.push_back(trimmed(line.substr(begin, comma == std::string_view::npos ? comma : comma - begin)));
    if (comma == std::string_view::npos) return cells;
    begin = comma + 1;
  }
}

std::optional<double> parsed(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  // Underflow and overflow are numbers all the same; from_chars leaves the value alone there.
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(text).c_str(), nullptr);
  return error == std::errc{} ? std::optional(value) : std::nullopt;
}

struct Line {
  std::string_view text;
  bool ended = false;  ///< by a newline
};

std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const auto end = text.find('\n', begin);
    const bool ended = end != std::string_view::npos;
    lines.push_back({text.substr(begin, ended ? end - begin : end), ended});
    begin = ended ? end + 1 : text.size();
  }
  return lines;
}

/// Cuts a CSV file back to whole rows whose first number is at most `time`; returns its header ("" where
/// there is none).
std::string cut_back(const fs::path& path, double time) {
  if (!fs::exists(path)) return "";
  const std::string text = read_text(path);
  const auto lines = lines_of(text);
  if (lines.empty() || !lines.front().ended) {
    fs::remove(path);
    return "";
  }
  std::string kept(lines.front().text);
  kept += '\n';
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (!lines[i].ended) break;
    const auto row_time = parsed(cells_of(lines[i].text).front());
    if (!row_time || *row_time > time) continue;
    kept.append(lines[i].text);
    kept += '\n';
  }
  write_atomically(path, kept);
  return std::string(trimmed(lines.front().text));
}

std::string profile_header(scenes::Kind kind) {
  switch (kind) {
    case scenes::Kind::slump:
      return "time_s,r_m,depth_m";
    case scenes::Kind::duct:
      return "time_s,y_m,velocity_m_s";
    case scenes::Kind::l_box:
    case scenes::Kind::v_funnel:
    case scenes::Kind::dam_break:
      return "time_s,x_m,depth_m";
  }
  throw std::logic_error("a kind of scene without profiles");
}

/// What runs leave beside run.json. Nothing else in a run directory is ever removed.
void remove_outputs(const fs::path& directory) {
  for (const char* name : {"history.csv", "profiles.csv", "particles", "case"})
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
                    path.string(), joined(table.names)));
  std::vector<Profile> profiles;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double time = table.columns[0][row];
    if (profiles.empty() || time != profiles.back().time) {
      if (!std::isfinite(time) || (!profiles.empty() && time < profiles.back().time))
        throw RunError(fmt::format("{}:{}: time {} does not follow {}; times must ascend", path.string(),
                                   row + 2, time, profiles.empty() ? 0.0 : profiles.back().time));
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

void write_atomically(const fs::path& path, const std::string& text) {
  const fs::path partial = path.string() + ".part";
  std::ofstream file(partial, std::ios::binary | std::ios::trunc);
  file << text << std::flush;
  file.close();
  std::error_code error;
  if (file) fs::rename(partial, path, error);
  if (!file || error) {
    const std::string why = error ? error.message() : std::strerror(errno);
    fs::remove(partial, error);
    throw RunError(fmt::format("{}: cannot be written: {}", path.string(), why));
  }
}

RunWriter::RunWriter(const fs::path& directory, const scenes::Scene& scene, const std::string& solver)
    : directory_(directory), profile_header_(profile_header(scene.kind)) {
  make_folder(directory);
  if (!fs::is_empty(directory)) {
    std::string problem = "it has no run.json";
    if (!fs::exists(directory / "run.json") || !read_info(directory / "run.json", problem))
      throw RunError(
          fmt::format("{}: not empty and not a run of flowrest ({}); name a new or an empty folder",
                      directory.string(), problem));
  }
  info_ = {{"format", format_name},
           {"format_version", format_version},
           {"title", scene.title},
           {"scene_name", scene.name},
           {"kind", scenes::to_string(scene.kind)},
           {"solver", solver},
           {"model", scenes::to_string(scene.material.model)},
           {"status", to_string(Status::running)},
           {"reason", ""},
           {"verdict", ""},
           {"provenance", provenance()},
           {"scene", scene.source},
           {"settings", Json::parse(scenes::resolved_json(scene))},
           {"resolved_toml", scenes::resolved_toml(scene)},
           {"gauges", gauge_definitions(scene)}};
  // First the new run.json: killed at any moment, the folder stays recognisable, can be gone on with and no
  // old status vouches for new data.
  write();
  remove_outputs(directory);
}

RunWriter RunWriter::resume(const fs::path& directory, const scenes::Scene& scene, double time) {
  RunWriter writer;
  writer.directory_ = directory;
  writer.profile_header_ = profile_header(scene.kind);
  std::string problem = "it is missing";
  const fs::path path = directory / "run.json";
  auto info = fs::exists(path) ? read_info(path, problem) : std::nullopt;
  if (!info) throw RunError(fmt::format("{}: cannot be resumed: {}", path.string(), problem));
  writer.info_ = std::move(*info);
  writer.info_["status"] = to_string(Status::running);
  writer.info_["reason"] = "";
  writer.info_["verdict"] = "";
  writer.info_["resumed_at_s"].push_back(time);
  writer.info_["provenance"] = provenance();
  writer.write();
  const std::string header = cut_back(directory / "history.csv", time);
  if (!header.empty()) {
    for (const auto cell : cells_of(header)) writer.history_columns_.emplace_back(cell);
    writer.history_ = open_to_append(directory / "history.csv");
  }
  const std::string profiles = cut_back(directory / "profiles.csv", time);
  if (!profiles.empty()) {
    if (profiles != writer.profile_header_)
      throw RunError(fmt::format("{}:1: the columns are '{}', a {} writes '{}'",
                                 (directory / "profiles.csv").string(), profiles,
                                 scenes::to_string(scene.kind), writer.profile_header_));
    writer.profiles_ = open_to_append(directory / "profiles.csv");
  }
  return writer;
}

void RunWriter::history_columns(const std::vector<std::string>& names) {
  if (names.empty() || names.front() != "time_s")
    throw std::invalid_argument("the first column must be time_s");
  const fs::path path = directory_ / "history.csv";
  if (!history_columns_.empty()) {
    if (names != history_columns_)
      throw RunError(fmt::format("{}:1: the columns are '{}', this run would write '{}'", path.string(),
                                 joined(history_columns_), joined(names)));
    return;
  }
  history_columns_ = names;
  history_ = open_to_append(path);
  append(history_, path, joined(names) + '\n');
}

void RunWriter::history(std::span<const double> row) {
  if (row.empty() || row.size() != history_columns_.size())
    throw std::invalid_argument(
        fmt::format("{} numbers for {} columns", row.size(), history_columns_.size()));
  std::string line;
  for (const double value : row) line += number(value) + ',';
  line.pop_back();
  line += '\n';
  append(history_, directory_ / "history.csv", line);
}

void RunWriter::profile(double time, std::span<const double> coordinate, std::span<const double> value) {
  if (coordinate.size() != value.size())
    throw std::invalid_argument("a profile needs as many values as coordinates");
  const fs::path path = directory_ / "profiles.csv";
  std::string text;
  if (!profiles_.is_open()) {
    profiles_ = open_to_append(path);
    text = profile_header_ + '\n';
  }
  const std::string time_text = number(time);
  for (std::size_t i = 0; i < coordinate.size(); ++i)
    text += time_text + ',' + number(coordinate[i]) + ',' + number(value[i]) + '\n';
  append(profiles_, path, text);
}

void RunWriter::write() {
  // Whatever bytes a message holds, run.json is written: invalid UTF-8 is replaced, never thrown at.
  write_atomically(directory_ / "run.json", info_.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

void RunWriter::finish(Status status, const std::string& reason, const std::string& verdict) {
  info_["status"] = to_string(status);
  info_["reason"] = reason;
  info_["verdict"] = verdict;
  info_["peak_memory_bytes"] = peak_memory_bytes();
  write();
}

bool Table::has(const std::string& name) const {
  return std::find(names.begin(), names.end(), name) != names.end();
}

const std::vector<double>& Table::at(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw RunError(fmt::format("no column '{}'; there are: {}", name, joined(names)));
  return columns[static_cast<std::size_t>(found - names.begin())];
}

Table read_csv(const fs::path& path, bool complete) {
  const std::string text = read_text(path);
  auto lines = lines_of(text);
  if (!complete && !lines.empty() && !lines.back().ended) lines.pop_back();
  Table table;
  if (lines.empty()) return table;
  for (const auto cell : cells_of(lines.front().text)) {
    if (cell.empty() || table.has(std::string(cell)))
      throw RunError(fmt::format("{}:1: column {} is {}; every column needs a name of its own", path.string(),
                                 table.names.size() + 1,
                                 cell.empty() ? "unnamed" : "a second '" + std::string(cell) + "'"));
    table.names.emplace_back(cell);
  }
  table.columns.resize(table.names.size());
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (trimmed(lines[i].text).empty()) continue;
    const auto cells = cells_of(lines[i].text);
    if (cells.size() != table.names.size())
      throw RunError(fmt::format("{}:{}: {} values where the header names {}", path.string(), i + 1,
                                 cells.size(), table.names.size()));
    for (std::size_t column = 0; column < cells.size(); ++column) {
      const auto value = cells[column].empty() ? nothing : parsed(cells[column]);
      if (!value)
        throw RunError(fmt::format("{}:{}: '{}' in column {} is not a number", path.string(), i + 1,
                                   std::string(cells[column]), table.names[column]));
      table.columns[column].push_back(*value);
    }
  }
  return table;
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
