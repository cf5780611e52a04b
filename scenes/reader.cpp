#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "scenes/check.h"
#include "scenes/document.h"
#include "scenes/installation.h"
#include "scenes/names.h"
#include "scenes/resolve.h"
#include "scenes/schema.h"
#include "scenes/text.h"

namespace flowrest::scenes {

namespace {

namespace fs = std::filesystem;

/// @throws SceneError where there is no such file or it is no scene.
std::string read_text(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw SceneError(escaped(path.string()) + ": no such file");
  if (!fs::is_regular_file(path, error))
    throw SceneError(escaped(path.string()) + ": not a file; allowed: a TOML file");
  if (fs::file_size(path, error) > largest_text) {
    throw SceneError(fmt::format("{}: larger than a scene can be; allowed: {} bytes", escaped(path.string()),
                                 largest_text));
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw SceneError(escaped(path.string()) + ": cannot be read");
  return text.str();
}

std::vector<std::string> scene_names(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// The file that a path or a bare name stands for; names are looked up in `folder` and then in the scenes
/// folder.
/// @throws SceneError naming the scenes there are.
fs::path find_scene(const std::string& scene, const fs::path& folder) {
  std::error_code error;
  if (is_path(scene)) return fs::path(scene).is_absolute() ? fs::path(scene) : folder / scene;
  for (const fs::path& place : {folder, scenes_folder()}) {
    if (fs::exists(place / (scene + ".toml"), error)) return place / (scene + ".toml");
  }
  const std::vector<std::string> names = scene_names(scenes_folder());
  if (names.empty())
    throw SceneError(
        fmt::format("unknown scene {}: no scenes are in {}; allowed: a path to a .toml file, or "
                    "FLOWREST_SCENES naming the folder "
                    "of the scenes",
                    quoted(scene), scenes_folder().string()));
  const std::string near = nearest(scene, names);
  throw SceneError(fmt::format("unknown scene {}{}; allowed: a path to a .toml file, or {}", quoted(scene),
                               near.empty() ? "" : ", nearest is " + near, joined(names)));
}

/// The chain of scenes being read, for finding cycles.
using Chain = std::vector<fs::path>;

std::string chain_text(const Chain& chain) {
  std::string text;
  for (const fs::path& path : chain) text += (text.empty() ? "" : " extends ") + path.string();
  return text;
}

Given read_layers(const std::string& text, const fs::path& path, Chain chain, Faults& faults);

/// Everything given by the scene that the last scene of the chain extends.
/// @throws SceneError where there is none or it closes a cycle.
Given read_extended(const std::string& name, Chain chain, Faults& faults) {
  const fs::path folder = chain.back().parent_path().empty() ? fs::path(".") : chain.back().parent_path();
  const fs::path extended = find_scene(name, folder);
  const std::string text = read_text(extended);
  for (const fs::path& earlier : chain) {
    if (fs::weakly_canonical(earlier) != fs::weakly_canonical(extended)) continue;
    chain.push_back(extended);
    throw SceneError("extends itself: " + chain_text(chain));
  }
  return read_layers(text, extended, std::move(chain), faults);
}

/// Everything a scene gives, laid over what it extends.
Given read_layers(const std::string& text, const fs::path& path, Chain chain, Faults& faults) {
  chain.push_back(path);
  Given given = read_document(text, path.string(), faults);
  const auto extends = given.values.find("extends");
  if (extends == given.values.end()) return given;
  const auto* name = std::get_if<std::string>(&extends->second.content);
  if (!name) return given;  // its type is refused when the keys are read
  try {
    Given base = read_extended(*name, chain, faults);
    base.start = given.start;
    overlay(base, given);
    return base;
  } catch (const SceneError& error) {
    faults.add(extends->second.where, error.what());
  } catch (const fs::filesystem_error& error) {
    faults.add(extends->second.where, escaped(error.what()));
  }
  given.unreadable = true;
  return given;
}

/// What --model gives.
Given model_option(Model model) {
  Value value;
  value.where.source = "--model";
  value.content = to_string(model);
  Given given;
  given.values["material.model"] = std::move(value);
  return given;
}

/// Settings of the command line by their keys, in their order; what cannot be read is said when the scene is.
std::vector<std::pair<std::string, Value>> readable_settings(const std::vector<std::string>& set) {
  std::vector<std::pair<std::string, Value>> settings;
  for (const std::string& setting : set) {
    Faults later;
    for (auto& [path, value] : read_setting(setting, later).values)
      settings.emplace_back(path, std::move(value));
  }
  return settings;
}

/// What stands behind the equals sign of the setting that gave a value.
std::string text_of_setting(const Value& value) {
  const std::string text = value.where.text();
  const std::string given = text.substr(text.find('=') + 1);
  const auto first = given.find_first_not_of(" \t\"'"), last = given.find_last_not_of(" \t\"'");
  return first == std::string::npos ? "" : given.substr(first, last - first + 1);
}

/// Faults of a setting beside those before it: the same key with another value, or its rival.
void check_against(const std::vector<std::pair<std::string, Value>>& before, const std::string& path,
                   const Value& value, Faults& faults) {
  const Key* key = find_key(path);
  for (const auto& [earlier, other] : before) {
    if (earlier == path && text_of_setting(other) != text_of_setting(value))
      faults.add(value.where, fmt::format("{} is given twice, before as {}; allowed: one value", path,
                                          text_of_setting(other)));
    if (key && key->rival == earlier)
      faults.add(value.where, fmt::format("{} and {} are both given; allowed: one of them", path, earlier));
  }
}

bool is_expected(const Key& key, const Given& given) {
  return key.required && (key.section != "thixotropy" || given.sections.contains("thixotropy"));
}

std::string missing(const Key& key) {
  const std::string unit = key.unit.empty() ? "" : ", in " + key.unit;
  return fmt::format("{} is missing; needed: {} ({}{})", key.path(), key.meaning, key.takes, unit);
}

std::string misplaced(const Key& key, const Apparatus& apparatus) {
  return fmt::format("{} does not belong to a {}; allowed in [{}]: {}", key.path(), name_of(apparatus),
                     key.section, joined(key_names(key.section, &apparatus)));
}

/// Stores what is given for a key, or says what is wrong with it.
void read_key(const Key& key, const Given& given, Draft& draft, Faults& faults) {
  const auto value = given.values.find(key.path());
  const bool is_given = value != given.values.end();
  const bool suits = key.suits(draft.scene.geometry.apparatus);
  Complaint wrong{"", given.place_of(key.path())};
  if (is_given && !suits) {
    wrong.what = misplaced(key, draft.scene.geometry.apparatus);
  } else if (is_given) {
    wrong = key.read(value->second, draft);
    if (!wrong.what.empty()) wrong.what = fmt::format("{} {}", key.path(), wrong.what);
  } else if (suits && is_expected(key, given)) {
    wrong.what = missing(key);
  }
  if (wrong.what.empty()) return;
  faults.add(wrong.where, wrong.what);
  draft.unusable.insert(key.path());
}

/// @throws SceneError
Scene build(const Given& given, Faults& faults) {
  Draft draft;
  if (given.sections.contains("thixotropy")) draft.scene.thixotropy.emplace();
  read_key(*find_key("kind"), given, draft, faults);
  const bool apparatus_is_known = draft.unusable.empty();
  for (const Key& key : keys()) {
    // Without an apparatus, what depends on it can be neither expected nor refused.
    if (key.path() != "kind" && (apparatus_is_known || key.only.empty())) read_key(key, given, draft, faults);
  }
  if (apparatus_is_known) {
    resolve(given, draft, faults);
    check(given, draft, faults);
  }
  faults.raise();
  return draft.scene;
}

}  // namespace

bool is_path(const std::string& named) {
  return named.ends_with(".toml") || named.find('/') != std::string::npos;
}

Scene parse_scene(const std::string& text, const std::filesystem::path& path, const Overrides& overrides) {
  Faults faults;
  Given given = read_layers(text, path, {}, faults);
  for (const std::string& setting : overrides.set) overlay(given, read_setting(setting, faults));
  if (overrides.model) overlay(given, model_option(*overrides.model));
  if (given.unreadable) faults.raise();  // nothing can be said about what is missing
  Scene scene = build(given, faults);
  scene.name = path.stem().string();
  scene.path = path;
  scene.source = text;
  std::error_code error;
  scene.request = {path.string(), fs::absolute(path, error).lexically_normal(), overrides};
  return scene;
}

Scene load_scene(const std::string& named, const Overrides& overrides) {
  const fs::path path = is_path(named) ? fs::path(named) : find_scene(named, scenes_folder());
  Scene scene = parse_scene(read_text(path), path, overrides);
  scene.request.scene = named;
  return scene;
}

Overrides overrides_of_command_line(const std::vector<std::string>& set, const std::string& model) {
  Overrides overrides{set, std::nullopt};
  if (!model.empty()) overrides.model = model_from_name(model);
  Faults faults;
  std::vector<std::pair<std::string, Value>> before;
  for (const auto& [path, value] : readable_settings(set)) {
    check_against(before, path, value, faults);
    if (overrides.model && path == "material.model" && text_of_setting(value) != model)
      faults.add(value.where,
                 fmt::format("material.model is given beside --model {}; allowed: one of them", model));
    before.emplace_back(path, value);
  }
  faults.raise();
  return overrides;
}

bool gives_key(const std::vector<std::string>& set, const std::string& path) {
  const auto settings = readable_settings(set);
  return std::any_of(settings.begin(), settings.end(),
                     [&](const auto& setting) { return setting.first == path; });
}

void check_model_has_effect(const Scene& scene, const std::vector<std::string>& set) {
  const auto differs = [&](Model model) { return model != scene.material.model; };
  if (!gives_key(set, "material.model")) return;
  if (std::none_of(scene.runs.mpm.begin(), scene.runs.mpm.end(), differs) &&
      std::none_of(scene.runs.foam.begin(), scene.runs.foam.end(), differs))
    return;
  throw SceneError(fmt::format(
      "--set material.model={}: the runs of {} have the laws that its `runs` name; allowed: runs.mpm and "
      "runs.foam, for example --set runs.mpm={}",
      to_string(scene.material.model), scene.path.string(), to_string(scene.material.model)));
}

std::filesystem::path scenes_folder() {
  const char* folder = std::getenv("FLOWREST_SCENES");
  return folder && *folder ? fs::path(folder) : shared_folder("scenes");
}

std::vector<SceneSummary> list_scenes() {
  std::vector<SceneSummary> summaries;
  for (const std::string& name : scene_names(scenes_folder())) {
    SceneSummary summary{name, "", ""};
    try {
      summary.title = load_scene(name).title;
    } catch (const SceneError& error) {
      const std::string faults = error.what();
      summary.error = faults.substr(0, faults.find('\n'));
    }
    summaries.push_back(summary);
  }
  return summaries;
}

}  // namespace flowrest::scenes
