#pragma once

#include "scenes/pieces.h"

/// Boxes and tanks, of which several apparatus are made. x runs along them from the back wall.
namespace flowrest::scenes {

/// A box of material from the origin, `width` of which counts in space only, m.
Body box_body(const Scene&, double length, double width, double height);

struct Tank {
  double length = 0.0, width = 0.0, height = 0.0;  ///< m
  bool halved = false;                             ///< along its middle, which lies at y = 0
};
/// Adds a tank's floor, its ends and, in space, its sides, which hold as walls.base says.
void add_tank(const Scene&, const Tank&, Pieces&);

}  // namespace flowrest::scenes
