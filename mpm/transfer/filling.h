#pragma once

#include "mpm/material/stress_update.h"
#include "mpm/transfer/shape.h"
#include "mpm/transfer/tile.h"

/// What particles make of how full their surroundings are: the nodes' filling, particles' volume per volume
/// of the node, read at the particles. Filling is even across plane walls, so that it is 1 right up to them.
namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Filling below which a particle belongs to a drop. At a plane surface it is a half, at an edge a quarter.
constexpr double drop_filling = 0.2;
/// Filling of the nodes over a cell beside a wall from which the cell begins to be covered, and is. A layer
/// of a cell and a half has a half there (quadratic functions), one of two cells seven eighths.
constexpr double covered_from = 0.7, wholly_covered_from = 0.95;

/// Whether a plane wall may hold what lies along it.
FLOWREST_INLINE bool may_hold(PlaneWall wall) {
  return wall == PlaneWall::no_slip || wall == PlaneWall::friction;
}

/// A plane wall that may hold what lies along it, as a tile sees it.
struct HoldingSide {
  int axis, cell;  ///< the cell at the wall, in the block
  bool upper;
  bool friction;  ///< else of no slip
};

/// The walls of a tile's block that may hold; returns how many. Cells next to those at a wall see it too.
template <class T, int Dim>
int holding_sides(const StepParameters<T>& step, const Tile<T, Dim>& tile, HoldingSide* sides) {
  int count = 0;
  for (int a = 0; a < Dim; ++a) {
    const AxisBounds& bounds = step.bounds[a];
    const int lower = bounds.lower_cell - tile.block.origin[a],
              upper = bounds.upper_cell - 1 - tile.block.origin[a];
    if (may_hold(bounds.lower) && lower >= -1 && lower < block_edge)
      sides[count++] = {a, lower, false, bounds.lower == PlaneWall::friction};
    if (may_hold(bounds.upper) && upper >= 0 && upper <= block_edge)
      sides[count++] = {a, upper, true, bounds.upper == PlaneWall::friction};
  }
  return count;
}

/// How far a node over the first row at a wall is full, as the first row is covered by it.
template <class T>
FLOWREST_INLINE T cover(T filling) {
  constexpr T span = T(1.0 / (wholly_covered_from - covered_from));
  return minimum(maximum((filling - T(covered_from)) * span, T(0)), T(1));
}

/// Adds a wall's part for one cell. Quadratic functions: the first row of nodes inside has a cover, by the row over
/// it and as far as a wall of friction holds there; so has its mirror image behind the wall; all others have none.
/// Particles take it up with the functions' own weights, so that it neither jumps from cell to cell nor with height.
template <class T, int Dim>
void cover_cell(const StepParameters<T>& step, const Tile<T, Dim>& tile, const HoldingSide& side, int cell,
                const int* place, const T* arena, const T* holds, const T* const* x, T* covered) {
  const auto place_along = [&](int axis) { return place[axis == 0 ? 0 : axis + 3 - Dim]; };
  const int layer = side.upper ? side.cell - place_along(side.axis) : place_along(side.axis) - side.cell;
  if (layer < 0 || layer > 1) return;
  const int second = side.upper ? layer : 2 - layer, first = side.upper ? 1 + layer : 1 - layer;
  const int across[2] = {side.axis == 0 ? 1 : 0, side.axis == 2 ? 1 : 2};
  // Behind another wall the body is mirrored.
  const auto mirrored = [&](int axis, int node) {
    const AxisBounds& b = step.bounds[axis];
    const int at = place_along(axis) + tile.block.origin[axis];
    const bool ghost = (node == 0 && b.lower != PlaneWall::none && at == b.lower_cell) ||
                       (node == 2 && b.upper != PlaneWall::none && at == b.upper_cell - 1);
    return ghost ? 1 : node;
  };
  T value[3][3];
  for (int j = 0; j < 3; ++j)
    for (int k = 0; k < (Dim == 3 ? 3 : 1); ++k) {
      int node[3] = {0, 0, 0};
      node[across[0]] = mirrored(across[0], j);
      if constexpr (Dim == 3) node[across[1]] = mirrored(across[1], k);
      const auto index = [&](int along) {
        node[side.axis] = along;
        return cell_base<T, Dim>(cell) + (Dim == 3 ? arena_index<Dim>(node[0], node[1], node[2])
                                                   : arena_index<Dim>(node[0], 0, node[1]));
      };
      value[j][k] = cover(arena[index(second) * node_values + record]);
      if (side.friction) value[j][k] *= holds[index(first)];
    }
  const int begin = tile.cell_first(cell), end = begin + tile.cell_count(cell);
  const T *up = x[side.axis], *one = x[across[0]], *two = x[Dim == 3 ? across[1] : 0];
#pragma omp simd
  for (int q = begin; q < end; ++q) {
    const T height = side.upper ? T(1) - up[q] : up[q], left = T(1) - height;
    const T down = layer == 0 ? T(1) - T(0.5) * height * height : T(0.5) * left * left;
    T sum = T(0);
    for (int j = 0; j < 3; ++j) {
      T row = value[j][0];
      if constexpr (Dim == 3)
        row = Quadratic::weight(0, two[q]) * value[j][0] + Quadratic::weight(1, two[q]) * value[j][1] +
              Quadratic::weight(2, two[q]) * value[j][2];
      sum += Quadratic::weight(j, one[q]) * row;
    }
    covered[q] = maximum(covered[q], down * sum);
  }
}

