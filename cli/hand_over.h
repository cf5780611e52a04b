#pragma once

#include "runs/material_state.h"
#include "scenes/scene.h"

namespace flowrest::cli {

/// The state that --from names, read by the room of the solver that left it.
/// @throws runs::RunError where there is none, saying why.
runs::MaterialState read_state(const std::string& from, const scenes::Scene&);

}  // namespace flowrest::cli
