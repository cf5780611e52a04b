#include "runs/run_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "laws/law.h"
#include "runs/command.h"
#include "runs/gauges.h"
#include "runs/material_state.h"
#include "runs/run_directory.h"
#include "scenes/pieces.h"
#include "scenes/plausibility.h"

namespace flowrest::runs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

/// The settings that a run of this solver hangs on: not what only another law reads, either.
Json bearing_on(const std::string& solver, Json settings) {
  if (!settings.is_object()) return settings;
  for (const char* name : {"title", "runs"}) settings.erase(name);
  for (const char* table : {"mpm", "foam"})
    if (solver != table) settings.erase(table);
  if (settings.contains("mpm")) settings["mpm"].erase("threads");
  // Only the steps of what spreads from a middle may grow.
  const scenes::Apparatus* apparatus = scenes::apparatus_named(settings.value("kind", ""));
  if (settings.contains("foam") &&
      (!apparatus || scenes::main_gauge_of(*apparatus) != scenes::MainGauge::spread))
    settings["foam"].erase("step_growth");
  if (settings.contains("material")) {
    Json& material = settings["material"];
    const std::string model = material.value("model", "");
    if (const auto law = laws::law_named(model))
      for (const laws::Parameter parameter : laws::every_parameter)
        if (!laws::needs(*law, parameter)) material.erase(laws::key_of(parameter));
  }
  return settings;
}

/// Both, less what makes no difference.
std::pair<Json, Json> to_compare(const std::string& solver, Json made, const Json& asked) {
  const auto foam = asked.find("foam");
  if (foam != asked.end() && made.contains("foam")) {
    if (foam->value("base_rows", 0) == 0) made["foam"]["base_rows"] = 0;
    for (const char* settled : {"air_rise_time", "base_height"})
      if (!foam->contains(settled)) made["foam"].erase(settled);
  }
  return {bearing_on(solver, std::move(made)), bearing_on(solver, asked)};
}

std::string value_in_words(const Json* value) {
  if (value == nullptr || value->is_null()) return "not given";
  constexpr std::size_t longest = 60;
  const std::string text = value->dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() <= longest ? text : text.substr(0, longest - 3) + "...";
}

void add_differences(const std::string& key, const Json* made, const Json* asked,
                     std::vector<std::string>& words) {
  const auto within = [](const Json* table, const std::string& name) {
    return table != nullptr && table->is_object() && table->contains(name) ? &table->at(name) : nullptr;
  };
  const auto below = [&](const std::string& name) { return key.empty() ? name : key + "." + name; };
  const bool tables = (asked != nullptr && asked->is_object()) || (made != nullptr && made->is_object());
  if (!tables) {
    if (value_in_words(made) != value_in_words(asked) || (made && asked && *made != *asked))
      words.push_back(
          fmt::format("{} is {} there and {} here", key, value_in_words(made), value_in_words(asked)));
    return;
  }
  if (asked != nullptr && asked->is_object())
    for (const auto& [name, value] : asked->items())
      add_differences(below(name), within(made, name), &value, words);
  if (made != nullptr && made->is_object())
    for (const auto& [name, value] : made->items())
      if (within(asked, name) == nullptr) add_differences(below(name), &value, nullptr, words);
}

/// run.json as a run begins.
Json first_info(const scenes::Scene& scene, const std::string& solver, const Json& beside) {
  Json info = {{"format", run_format},
               {"format_version", run_format_version},
               {"title", scene.title},
               {"scene_name", scene.name},
               {"kind", scenes::name_of(scene.geometry.apparatus)},
               {"solver", solver},
               {"model", scenes::to_string(scene.material.model)},
               {"status", to_string(Status::running)},
               {"reason", ""},
               {"verdict", ""},
               {"provenance", provenance()},
               {"request", request_json(scene.request)},
               {"notes", scenes::plausibility_notes(scene)},
               {"scene", scene.source},
               {"settings", Json::parse(scenes::resolved_json(scene))},
               {"resolved_toml", scenes::resolved_toml(scene)},
               {"gauges", gauge_definitions(scene)}};
  info.update(beside);
  return info;
}

/// What stands in a folder, and why it is what it is.
struct Found {
  Standing standing = Standing::vacant;
  Json info;
  std::string words;
};

bool holds_nothing(const fs::path& directory) {
  if (!fs::exists(directory)) return true;
  return std::all_of(fs::directory_iterator(directory), fs::directory_iterator(),
                     [](const auto& entry) { return entry.path().filename() == FolderLock::file_name; });
}

std::string start_in_words(const std::string& from) { return from.empty() ? "its scene's body" : from; }

