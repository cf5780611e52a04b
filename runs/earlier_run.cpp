#include "runs/earlier_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>

#include "runs/command.h"

namespace flowrest::runs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

/// Settings by their dotted names.
std::vector<std::pair<std::string, Json>> flat_settings(const scenes::Scene& scene) {
  std::vector<std::pair<std::string, Json>> flat;
  const Json settings = Json::parse(scenes::resolved_json(scene));
  for (const auto& [section, value] : settings.items()) {
    // Only sections are tables of keys; a wall's law is a table that is a value.
    if (!value.is_object()) {
      flat.emplace_back(section, value);
      continue;
    }
    for (const auto& [name, setting] : value.items()) flat.emplace_back(section + "." + name, setting);
  }
  return flat;
}

std::string value_of(const scenes::Scene& scene, const std::string& key) {
  for (const auto& [name, value] : flat_settings(scene))
    if (name == key) return value.dump();
  return "not given";
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void check_changes(const EarlierRun& run, const scenes::Scene& scene, const std::vector<std::string>& free) {
  std::vector<std::string> allowed = {"time.end", "time.stop_at_rest=false"};
  allowed.insert(allowed.end(), free.begin(), free.end());
  for (const std::string& key : differing_settings(run.scene, scene)) {
    if (key == "time.end" || contains(free, key)) continue;
    if (key == "time.stop_at_rest" && !scene.time.stop_at_rest) continue;
    const bool rest = key == "time.stop_at_rest";
    throw RunError(fmt::format(
        "{}: a run goes on with the settings it began with, and {} = {} is one of them{}; allowed with "
        "--resume: --set of {}",
        run.directory.string(), key, value_of(run.scene, key),
        rest ? ": it may have been at rest before" : "", fmt::join(allowed, ", ")));
  }
}

}  // namespace

EarlierRun read_earlier_run(const fs::path& directory, const std::string& solver) {
  std::ifstream file(directory / "run.json", std::ios::binary);
  EarlierRun run;
  run.directory = directory;
  run.info = file ? Json::parse(file, nullptr, false) : Json();
  const auto text = [&](const char* key) -> std::string {
    const auto found = run.info.find(key);
    return found != run.info.end() && found->is_string() ? found->get<std::string>() : "";
  };
  if (!run.info.is_object() || text("solver") != solver || text("resolved_toml").empty())
    throw RunError(
        fmt::format("{}: is not a run of `flowrest {}` that can be gone on with: it has no run.json of one",
                    directory.string(), solver));
  run.scene = scenes::parse_scene(text("resolved_toml"), directory / "run.json");
  if (!text("scene_name").empty()) run.scene.name = text("scene_name");
  run.scene.source = text("scene");
  if (const auto request = request_of(run.info)) run.scene.request = *request;
  for (const Status status : {Status::at_rest, Status::end_time, Status::interrupted, Status::failed})
    if (text("status") == to_string(status)) run.status = status;
  return run;
}

std::vector<std::string> differing_settings(const scenes::Scene& one, const scenes::Scene& other) {
  const auto ours = flat_settings(one), theirs = flat_settings(other);
  std::vector<std::string> names;
  for (const auto& [from, to] : {std::pair{&ours, &theirs}, std::pair{&theirs, &ours}})
    for (const auto& setting : *from)
      if (std::find(to->begin(), to->end(), setting) == to->end() && !contains(names, setting.first))
        names.push_back(setting.first);
  return names;
}

scenes::Scene scene_to_go_on_with(const EarlierRun& run, const std::vector<std::string>& set,
                                  const std::vector<std::string>& free) {
  scenes::Scene scene = scenes::parse_scene(scenes::resolved_toml(run.scene), run.scene.path,
                                            scenes::overrides_of_command_line(set));
  scene.name = run.scene.name;
  scene.source = run.scene.source;
  scene.request = run.scene.request;
  // So that a command made of it asks for the run as it is now.
  for (const std::string& setting : set) {
    scene.request = without_setting(scene.request, key_set_by(setting));
    scene.request.overrides.set.push_back(setting);
  }
  check_changes(run, scene, free);
  if (!run.finished()) return scene;
  const bool goes_past_rest = run.status == Status::at_rest && !scene.time.stop_at_rest;
  if (goes_past_rest || scene.time.end > run.scene.time.end) return scene;
  throw RunError(fmt::format(
      "{}: this run has come to its end ({}) and is finished: there is nothing to go on with; --set "
      "time.end=... above {:g} s prolongs it{}",
      run.directory.string(), to_string(run.status), run.scene.time.end,
      run.status == Status::at_rest ? ", --set time.stop_at_rest=false goes on past its rest" : ""));
}

void check_end(const EarlierRun& run, const scenes::Scene& scene, double from) {
  if (scene.time.end >= from * (1.0 - 1e-12)) return;
  throw RunError(fmt::format("{}: time.end = {:g} s, and this run has come further; allowed: from {:.9g} s",
                             run.directory.string(), scene.time.end, from));
}

void refuse_beside_resume(const std::vector<std::string>& given, const std::string& allowed) {
  if (given.empty()) return;
  throw RunError(fmt::format(
      "{} given with --resume: a run goes on where it is, with the settings it began with; allowed "
      "with --resume: {}",
      fmt::join(given, " and "), allowed));
}

}  // namespace flowrest::runs
