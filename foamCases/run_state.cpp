#include "foamCases/run_state.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <utility>

#include "foamCases/case_fields.h"
#include "foamCases/case_filler.h"
#include "foamCases/field_file.h"
#include "runs/run_directory.h"

namespace flowrest::foam {

namespace fs = std::filesystem;

namespace {

constexpr const char* ranks_key = "\nranks ";

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Ranks may differ from one leg of a run to the next; nothing else of the parameters may.
std::string without_ranks(const std::string& text) { return text.substr(0, text.find(ranks_key)); }

void check_case(const fs::path& case_directory, const EarlierRun& earlier) {
  const fs::path path = case_directory / "sceneParameters";
  if (!fs::exists(path))
    throw runs::RunError(
        fmt::format("{}: missing: this is no case that `flowrest foam` made", path.string()));
  if (without_ranks(text_of(path)) != without_ranks(scene_parameters(earlier.scene, earlier.plug_in)))
    throw runs::RunError(
        fmt::format("{}: it is not what `flowrest foam` writes for the scene in run.json; to go on, undo "
                    "what was changed in it",
                    path.string()));
}

/// Cell fields of a full state, with their components.
std::vector<std::pair<std::string, int>> state_fields(const scenes::Scene& scene, bool plug_in) {
  std::vector<std::pair<std::string, int>> fields{{"alpha.concrete", 1}, {"U", 3}, {"p_rgh", 1}};
  if (scene.material.model == scenes::Model::elasto_viscoplastic) fields.emplace_back("stress", 6);
  if (scene.thixotropy && plug_in) fields.emplace_back("flocculation", 1);
  return fields;
}

bool is_whole(const CaseFields& fields, const std::string& time, const scenes::Scene& scene, bool plug_in) {
  if (!fields.holds(time, "phi") || !fields.holds(time, "uniform/time")) return false;
  try {
    for (const auto& [name, components] : state_fields(scene, plug_in))
      fields.read(time, name, mesh_cells(scene), components);
  } catch (const FieldError&) {
    return false;
  }
  return true;
}

/// The latest whole state after the start; what is later is removed.
std::optional<std::pair<double, std::string>> keep_latest(const fs::path& case_directory,
                                                          const scenes::Scene& scene, bool plug_in) {
  const CaseFields fields(case_directory, CaseFields::ranks_in(case_directory));
  auto times = fields.times();
  for (; !times.empty() && times.back().first > 0.0; times.pop_back()) {
    if (is_whole(fields, times.back().second, scene, plug_in)) return times.back();
    fields.remove(times.back().second);
  }
  return std::nullopt;
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

}  // namespace

EarlierRun read_earlier_run(const fs::path& directory) {
  const fs::path path = directory / "run.json";
  const auto info = nlohmann::json::parse(text_of(path), nullptr, false);
  if (info.is_discarded() || !info.is_object() || info.value("solver", "") != "foam" ||
      !info.contains("resolved_toml"))
    throw runs::RunError(
        fmt::format("{}: is not a run of `flowrest foam` that can be gone on with: it has no run.json "
                    "of one",
                    directory.string()));
  const std::string status = info.value("status", "");
  if (status == "end-time" || status == "at-rest")
    throw runs::RunError(fmt::format("{}: this run has come to its end ({}); there is nothing to go on with",
                                     directory.string(), status));
  EarlierRun earlier;
  earlier.scene = scenes::parse_scene(info["resolved_toml"], path);
  earlier.scene.name = info.value("scene_name", earlier.scene.name);
  const std::string parameters = text_of(directory / "case" / "sceneParameters");
  earlier.plug_in = parameters.find("libflowrestRheology") != std::string::npos;
  if (info.contains("cpu_by_program_s"))
    earlier.cpu_by_program = info["cpu_by_program_s"].get<std::map<std::string, double>>();
  if (info.contains("wall_s")) earlier.wall = info["wall_s"];
  return earlier;
}

void remove_cut_off_times(const fs::path& case_directory, const scenes::Scene& scene) {
  const bool plug_in =
      text_of(case_directory / "sceneParameters").find("libflowrestRheology") != std::string::npos;
  keep_latest(case_directory, scene, plug_in);
}

std::optional<RunState> latest_state(const fs::path& directory, const EarlierRun& earlier) {
  const fs::path case_directory = directory / "case";
  if (!fs::is_directory(case_directory)) return std::nullopt;
  const auto latest = keep_latest(case_directory, earlier.scene, earlier.plug_in);
  if (!latest) return std::nullopt;
  check_case(case_directory, earlier);
  RunState state;
  state.time = latest->first;
  state.cpu_by_program = earlier.cpu_by_program;
  state.wall = earlier.wall;
  double solved = 0.0;
  for (const auto& path : earlier_logs(case_directory)) {
    SolverLog log;
    log.feed(text_of(path));
    for (const auto& step : log.take_steps())
      if (step.time < state.time + 0.5 * step.time_step) state.steps.push_back(step);
    solved += log.execution_time();
  }
  if (!state.cpu_by_program.contains("interFoam")) state.cpu_by_program["interFoam"] = solved;
  return state;
}

}  // namespace flowrest::foam
