#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mpm/solver/solver.h"
#include "runs/material_state.h"
#include "scenes/scene.h"

/// States that runs of this solver leave, and that they start from.
namespace flowrest::mpm {

/// The state that a run of this solver recorded in its particles/.
/// @throws runs::RunError where it recorded none then, saying when it did, or what it recorded lacks stresses.
runs::MaterialState read_state(const std::string& from);

/// The particles with which a run of a scene starts from a state. Where the state's own particles have the
/// same cells, as they are; else anew, on the lattice that the scene's particles have: each column of its sites
/// is filled from below with what the state holds over it, compressed as the state is or, where that knows no
/// pressure, as the material over it would. Volume at rest, momentum and flocculation are the state's.
std::vector<Seed> seeds_of_state(const scenes::Scene&, const runs::MaterialState&);

}  // namespace flowrest::mpm
