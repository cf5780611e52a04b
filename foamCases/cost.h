#pragma once

#include "scenes/cost.h"
#include "scenes/scene.h"

namespace flowrest::foam {

/// Mesh and steps of a run, and what it is expected to cost: at least these steps, as the Courant number may
/// ask for smaller ones.
scenes::FoamEstimate estimate(const scenes::Scene&);

}  // namespace flowrest::foam
