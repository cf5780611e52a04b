#pragma once

#include <vector>

#include "mpm/solver/solver.h"
#include "scenes/scene.h"

namespace flowrest::mpm {

/// The particles a scene begins with: a lattice over the cells, or one random place in each lattice site
/// (jittered). A site partly inside the body counts for the part inside, with its particle at that part's
/// centroid; the volumes are then scaled, all alike, so that they sum to the body's exact volume.
std::vector<Seed> seed_particles(const scenes::Scene&);

}  // namespace flowrest::mpm
