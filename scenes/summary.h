#pragma once

#include <string>

#include "scenes/scene.h"

/// A scene in words: for people, and as one line for programs.
namespace flowrest::scenes {

/// Every key a scene can have, as Markdown tables.
std::string key_reference();

/// Resolved settings with their units, step limits, sizes and expected cost.
std::string check_text(const Scene&);

/// The same as one line of JSON.
std::string check_json(const Scene&);

}  // namespace flowrest::scenes
