#pragma once

#include "scenes/scene.h"
#include "scenes/value.h"

namespace flowrest::scenes {

/// The place to speak of when a key is at fault: its value, else its section, else the scene.
Location place_of(const std::string& path, const Given&);

/// Refuses what is well formed but physically impossible, unstable or larger than any machine.
void check(const Given&, const Scene&, Faults&);

}  // namespace flowrest::scenes
