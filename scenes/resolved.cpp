#include <fmt/format.h>

#include "scenes/settings.h"
#include "scenes/text.h"

namespace flowrest::scenes {

using Json = nlohmann::ordered_json;

std::string toml_value(const Json& value) {
  if (value.is_string()) return toml_string(value.get<std::string>());
  if (value.is_number_float()) return exact_text(value.get<double>());
  if (value.is_object()) {
    std::vector<std::string> entries;
    for (const auto& [name, item] : value.items()) entries.push_back(name + " = " + toml_value(item));
    return fmt::format("{{ {} }}", joined(entries));
  }
  if (!value.is_array()) return value.dump();
  std::vector<std::string> items;
  for (const Json& item : value) items.push_back(toml_value(item));
  return fmt::format("[{}]", joined(items));
}

std::vector<Setting> settings_of(const Scene& scene) {
  Draft draft;
  draft.scene = scene;
  std::vector<Setting> settings;
  for (const Key& key : keys()) {
    if (!key.suits(scene.geometry.apparatus)) continue;
    if (key.section == "thixotropy" && !scene.thixotropy) continue;
    Json value = key.write(draft);
    if (!value.is_null()) settings.push_back({&key, std::move(value)});
  }
  return settings;
}

nlohmann::ordered_json settings_json(const Scene& scene) {
  Json json;
  for (const Setting& setting : settings_of(scene)) {
    const Key& key = *setting.key;
    (key.section.empty() ? json : json[key.section])[key.name] = setting.value;
  }
  return json;
}

std::string resolved_toml(const Scene& scene) {
  std::string text;
  std::string section;
  for (const auto& [key, value] : settings_of(scene)) {
    if (key->section != section) {
      section = key->section;
      text += fmt::format("\n[{}]\n", section);
    }
    text += fmt::format("{} = {}{}{}\n", key->name, toml_value(value), key->unit.empty() ? "" : "  # ",
                        key->unit);
  }
  return text;
}

std::string resolved_json(const Scene& scene) { return settings_json(scene).dump(2); }

}  // namespace flowrest::scenes
