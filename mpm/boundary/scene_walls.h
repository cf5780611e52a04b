#pragma once

#include "mpm/boundary/walls.h"
#include "mpm/solver/layout.h"
#include "scenes/pieces.h"

namespace flowrest::mpm {

/// What holds a scene's material: planes along the grid where they do, walls of any shape for the rest.
struct SceneWalls {
  std::array<AxisBounds, 3> bounds{};
  std::vector<Wall> walls;
};

/// The walls and planes of symmetry of an apparatus. `cell` is the cell size in use, m.
SceneWalls walls_of(const scenes::Pieces&, int dimension, double cell);

}  // namespace flowrest::mpm
