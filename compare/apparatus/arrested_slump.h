#pragma once

#include <string>

#include "compare/exact/solutions.h"
#include "runs/material_state.h"
#include "scenes/scene.h"

/// The arrested shapes as states that runs start from.
namespace flowrest::compare::exact {

/// @throws runs::RunError where a slump of this material has no arrested shape, saying why.
void check_arrests(const scenes::Scene&, const Bingham&);

/// The state that "exact/second-order" or "exact/leading-order" names for a scene's body, or the folder of such
/// a run for the scene of that run: at rest at 0 s, with the stresses that hold it. The base carries the yield
/// stress, and the shear falls linearly to nothing at the surface; of second order the plug is at yield, too,
/// stretched alike in all directions.
/// @throws runs::RunError where there is no such solution.
runs::MaterialState arrested_state(const std::string& from, const scenes::Scene&);

}  // namespace flowrest::compare::exact
