#pragma once

#include "mpm/transfer/tile.h"

/// Plane walls along the grid, and planes of symmetry, which are slip walls.
namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Calls use(node, image) for every arena node on layer `from` of an axis and the one opposite it on layer
/// `to`.
template <int Dim, class Use>
FLOWREST_INLINE void across_layers(int a, int from, int to, Use use) {
  const int edge[3] = {arena_edge, Dim == 3 ? arena_edge : 1, arena_edge};
  const int axis = Dim == 2 && a == 1 ? 2 : a;
  int n[3];
  for (n[0] = 0; n[0] < edge[0]; ++n[0])
    for (n[1] = 0; n[1] < edge[1]; ++n[1])
      for (n[2] = 0; n[2] < edge[2]; ++n[2]) {
        if (n[axis] != from) continue;
        int m[3] = {n[0], n[1], n[2]};
        m[axis] = to;
        use(arena_index<Dim>(n[0], n[1], n[2]), arena_index<Dim>(m[0], m[1], m[2]));
      }
}

/// Whether a wall turns the sign of velocity component `c` in the mirrored body. `a` is the wall's own axis.
FLOWREST_INLINE bool odd_across(PlaneWall wall, int a, int c) { return wall == PlaneWall::no_slip || c == a; }

/// Folds what fell on the ghost nodes behind plane walls onto their mirror images: mass is added, momentum
/// with the sign of the mirrored body's. Only the quadratic functions reach behind a wall.
template <class T, int Dim>
void fold_ghosts(T* arena, int records, const BlockView& block, const AxisBounds* bounds) {
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const PlaneWall wall = side == 0 ? bounds[a].lower : bounds[a].upper;
      const int cell = (side == 0 ? bounds[a].lower_cell : bounds[a].upper_cell - 1) - block.origin[a];
      if (wall == PlaneWall::none || cell < 0 || cell >= block_edge) continue;
      across_layers<Dim>(a, side == 0 ? cell : cell + 2, cell + 1, [&](int ghost, int image) {
        T* from = arena + ghost * records * record;
        T* to = arena + image * records * record;
        for (int r = 0; r < records; ++r) {
          to[r * record] += from[r * record];
          for (int c = 0; c < Dim; ++c) {
            const T momentum = from[r * record + 1 + c];
            to[r * record + 1 + c] += odd_across(wall, a, c) ? -momentum : momentum;
          }
          for (int c = 0; c < record; ++c) from[r * record + c] = T(0);
        }
      });
    }
}

/// Sets the velocities that plane walls prescribe. Quadratic: the ghost node mirrors the first one inside.
/// Linear: the node on the wall itself is held.
template <class T, int Dim, class Shape>
void set_wall_velocities(T* arena, int records, const BlockView& block, const AxisBounds* bounds) {
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const PlaneWall wall = side == 0 ? bounds[a].lower : bounds[a].upper;
      if (wall == PlaneWall::none) continue;
      const int face = (side == 0 ? bounds[a].lower_cell : bounds[a].upper_cell) - block.origin[a];
      const int cell = side == 0 ? face : face - 1;
      const bool mirrored = Shape::nodes == 3;
      if (mirrored ? (cell < 0 || cell >= block_edge) : (face < 0 || face > block_edge)) continue;
      const int held = mirrored ? (side == 0 ? cell : cell + 2) : face;
      across_layers<Dim>(a, held, mirrored ? cell + 1 : held, [&](int node, int image) {
        for (int r = 0; r < records; ++r)
          for (int c = 0; c < Dim; ++c) {
            T& value = arena[(node * records + r) * record + 1 + c];
            const T inside = arena[(image * records + r) * record + 1 + c];
            const bool odd = odd_across(wall, a, c);
            if (mirrored) {
              value = odd ? -inside : inside;
            } else if (odd) {
              value = T(0);
            }
          }
      });
    }
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
