#pragma once

#include <nlohmann/json.hpp>

#include "scenes/schema.h"

namespace flowrest::scenes {

/// A resolved setting and its key.
struct Setting {
  const Key* key;
  nlohmann::ordered_json value;
};

/// Every resolved setting of a scene, in the order of the schema.
std::vector<Setting> settings_of(const Scene&);

/// The resolved settings by section, as resolved_json has them.
nlohmann::ordered_json settings_json(const Scene&);

/// A setting as TOML.
std::string toml_value(const nlohmann::ordered_json&);

}  // namespace flowrest::scenes
