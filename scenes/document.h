#pragma once

#include <string>

#include "scenes/value.h"

/// TOML text taken apart into the keys of the schema.
namespace flowrest::scenes {

/// Largest scene text read, in bytes.
inline constexpr std::size_t largest_text = 1 << 20;

/// Everything a TOML text gives; unknown keys, unknown sections and invalid TOML go to `faults`.
Given read_document(const std::string& text, const std::string& source, Faults& faults);

/// What one "dotted.path=value" of the command line gives.
Given read_setting(const std::string& setting, Faults& faults);

/// Lays a later layer over an earlier one, key by key; a key also takes the place of its rival.
void overlay(Given& base, Given layer);

}  // namespace flowrest::scenes
