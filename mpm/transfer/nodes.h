#pragma once

#include "mpm/boundary/plane_walls.h"
#include "mpm/transfer/tile.h"

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Sums the arenas that share a block of nodes, in a fixed order, and turns momentum into velocity. Records
/// after it: (mass, new velocity), (filling, new velocity - keep * old velocity). With Remap the second
/// stays as it was.
template <class T, int Dim, bool Remap>
void update_nodes(const StepParameters<T>& step, const NodeView& view, const T* arenas, T* nodes) {
  constexpr int records = Remap ? 1 : 2;
  T* out = nodes + static_cast<std::size_t>(view.slot) * cells_per_block<Dim> * node_values;
  for (int node = 0; node < cells_per_block<Dim>; ++node) {
    int c[3];
    cell_coordinates<T, Dim>(node, c);
    Record<T> sum[records];
    // By index: a deduced reference would lose the records' alignment, which is that of one number.
    for (int r = 0; r < records; ++r) sum[r] = Record<T>{};
    for (int delta = 0; delta < (1 << Dim); ++delta) {
      const int di = delta >> (Dim - 1) & 1, dj = Dim == 3 ? delta >> 1 & 1 : 0, dk = delta & 1;
      const std::uint32_t arena = view.minus[delta];
      if (arena == no_slot) continue;
      const int i = c[0] + di * block_edge, j = c[1] + dj * block_edge, k = c[2] + dk * block_edge;
      if (i >= arena_edge || j >= arena_edge || k >= arena_edge) continue;
      const T* from =
          arenas +
          (static_cast<std::size_t>(arena) * nodes_per_arena<Dim> + arena_index<Dim>(i, j, k)) * node_values;
      for (int r = 0; r < records; ++r) sum[r] += record_at(from + r * record);
    }
    const T mass = sum[0][0];
    const T per_mass = mass > step.smallest_mass ? T(1) / mass : T(0);
    if constexpr (Remap) {
      record_at(out + node * node_values) = sum[0] * per_mass;
    } else {
      const Record<T> velocity = (sum[0] + sum[1]) * per_mass;
      record_at(out + node * node_values) = velocity;
      record_at(out + node * node_values + record) = velocity - sum[0] * (step.keep * per_mass);
      out[node * node_values + record] = sum[1][0];
    }
    out[node * node_values] = mass;
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