/// In which way another run differs from the one that is asked for; empty where it does not.
std::string differences(const Json& made, const Json& asked, const Json& beside) {
  const std::string solver = asked.at("solver");
  if (made.value("solver", "") != solver)
    return fmt::format("solver is {} there and {} here", made.value("solver", "not given"), solver);
  std::string words = settings_differ(solver, made.value("settings", Json()), asked.at("settings"));
  const auto add = [&words](const std::string& more) { words += (words.empty() ? "" : ", ") + more; };
  if (const std::string there = started_from(made), here = started_from(asked); there != here)
    add(fmt::format("it starts from {} there and {} here", start_in_words(there), start_in_words(here)));
  for (const auto& [key, value] : beside.items())
    if (const Json there = made.value(key, Json()); key != started_from_key && there != value)
      add(fmt::format("{} is {} there and {} here", key, value_in_words(&there), value_in_words(&value)));
  return words;
}

Found find_in(const fs::path& directory, const Json& asked, const Json& beside) {
  Found found;
  if (holds_nothing(directory)) return found;
  std::string problem = "it has no run.json";
  auto info = read_info(directory / "run.json", problem);
  if (!info) return {Standing::foreign, Json(), problem};
  found.info = std::move(*info);
  const auto status = status_from(found.info.value("status", ""));
  const bool failed =
      status == Status::failed && found.info.value("failure", "") != to_string(Fault::machine);
  if (failed) {
    found.standing = Standing::failed;
    return found;
  }
  const bool finished = status == Status::at_rest || status == Status::end_time;
  found.standing = Standing::another;
  if (const std::string differ = differences(found.info, asked, beside); !differ.empty()) {
    found.words = fmt::format("of other settings: {}", differ);
  } else if (!finished) {
    found.standing = Standing::unfinished;
  } else if (const std::string there = version_in(found.info.value("provenance", Json::object())),
             here = version_in(asked.at("provenance"));
             there != here) {
    found.words =
        fmt::format("of the same settings by another version, flowrest {}; this is {}", there, here);
  } else {
    found.standing = Standing::finished;
  }
  found.words = fmt::format("{} run {}", finished ? "a finished" : "an unfinished", found.words);
  return found;
}

}  // namespace

bool same_settings(const std::string& solver, const Json& made, const Json& asked) {
  const auto [one, other] = to_compare(solver, made, asked);
  return one == other;
}

std::string settings_differ(const std::string& solver, const Json& made, const Json& asked) {
  const auto [one, other] = to_compare(solver, made, asked);
  if (one == other) return "";
  std::vector<std::string> words;
  add_differences("", &one, &other, words);
  if (words.empty()) return "settings are not the same";
  constexpr std::size_t most = 6;
  const std::size_t more = words.size() - std::min(words.size(), most);
  words.resize(words.size() - more);
  return fmt::format("{}{}", fmt::join(words, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

Standing standing_in(const fs::path& directory, const scenes::Scene& scene, const std::string& solver,
                     const std::string& from) {
  Json beside = Json::object();
  if (!from.empty()) beside[started_from_key] = {{"from", settled_name(from)}};
  return find_in(directory, first_info(scene, solver, beside), beside).standing;
}

RunFolder::RunFolder(const fs::path& directory, const scenes::Scene& scene, const std::string& solver,
                     Replace replace, Json beside)
    : RunFolder(FolderLock(directory), scene, solver, replace, std::move(beside)) {}

RunFolder::RunFolder(FolderLock lock, const scenes::Scene& scene, const std::string& solver, Replace replace,
                     Json beside)
    : lock_(std::move(lock)),
      profile_header_(scenes::pieces_of(scene).profile.header()),
      info_(first_info(scene, solver, beside)) {
  const std::string folder = lock_.folder().string();
  Found found = find_in(lock_.folder(), info_, beside);
  if (found.standing == Standing::foreign)
    throw RunError(fmt::format("{}: not empty and not a run of flowrest ({}); name a new or an empty folder",
                               folder, found.words));
  if (replace == Replace::anything) return;
  if (found.standing == Standing::another)
    throw RunError(fmt::format("{}: holds {}; name another folder with -o, or --force to replace that run",
                               folder, found.words));
  if (found.standing == Standing::unfinished && replace != Replace::unfinished)
    throw RunError(fmt::format(
        "{}: this run has begun here and not come to its end; --force makes it anew, or go on with it: {}",
        folder, command_to_resume(solver, lock_.folder())));
  finished_ = found.standing == Standing::finished;
  earlier_ = std::move(found.info);
}

std::string RunFolder::finished_words() const {
  return fmt::format("{}: this run is there already ({}); it is taken as it is, --force makes it anew",
                     lock_.folder().string(), earlier_.value("status", ""));
}

}  // namespace flowrest::runs
