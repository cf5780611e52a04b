#pragma once

#include "mpm/transfer/tile.h"

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Puts a tile's particles that moved into a wall back on its surface, and counts anew the axes along which
/// they left their cell. Only cells that a wall can be reached from are asked, unless a particle went further
/// than was reckoned with: `farthest_square` is how far the fastest went, in cells, squared.
template <class T, int Dim>
void keep_out_of_walls(const StepParameters<T>& step, const Tile<T, Dim>& tile, T farthest_square,
                       T* const* x, T* left) {
  const double size = static_cast<double>(step.cell);
  const bool reckoned = farthest_square <= T(wall_reach * wall_reach);
  for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
    const WallSet near = reckoned ? tile.block.walls[cell] : ~WallSet{0};
    if (near == 0) continue;
    int c[3];
    cell_coordinates<T, Dim>(cell, c);
    const int inside[3] = {c[0], Dim == 3 ? c[1] : c[2], c[2]};
    for (int q = tile.cell_first(cell); q < tile.cell_first(cell) + tile.cell_count(cell); ++q) {
      double place[3] = {};
      for (int a = 0; a < Dim; ++a)
        place[a] = (tile.block.origin[a] + inside[a] + static_cast<double>(x[a][q])) * size;
      if (!step.keep_out(step.walls, near, place)) continue;
      left[q] = T(0);
      for (int a = 0; a < Dim; ++a) {
        const T to = static_cast<T>(place[a] / size - tile.block.origin[a] - inside[a]);
        left[q] += (to >= T(0) && to < T(1)) ? T(0) : T(1);
        x[a][q] = to;
      }
    }
  }
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