/// The same of linear functions, whose wall has a row of nodes of its own: for a cell at the wall as a whole, by the
/// least filled of the nodes over it.
template <class T, int Dim>
void cover_cell_whole(const Tile<T, Dim>& tile, const HoldingSide& side, int cell, const int* place,
                      const T* arena, const T* holds, T* covered) {
  if (place[side.axis == 0 ? 0 : side.axis + 3 - Dim] != side.cell) return;
  T least = T(1), least_held = T(1);
  for (int i = 0; i < 2; ++i)
    for (int j = Dim == 3 ? 0 : 1; j < 2; ++j) {
      int node[3];
      node[0] = node[1] = node[2] = i;
      if constexpr (Dim == 3) node[side.axis == 2 ? 1 : 2] = j;
      const auto node_at = [&](int along) {
        node[side.axis] = along;
        return cell_base<T, Dim>(cell) + (Dim == 3 ? arena_index<Dim>(node[0], node[1], node[2])
                                                   : arena_index<Dim>(node[0], 0, node[1]));
      };
      least = minimum(least, arena[node_at(side.upper ? 0 : 1) * node_values + record]);
      if (side.friction) least_held = minimum(least_held, holds[node_at(side.upper ? 1 : 0)]);
    }
  const T own = least_held * cover(least);
  const int first = tile.cell_first(cell);
  for (int q = first; q < first + tile.cell_count(cell); ++q) covered[q] = maximum(covered[q], own);
}

/// How far a tile's particles lie in covered cells along plane walls that hold them, from 0 to 1; null if its block
/// has no such wall. Beside a wall of friction it counts as far as the wall holds: `holds` are of the block's nodes,
/// null where there is no such wall.
template <class T, int Dim, class Shape>
const T* covered_beside_walls(const StepParameters<T>& step, Tile<T, Dim>& tile, const T* arena,
                              const T* holds, const T* const* x) {
  HoldingSide sides[2 * Dim];
  const int count = holding_sides<T, Dim>(step, tile, sides);
  if (count == 0) return nullptr;
  T* covered = tile.fresh();
  for (int q = 0; q < tile.count; ++q) covered[q] = T(0);
  for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
    if (tile.cell_count(cell) == 0) continue;
    int place[3];
    cell_coordinates<T, Dim>(cell, place);
    for (int n = 0; n < count; ++n) {
      if constexpr (Shape::nodes == 3)
        cover_cell<T, Dim>(step, tile, sides[n], cell, place, arena, holds, x, covered);
      else
        cover_cell_whole<T, Dim>(tile, sides[n], cell, place, arena, holds, covered);
    }
  }
  return covered;
}

/// What a particle makes of its surroundings' filling.
///
/// Less than a body has: a drop of a few particles. What it pushes are nodes that carry nothing else, and
/// near a cell's face one of them weighs next to nothing: over a step that is long enough for a body, its
/// pressure swings ever wider until it leaps off the wall or the grid. So the less there is around it, the
/// less of the strain it feels is its own; it flies, lands and is pushed as before.
///
/// More than full: particles overlap. A sum over a cell's particles is not an integral over the cell: where
/// material is sheared for long, particles drift together while the divergence they see is zero, and the body
/// sinks into itself unnoticed by the volume they carry. A particle whose surroundings are fuller than full
/// is told that it is compressed, at a rate in proportion to the shearing that drives the drift, so that what
/// is at rest stays so; its pressure then makes room.
///
/// Less than full: under a free surface it is so by right, and closing gaps there pulls a thin front back.
/// But a front that rolls over a floor that holds it lays particles above a gap: none ever reaches the floor,
/// and the volume they carry does not know. So beside a wall, in cells that are `covered`, a particle is told
/// in the same way that it is stretched, and what lies above comes down.
template <class T, int Dim>
void heed_filling(const StepParameters<T>& step, const Strain<T, Dim>& s, const T* filling, const T* covered,
                  int count) {
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    const T share = minimum(filling[q] * T(1.0 / drop_filling), T(1));
    const T overlap = maximum(filling[q] - T(1), T(0));
    s.dilatation[q] = s.dilatation[q] * share * share * (Dim == 3 ? share : T(1)) -
                      step.density_correction * s.rate[q] * overlap;
  }
  if (!covered) return;
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    const T gap = maximum(T(1) - filling[q], T(0));
    s.dilatation[q] += step.density_correction * s.rate[q] * gap * covered[q];
  }
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
