#pragma once

#include "scenes/cost.h"

namespace flowrest::mpm {

/// What a run of the scene is expected to cost.
scenes::Cost cost(const scenes::Scene&);

}  // namespace flowrest::mpm
