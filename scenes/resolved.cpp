#include <fmt/format.h>

#include "scenes/schema.h"
#include "scenes/text.h"

namespace flowrest::scenes {

namespace {

using Json = nlohmann::ordered_json;

/// Calls `use(key, setting)` for every resolved setting of a scene, in the order of the schema.
template <class Use>
void for_each_setting(const Scene& scene, Use use) {
  Draft draft;
  draft.scene = scene;
  for (const Key& key : keys()) {
    if (key.only_kind && *key.only_kind != scene.kind) continue;
    if (key.section == "thixotropy" && !scene.thixotropy) continue;
    const Json setting = key.write(draft);
    if (!setting.is_null()) use(key, setting);
  }
}

/// A TOML basic string.
std::string toml_string(const std::string& text) {
  std::string string = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      string += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      string += fmt::format("\\u{:04X}", static_cast<unsigned char>(c));
    } else {
      string += c;
    }
  }
  string += '"';
  return string;
}

std::string toml_value(const Json& value) {
  if (value.is_string()) return toml_string(value.get<std::string>());
  if (value.is_number_float()) return exact_text(value.get<double>());
  if (!value.is_array()) return value.dump();
  std::vector<std::string> items;
  for (const Json& item : value) items.push_back(toml_value(item));
  return fmt::format("[{}]", joined(items));
}

}  // namespace

std::string resolved_toml(const Scene& scene) {
  std::string text;
  std::string section;
  for_each_setting(scene, [&](const Key& key, const Json& setting) {
    if (key.section != section) {
      section = key.section;
      text += fmt::format("\n[{}]\n", section);
    }
    text +=
        fmt::format("{} = {}{}{}\n", key.name, toml_value(setting), key.unit.empty() ? "" : "  # ", key.unit);
  });
  return text;
}

std::string resolved_json(const Scene& scene) {
  Json json;
  for_each_setting(scene, [&](const Key& key, const Json& setting) {
    (key.section.empty() ? json : json[key.section])[key.name] = setting;
  });
  return json.dump(2);
}

}  // namespace flowrest::scenes
