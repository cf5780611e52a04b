#include "foamCases/run_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

#include "foamCases/apparatus/apparatus.h"
#include "foamCases/case_fields.h"
#include "foamCases/case_filler.h"
#include "foamCases/field_file.h"
#include "foamCases/sampler.h"
#include "runs/command.h"
#include "runs/run_directory.h"

namespace flowrest::foam {

namespace fs = std::filesystem;

namespace {

constexpr const char* ranks_key = "\nranks ";
constexpr const char* end_key = "\nendTime ";

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Ranks may differ from one leg of a run to the next, and its end; nothing else of the parameters may.
std::string without_ranks(const std::string& text) { return text.substr(0, text.find(ranks_key)); }

std::string without_end(const std::string& parameters) {
  const auto begin = parameters.find(end_key);
  if (begin == std::string::npos) return parameters;
  return parameters.substr(0, begin) + parameters.substr(parameters.find('\n', begin + 1));
}

/// Cell fields of a full state, with their components.
std::vector<std::pair<std::string, int>> state_fields(const scenes::Scene& scene, bool plug_in) {
  std::vector<std::pair<std::string, int>> fields{{"alpha.concrete", 1}, {"U", 3}, {"p_rgh", 1}};
  if (laws::can_rest(scene.material.model)) fields.emplace_back("stress", 6);
  if (scene.thixotropy && plug_in) fields.emplace_back("flocculation", 1);
  return fields;
}

bool is_whole(const CaseFields& fields, const std::string& time, const scenes::Scene& scene, bool plug_in) {
  if (!fields.holds(time, "phi") || !fields.holds(time, "uniform/time")) return false;
  try {
    const std::size_t cells = case_of(scene)->cells();
    for (const auto& [name, components] : state_fields(scene, plug_in))
      fields.read(time, name, cells, components);
  } catch (const FieldError&) {
    return false;
  }
  return true;
}

/// Logs of earlier legs, in order; the latest is set aside under the next free name.
std::vector<fs::path> earlier_logs(const fs::path& case_directory) {
  std::vector<fs::path> logs;
  const auto leg = [&](std::size_t n) { return case_directory / fmt::format("log.interFoam.{}", n); };
  while (fs::exists(leg(logs.size() + 1))) logs.push_back(leg(logs.size() + 1));
  if (fs::exists(case_directory / "log.interFoam")) {
    const fs::path next = leg(logs.size() + 1);
    fs::rename(case_directory / "log.interFoam", next);
    logs.push_back(next);
  }
  return logs;
}

/// A table's whole rows up to a time.
runs::Table rows_until(const fs::path& path, double time) {
  if (!fs::exists(path)) return {};
  runs::Table table = runs::read_csv(path);
  if (table.columns.empty()) return table;
  const auto& times = table.columns.front();
  const auto count = std::upper_bound(times.begin(), times.end(), time) - times.begin();
  for (auto& column : table.columns) column.resize(static_cast<std::size_t>(count));
  return table;
}

std::vector<double> times_until(const fs::path& path, double time) {
  const runs::Table table = rows_until(path, time);
  return table.columns.empty() ? std::vector<double>{} : table.columns.front();
}

}  // namespace

EarlierRun read_earlier_run(const fs::path& directory, const std::vector<std::string>& set) {
  EarlierRun earlier;
  earlier.run = runs::read_earlier_run(directory, "foam");
  earlier.scene = runs::scene_to_go_on_with(earlier.run, set);
  const auto& info = earlier.run.info;
  const std::string parameters = text_of(directory / "case" / "sceneParameters");
  earlier.plug_in = parameters.find("libflowrestRheology") != std::string::npos;
  earlier.ranks = info.value("ranks", 1);
  if (info.contains("cpu_by_program_s"))
    earlier.cpu_by_program = info["cpu_by_program_s"].get<std::map<std::string, double>>();
  if (info.contains("wall_s")) earlier.wall = info["wall_s"];
  return earlier;
}

std::optional<StateTime> latest_whole_time(const fs::path& case_directory, const EarlierRun& earlier) {
  if (!fs::is_directory(case_directory)) return std::nullopt;
  const CaseFields fields(case_directory, CaseFields::ranks_in(case_directory));
  for (auto times = fields.times(); !times.empty() && times.back().first > 0.0; times.pop_back())
    if (is_whole(fields, times.back().second, earlier.scene, earlier.plug_in))
      return StateTime{times.back().first, times.back().second};
  return std::nullopt;
}

void check_case(const fs::path& case_directory, const EarlierRun& earlier) {
  const fs::path path = case_directory / "sceneParameters";
  if (!fs::exists(path))
    throw runs::RunError(
        fmt::format("{}: missing: this is no case that `flowrest foam` made", path.string()));
  const std::string before = without_ranks(scene_parameters(earlier.run.scene, earlier.plug_in));
  const std::string from_now_on = without_ranks(scene_parameters(earlier.scene, earlier.plug_in));
  const std::string there = without_ranks(text_of(path));
  if (there != before && there != from_now_on)
    throw runs::RunError(
        fmt::format("{}: it is not what `flowrest foam` writes for the scene in run.json; to go on, undo "
                    "what was changed in it",
                    path.string()));
  if (without_end(before) != without_end(from_now_on))
    throw runs::RunError(fmt::format(
        "{}: so short a run began with steps that hang on its end, time.end = {:g} s: a longer one "
        "would have begun otherwise; run it anew",
        earlier.run.directory.string(), earlier.run.scene.time.end));
}

void remove_later_times(const fs::path& case_directory, const StateTime& state) {
  const CaseFields fields(case_directory, CaseFields::ranks_in(case_directory));
  for (const auto& [time, name] : fields.times())
    if (time > state.time) fields.remove(name);
}

RunState take_up(const fs::path& directory, const EarlierRun& earlier, const StateTime& from) {
  const fs::path case_directory = directory / "case";
  remove_later_times(case_directory, from);
  RunState state;
  state.time = from.time;
  state.cpu_by_program = earlier.cpu_by_program;
  state.wall = earlier.wall;
  const auto& output = earlier.scene.output;
  state.last_row = last_regular_row(earlier.scene, output.history_interval,
                                    times_until(directory / "history.csv", from.time));
  state.last_profile = last_regular_row(earlier.scene, output.profile_interval,
                                        times_until(directory / "profiles.csv", from.time));
  state.overstresses = rows_until(case_directory / overstresses_file, from.time);
  double solved = 0.0;
  for (const auto& path : earlier_logs(case_directory)) {
    SolverLog log(solved_components(earlier.scene));
    log.feed(text_of(path));
    for (const auto& step : log.take_steps())
      if (step.time < state.time + 0.5 * step.time_step) state.steps.push_back(step);
    solved += log.execution_time();
  }
  if (!state.cpu_by_program.contains("interFoam")) state.cpu_by_program["interFoam"] = solved;
  return state;
}

void complete_last_state(const fs::path& case_directory, const SolverStep& last, double time_step_before,
                         std::size_t steps) {
  const auto times = CaseFields(case_directory, 1).times();
  if (times.empty() || std::abs(times.back().first - last.time) > 0.5 * last.time_step) return;
  const std::string& name = times.back().second;
  const fs::path file = case_directory / name / "uniform" / "time";
  if (fs::exists(file)) return;
  fs::create_directories(file.parent_path());
  runs::write_atomically(
      file, fmt::format("FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       "
                        "dictionary;\n    location    \"{0}/uniform\";\n    object      time;\n}}\n\n"
                        "value           {1};\n\nname            \"{0}\";\n\nindex           {2};\n\n"
                        "deltaT          {3};\n\ndeltaT0         {4};\n",
                        name, last.time, steps, last.time_step, time_step_before));
}

}  // namespace flowrest::foam
