#pragma once

#include "mpm/simd/lanes.h"
#include "mpm/solver/kernels.h"
#include "mpm/solver/layout.h"
#include "mpm/transfer/shape.h"

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

template <int Dim>
FLOWREST_INLINE constexpr int arena_index(int i, int j, int k) {
  return Dim == 3 ? (i * arena_edge + j) * arena_edge + k : i * arena_edge + k;
}

/// A run of whole cells whose particles are handled together, as structures of arrays in the workspace.
template <class T, int Dim>
struct Tile {
  const BlockView& block;
  T* memory;
  int capacity;
  int used = 0;
  int first_cell = 0, last_cell = 0;  ///< [first, last) of the block
  int first = 0, count = 0;           ///< of the block's particles

  Tile(const BlockView& b, const Workspace<T>& w) : block(b), memory(w.memory), capacity(w.capacity) {}

  /// Takes the next cells, as many as fit; false when none are left.
  bool next() {
    constexpr int cells = cells_per_block<Dim>;
    first_cell = last_cell;
    while (first_cell < cells && block.start[first_cell + 1] == block.start[first_cell]) ++first_cell;
    if (first_cell == cells) return false;
    first = static_cast<int>(block.start[first_cell]);
    last_cell = first_cell + 1;
    while (last_cell < cells &&
           static_cast<int>(block.start[last_cell + 1]) - first <= capacity - tile_padding)
      ++last_cell;
    count = static_cast<int>(block.start[last_cell]) - first;
    used = 0;
    return true;
  }
  T* fresh() { return memory + capacity * used++; }
  int cell_first(int cell) const { return static_cast<int>(block.start[cell]) - first; }
  int cell_count(int cell) const { return static_cast<int>(block.start[cell + 1] - block.start[cell]); }

  /// The tile's values of a particle array.
  T* open(T* array) const { return array + block.first + first; }
  void write(T* array, const T* values) const {
    T* to = open(array);
    for (int q = 0; q < count; ++q) to[q] = values[q];
  }
};

/// Weights of a tile's particles, per axis, of the cell's first and last node there.
template <class T, int Dim, class Shape>
struct Weights {
  T* weight[Dim][2];

  void make(Tile<T, Dim>& tile, const T* const* position) {
    for (int a = 0; a < Dim; ++a) {
      for (int side = 0; side < 2; ++side) weight[a][side] = tile.fresh();
      const T* x = position[a];
#pragma omp simd
      for (int q = 0; q < tile.count; ++q)
        for (int side = 0; side < 2; ++side)
          weight[a][side][q] = Shape::weight(outer_node<Shape>(side), x[q]);
    }
  }
};

template <class T, int Dim>
FLOWREST_INLINE void cell_coordinates(int cell, int (&c)[3]) {
  if constexpr (Dim == 3) {
    c[0] = cell / 16;
    c[1] = cell / 4 % 4;
    c[2] = cell % 4;
  } else {
    c[0] = cell / 4;
    c[1] = 0;
    c[2] = cell % 4;
  }
}

/// Arena node of a cell's first stencil node.
template <class T, int Dim>
FLOWREST_INLINE int cell_base(int cell) {
  int c[3];
  cell_coordinates<T, Dim>(cell, c);
  return arena_index<Dim>(c[0], c[1], c[2]);
}

/// Pressure to deposit with each particle of a cell: the volume-weighted average over the cell, the adjoint
/// of the averaged divergence (B-bar by cell average).
template <class T, int Dim>
void average_over_cells(const Tile<T, Dim>& tile, const T* volume, T* value) {
  for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
    const int first = tile.cell_first(cell), count = tile.cell_count(cell);
    if (count < 2) continue;
    T sum = T(0), total = T(0);
    for (int q = first; q < first + count; ++q) {
      sum += volume[q] * value[q];
      total += volume[q];
    }
    const T mean = sum / total;
    for (int q = first; q < first + count; ++q) value[q] = mean;
  }
}

/// Global index of each particle's cell along the radius, as a number.
template <class T, int Dim>
void radial_cells(const Tile<T, Dim>& tile, T* out) {
  for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
    int c[3];
    cell_coordinates<T, Dim>(cell, c);
    const int first = tile.cell_first(cell), count = tile.cell_count(cell);
    for (int q = first; q < first + count; ++q) out[q] = static_cast<T>(tile.block.origin[0] + c[0]);
  }
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
