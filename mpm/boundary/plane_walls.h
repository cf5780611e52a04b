#pragma once

#include "mpm/boundary/wall_transfer.h"
#include "mpm/transfer/tile.h"

/// Plane walls along the grid, and planes of symmetry, which are slip walls.
namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Calls use(node, image) for every arena node on layer `from` of an axis and the one opposite it on layer
/// `to`.
template <int Dim, class Use>
FLOWREST_INLINE void across_layers(int a, int from, int to, Use use) {
  const int strides[3] = {arena_index<Dim>(1, 0, 0), Dim == 3 ? arena_index<Dim>(0, 1, 0) : 1, 1};
  const int stride = strides[a], others[2] = {strides[a == 0 ? 1 : 0], strides[a == 2 ? 1 : Dim - 1]};
  for (int i = 0; i < (Dim == 3 ? arena_edge : 1); ++i)
    for (int j = 0; j < arena_edge; ++j) {
      const int place = i * others[0] + j * (Dim == 3 ? others[1] : others[0]);
      use(place + from * stride, place + to * stride);
    }
}

/// Whether a wall turns the sign of velocity component `c` in the mirrored body. `a` is the wall's own axis.
FLOWREST_INLINE bool odd_across(PlaneWall wall, int a, int c) { return wall == PlaneWall::no_slip || c == a; }

/// Folds what fell on the ghost nodes behind plane walls onto their mirror images: mass is added, momentum
/// with the sign of the mirrored body's. Only the quadratic functions reach behind a wall. Behind a wall of
/// friction only the filling is folded: how far the body is mirrored hangs on what the wall holds, which is
/// known once the nodes are summed (plane_friction.h).
template <class T, int Dim>
void fold_ghosts(T* arena, const BlockView& block, const AxisBounds* bounds) {
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const PlaneWall wall = side == 0 ? bounds[a].lower : bounds[a].upper;
      const int cell = (side == 0 ? bounds[a].lower_cell : bounds[a].upper_cell - 1) - block.origin[a];
      if (wall == PlaneWall::none || cell < 0 || cell >= block_edge) continue;
      across_layers<Dim>(a, side == 0 ? cell : cell + 2, cell + 1, [&](int ghost, int image) {
        T* from = arena + ghost * node_values;
        T* to = arena + image * node_values;
        if (wall == PlaneWall::friction) {
          to[record] += from[record];
          from[record] = T(0);
          return;
        }
        for (int r = 0; r < node_values / record; ++r) {
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

/// Takes the transfer's error (wall_transfer.h) out of the first row of nodes along every no-slip wall. Where
/// the second row holds little the profile is unknown and the first row is left alone (known_profile). Before ghost nodes
/// copy these.
template <class T, int Dim>
void correct_wall_transfer(T* arena, const BlockView& block, const AxisBounds* bounds) {
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side) {
      if ((side == 0 ? bounds[a].lower : bounds[a].upper) != PlaneWall::no_slip) continue;
      const int cell = (side == 0 ? bounds[a].lower_cell : bounds[a].upper_cell - 1) - block.origin[a];
      if (cell < -1 || cell > block_edge) continue;  // the neighbouring block sees the first row too
      across_layers<Dim>(a, cell + 1, side == 0 ? cell + 2 : cell, [&](int first, int second) {
        T* v1 = arena + first * node_values;
        const T* v2 = arena + second * node_values;
        if (!(v1[0] > T(0))) return;
        const T share = T(wall_transfer_correction) * known_profile(v2[0], v1[0]);
        for (int n = 1; n < node_values; ++n)
          if (n != record) v1[n] -= share * (v2[n] - T(3) * v1[n]);
      });
    }
}

/// Sets the velocities that plane walls prescribe. Quadratic: the ghost node mirrors the first one inside.
/// Linear: the node on the wall itself is held. Walls of friction have held their nodes already. Filling is
/// even across every wall: a linear node on a wall sees half of its volume.
template <class T, int Dim, class Shape>
void set_wall_velocities(T* arena, const BlockView& block, const AxisBounds* bounds) {
  constexpr bool mirrored = Shape::nodes == 3;
  if constexpr (mirrored) correct_wall_transfer<T, Dim>(arena, block, bounds);
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const PlaneWall wall = side == 0 ? bounds[a].lower : bounds[a].upper;
      if (wall == PlaneWall::none) continue;
      const int face = (side == 0 ? bounds[a].lower_cell : bounds[a].upper_cell) - block.origin[a];
      const int cell = side == 0 ? face : face - 1;
      if (mirrored ? (cell < 0 || cell >= block_edge) : (face < 0 || face > block_edge)) continue;
      const int held = mirrored ? (side == 0 ? cell : cell + 2) : face;
      across_layers<Dim>(a, held, mirrored ? cell + 1 : held, [&](int node, int image) {
        T* filling = arena + node * node_values + record;
        *filling = mirrored ? arena[image * node_values + record] : T(2) * *filling;
        if (wall == PlaneWall::friction) return;
        for (int r = 0; r < node_values / record; ++r)
          for (int c = 0; c < Dim; ++c) {
            T& value = arena[node * node_values + r * record + 1 + c];
            const T inside = arena[image * node_values + r * record + 1 + c];
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
