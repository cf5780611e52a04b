#pragma once

#include <cstdint>
#include <vector>

#include "mpm/boundary/walls.h"
#include "mpm/solver/layout.h"

namespace flowrest::mpm {

/// Which walls the particles of each cell can get into within a step: most cells' none, and those at a wall
/// only that one, so that few distances are asked for. A distance changes by no more than one goes, so a cell
/// is safe from a wall that is farther from its centre than its particles can be, however the wall is shaped.
/// Cells are looked at once, and again when a wall has moved.
class NearbyWalls {
 public:
  NearbyWalls(const std::vector<Wall>& walls, int dimension, double cell)
      : walls_(walls), dimension_(dimension), cell_(cell), marked_at_(walls.size()) {}

  /// Takes note of where the walls are; what was said of blocks before may no longer hold where this returns
  /// true.
  bool follow(double time);

  /// A set of walls for every cell of a block, null where no wall can be reached from anywhere in it. It
  /// holds as long as no particle goes further than wall_reach.
  const WallSet* of_block(std::uint32_t slot, const int (&origin)[3]);

  /// Whether a place lies in one of the walls.
  bool hold(WallSet, const Vector& place, double time) const;

 private:
  struct Block {
    bool known = false;
    std::vector<WallSet> cells;
  };
  /// Those that come closer than `reach` to a place, of those in `among`.
  WallSet closer_than(double reach, const Vector& place, WallSet among) const;

  const std::vector<Wall>& walls_;
  int dimension_;
  double cell_;                    ///< m
  double time_ = 0.0;              ///< s, at which blocks are marked
  std::vector<Vector> marked_at_;  ///< displacement of each wall then, m
  std::vector<Block> blocks_;      ///< by slot
};

}  // namespace flowrest::mpm
