#pragma once

#include <string>
#include <vector>

#include "scenes/scene.h"

namespace flowrest::scenes {

/// What of a scene is implausible for concrete, mortar or cement paste, and what it means: a value out of the
/// range of such materials, with the unit in which it would lie in it, and a yield stress that lets nothing
/// flow. Notes, not faults: whoever means it may run it.
std::vector<std::string> plausibility_notes(const Scene&);

}  // namespace flowrest::scenes
