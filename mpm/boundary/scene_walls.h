#pragma once

#include "mpm/boundary/walls.h"
#include "mpm/solver/layout.h"
#include "scenes/scene.h"

namespace flowrest::mpm {

/// What holds a scene's material: planes along the grid where they do, walls of any shape for the rest.
struct SceneWalls {
  std::array<AxisBounds, 3> bounds{};
  std::vector<Wall> walls;
};

/// `cell` is the cell size in use, m.
SceneWalls walls_of(const scenes::Scene&, double cell);

}  // namespace flowrest::mpm
