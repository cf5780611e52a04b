#pragma once

#include "mpm/boundary/plane_walls.h"
#include "mpm/transfer/tile.h"

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Sums the arenas that share a block of nodes, in a fixed order, and turns momentum into velocity. Records
/// after it: (mass, new velocity), (filling, new velocity - keep * old velocity). With Remap the second
/// stays as it was.
template <class T, int Dim, bool Remap>
void update_nodes(const StepParameters<T>& step, const NodeView& view, const Grid<T>& grid) {
  constexpr int values = cells_per_block<Dim> * node_values, beyond = arena_edge - block_edge;
  alignas(64) T sums[values];
  for (int n = 0; n < values; ++n) sums[n] = T(0);
  for (int delta = 0; delta < (1 << Dim); ++delta) {
    const std::uint32_t arena = view.minus[delta];
    if (arena == no_slot) continue;
    // Of its own block an arena has every node, of a block beyond it the first few layers.
    const int di = delta >> (Dim - 1) & 1, dj = Dim == 3 ? delta >> 1 & 1 : 0, dk = delta & 1;
    const int rows = Dim == 3 ? (dj == 0 ? block_edge : beyond) : 1;
    const T* from = grid.arenas + static_cast<std::size_t>(arena) * nodes_per_arena<Dim> * node_values;
    for (int i = 0; i < (di == 0 ? block_edge : beyond); ++i)
      for (int j = 0; j < rows; ++j) {
        const T* row =
            from + arena_index<Dim>(i + di * block_edge, j + dj * block_edge, dk * block_edge) * node_values;
        T* to = sums + (Dim == 3 ? i * block_edge + j : i) * block_edge * node_values;
        if (dk == 0) {
          for (int n = 0; n < block_edge * node_values; ++n) to[n] += row[n];
        } else {
          for (int n = 0; n < beyond * node_values; ++n) to[n] += row[n];
        }
      }
  }
  T* out = grid.nodes + static_cast<std::size_t>(view.slot) * values;
  for (int node = 0; node < values; node += node_values) {
    const Record<T> carried = record_at(sums + node), forced = record_at(sums + node + record);
    const T mass = carried[0];
    const T per_mass = mass > step.smallest_mass ? T(1) / mass : T(0);
    if constexpr (Remap) {
      record_at(out + node) = carried * per_mass;
    } else {
      const Record<T> velocity = (carried + forced) * per_mass;
      record_at(out + node) = velocity;
      record_at(out + node + record) = velocity - carried * (step.keep * per_mass);
      out[node + record] = forced[0];
    }
    out[node] = mass;
  }
}

/// Copies the nodes a block's particles can see into one arena and sets the walls' values.
template <class T, int Dim, class Shape>
void load_arena(const StepParameters<T>& step, const BlockView& block, const T* nodes, T* arena) {
  for (int i = 0; i < arena_edge; ++i)
    for (int j = 0; j < (Dim == 3 ? arena_edge : 1); ++j)
      for (int half = 0; half < 2; ++half) {
        const int delta =
            Dim == 3 ? (i / block_edge) * 4 + (j / block_edge) * 2 + half : (i / block_edge) * 2 + half;
        const int run = (half == 0 ? block_edge : arena_edge - block_edge) * node_values;
        T* to = arena + arena_index<Dim>(i, j, half * block_edge) * node_values;
        const std::uint32_t slot = block.plus[delta];
        const int local = Dim == 3 ? (i % block_edge * block_edge + j % block_edge) * block_edge
                                   : i % block_edge * block_edge;
        const T* from = nodes + (static_cast<std::size_t>(slot) * cells_per_block<Dim> + local) * node_values;
        for (int n = 0; n < run; ++n) to[n] = from[n];
      }
  set_wall_velocities<T, Dim, Shape>(arena, block, step.bounds);
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
