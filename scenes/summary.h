#pragma once

#include <string>

#include "scenes/cost.h"
#include "scenes/scene.h"

/// A scene in words: for people, and as one line for programs.
namespace flowrest::scenes {

/// Every key a scene can have, as Markdown tables.
std::string key_reference();

/// Resolved settings with their units, step limits, sizes and what the solvers that are there tell of them.
std::string check_text(const Scene&, const Estimates&);

/// The same as one line of JSON.
std::string check_json(const Scene&, const Estimates&);

}  // namespace flowrest::scenes
