#include "scenes/number_at.h"

#include <fmt/format.h>

#include <map>
#include <optional>

#include "scenes/settings.h"

namespace flowrest::scenes {

namespace {

using Json = nlohmann::ordered_json;

/// A path taken apart: the key, what follows it within its value, and the pair.
struct Place {
  const Setting* setting = nullptr;
  std::vector<std::string> names;
  std::optional<std::size_t> pair;
};

[[noreturn]] void refuse(const Scene& scene, const std::string& path, const std::string& why) {
  throw SceneError(fmt::format("{}: {}: {}", scene.path.string(), path, why));
}

Place place_of(const Scene& scene, const std::vector<Setting>& settings, const std::string& path) {
  Place place;
  std::string bare = path;
  if (const auto bracket = path.find('['); bracket != std::string::npos) {
    std::size_t end = 0;
    try {
      place.pair = std::stoul(path.substr(bracket + 1), &end);
    } catch (const std::exception&) {
      end = std::string::npos;
    }
    if (end == std::string::npos || bracket + 1 + end + 1 != path.size() || path.back() != ']')
      refuse(scene, path, "what follows the key is no number of a pair; allowed: KEY[0], KEY[1], ...");
    bare = path.substr(0, bracket);
  }
  for (const Setting& setting : settings) {
    const std::string name = setting.key->path();
    if (bare != name && bare.rfind(name + ".", 0) != 0) continue;
    place.setting = &setting;
    for (std::size_t at = name.size(); at < bare.size();) {
      const std::size_t next = bare.find('.', at + 1);
      place.names.push_back(bare.substr(at + 1, next == std::string::npos ? next : next - at - 1));
      at = next == std::string::npos ? bare.size() : next;
    }
    return place;
  }
  refuse(scene, path, "this scene has no such key; allowed: the keys that `flowrest check --json` shows");
}

/// The number of a place within its key's value.
template <class J>
J& number_in(const Scene& scene, const Place& place, const std::string& path, J& value) {
  J* at = &value;
  for (const std::string& name : place.names) {
    if (!at->is_object() || !at->contains(name))
      refuse(scene, path, fmt::format("there is no {} in it, which is {}", name, toml_value(value)));
    at = &(*at)[name];
  }
  if (place.pair) {
    if (!at->is_array() || *place.pair >= at->size())
      refuse(scene, path, fmt::format("there is no such pair in {}", toml_value(value)));
    at = &(*at)[*place.pair];
    if (at->is_array() && at->size() == 2) at = &(*at)[1];
  }
  // One pair holds all the time.
  if (!place.pair && at->is_array() && at->size() == 1 && at->front().is_array() && at->front().size() == 2)
    at = &at->front()[1];
  if (at->is_number()) return *at;
  if (at->is_array())
    refuse(scene, path,
           fmt::format("it is {}; allowed: one of its pairs, as {}[0]", toml_value(value), path));
  refuse(scene, path, fmt::format("it is {}, not a number", toml_value(value)));
}

}  // namespace

NumberAt number_at(const Scene& scene, const std::string& path) {
  const std::vector<Setting> settings = settings_of(scene);
  const Place place = place_of(scene, settings, path);
  const double value = number_in(scene, place, path, place.setting->value).template get<double>();
  return {path, value, place.names.empty() ? place.setting->key->unit : ""};
}

Scene with_numbers(const Scene& scene, const std::vector<NumberAt>& numbers) {
  const std::vector<Setting> settings = settings_of(scene);
  std::map<std::string, Json> changed;
  for (const NumberAt& number : numbers) {
    const Place place = place_of(scene, settings, number.path);
    Json& value = changed.try_emplace(place.setting->key->path(), place.setting->value).first->second;
    number_in(scene, place, number.path, value) = number.value;
  }
  Overrides overrides;
  for (const auto& [name, value] : changed) overrides.set.push_back(name + "=" + toml_value(value));
  Scene other = parse_scene(resolved_toml(scene), scene.path, overrides);
  other.name = scene.name;
  return other;
}

}  // namespace flowrest::scenes
