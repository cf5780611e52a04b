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

/// How far the cells along plane walls that hold them are covered with material, from 0 to 1, for a tile's
/// particles; null if its block has no such wall. Beside a wall of friction it counts as far as the wall
/// holds: `holds` are of the block's nodes, null where there is no such wall.
template <class T, int Dim, class Shape>
const T* covered_beside_walls(const StepParameters<T>& step, Tile<T, Dim>& tile, const T* arena,
                              const T* holds) {
  struct Side {
    int axis, cell, node;  ///< the cell at the wall, and which of its nodes along the axis is furthest off it
    int held;              ///< which of them a wall of friction holds; -1: one of no slip
  };
  Side sides[2 * Dim];
  int count = 0;
  for (int a = 0; a < Dim; ++a) {
    const AxisBounds& bounds = step.bounds[a];
    const int lower = bounds.lower_cell - tile.block.origin[a],
              upper = bounds.upper_cell - 1 - tile.block.origin[a];
    const auto inside = [](int cell) { return cell >= 0 && cell < block_edge; };
    const auto held = [](PlaneWall wall, int node) { return wall == PlaneWall::friction ? node : -1; };
    constexpr int middle = Shape::nodes / 2;  // the first node inside, of linear functions that on the wall
    if (may_hold(bounds.lower) && inside(lower))
      sides[count++] = {a, lower, Shape::nodes - 1, held(bounds.lower, Shape::nodes == 3 ? middle : 0)};
    if (may_hold(bounds.upper) && inside(upper)) sides[count++] = {a, upper, 0, held(bounds.upper, middle)};
  }
  if (count == 0) return nullptr;

  T* covered = tile.fresh();
  for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
    int place[3];
    cell_coordinates<T, Dim>(cell, place);
    T most = T(0);
    for (int n = 0; n < count; ++n) {
      const Side& side = sides[n];
      if (place[side.axis == 0 ? 0 : side.axis + 3 - Dim] != side.cell) continue;
      // Of the nodes on the far layer, the one over the cell's middle; linear functions have none there, and
      // all of theirs must be covered.
      T least = T(1), least_held = T(1);
      constexpr int from = Shape::nodes == 3 ? 1 : 0;
      for (int i = from; i < 2; ++i)
        for (int j = Dim == 3 ? from : 1; j < 2; ++j) {
          int node[3];
          node[0] = node[1] = node[2] = i;
          if constexpr (Dim == 3) node[side.axis == 2 ? 1 : 2] = j;
          const auto node_at = [&](int along) {
            node[side.axis] = along;
            return cell_base<T, Dim>(cell) + (Dim == 3 ? arena_index<Dim>(node[0], node[1], node[2])
                                                       : arena_index<Dim>(node[0], 0, node[1]));
          };
          least = minimum(least, arena[node_at(side.node) * node_values + record]);
          if (side.held >= 0) least_held = minimum(least_held, holds[node_at(side.held)]);
        }
      constexpr T span = T(1.0 / (wholly_covered_from - covered_from));
      most = maximum(most, least_held * minimum((least - T(covered_from)) * span, T(1)));
    }
    const int first = tile.cell_first(cell);
    for (int q = first; q < first + tile.cell_count(cell); ++q) covered[q] = most;
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
