#pragma once

#include <vector>

#include "mpm/solver/solver.h"
#include "scenes/scene.h"

namespace flowrest::mpm {

/// The particles a scene begins with, told one by one: a lattice over the cells, or one random place in each
/// lattice site (jittered), or the centroids of an unstructured mesh of triangles or tetrahedra by the
/// program gmsh, each with its element's volume. A site partly inside the body counts for the part inside,
/// with its particle at that part's centroid; the volumes are then scaled, all alike, so that they sum to the
/// body's exact volume.
/// @throws runs::MissingProgram where the scene asks for gmsh and it is not installed.
SeedSource seeds_of(const scenes::Scene&);
/// The same in a list.
std::vector<Seed> seed_particles(const scenes::Scene&);

}  // namespace flowrest::mpm
