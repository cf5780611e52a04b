#pragma once

#include "mpm/transfer/shape.h"
#include "mpm/transfer/tile.h"

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Where the gathered values go: per component the value, its gradient per cell and its weighted offsets.
template <class T, int Dim>
struct Gathered {
  T* value[Dim];
  T* gradient[Dim][Dim];
  T* affine[Dim][Dim];
};

/// Interpolates node velocities (of one record) to the particles [first, first + count) of one cell, a
/// register of particles at a time. Lanes past the cell's end hold rubbish that the next cell, or the
/// padding, takes.
template <class T, int Dim, class Shape, bool Value, bool Gradient, bool Affine>
void gather(const T* arena_cell, int node_stride, const T* const* position, const Weights<T, Dim, Shape>& w,
            int first, int count, const Gathered<T, Dim>& out) {
  constexpr int nodes = Shape::nodes;
  constexpr int lanes = static_cast<int>(sizeof(Lanes<T>) / sizeof(T));
  constexpr int last = Dim - 1;
  using L = Lanes<T>;
  const L zero = {};
  for (int q = first; q < first + count; q += lanes) {
    for (int c = 0; c < Dim; ++c) {
      L value = zero, slope0 = zero, slope1 = zero, slope2 = zero, moment0 = zero, moment1 = zero,
        moment2 = zero;
#pragma GCC unroll 3
      for (int i = 0; i < nodes; ++i) {
        // Sums over the remaining axes of this slab: plain, with slopes, and with offsets (0, +-1 for
        // quadratic nodes).
        L plain = zero, with_slope1 = zero, with_slope2 = zero, with_offset1 = zero, with_offset2 = zero;
#pragma GCC unroll 3
        for (int j = 0; j < (Dim == 3 ? nodes : 1); ++j) {
          const T* node = arena_cell + arena_index<Dim>(i, j, 0) * node_stride + 1 + c;
          L line = zero, line_slope = zero, line_offset = zero;
#pragma GCC unroll 3
          for (int k = 0; k < nodes; ++k) {
            const T u = node[k * node_stride];
            const L weighted = lanes_at(w.weight[last][k] + q) * u;
            line += weighted;
            if constexpr (Gradient) line_slope += lanes_at(w.slope[last][k] + q) * u;
            if constexpr (Affine) {
              if (k == 0) line_offset -= weighted;
              if (k == 2) line_offset += weighted;
            }
          }
          if constexpr (Dim == 3) {
            const L wj = lanes_at(w.weight[1][j] + q);
            const L weighted = wj * line;
            plain += weighted;
            if constexpr (Gradient) {
              with_slope1 += lanes_at(w.slope[1][j] + q) * line;
              with_slope2 += wj * line_slope;
            }
            if constexpr (Affine) {
              if (j == 0) with_offset1 -= weighted;
              if (j == 2) with_offset1 += weighted;
              with_offset2 += wj * line_offset;
            }
          } else {
            plain = line;
            with_slope1 = line_slope;
            with_offset1 = line_offset;
          }
        }
        const L wi = lanes_at(w.weight[0][i] + q);
        const L weighted = wi * plain;
        value += weighted;
        if constexpr (Gradient) {
          slope0 += lanes_at(w.slope[0][i] + q) * plain;
          slope1 += wi * with_slope1;
          if constexpr (Dim == 3) slope2 += wi * with_slope2;
        }
        if constexpr (Affine) {
          if (i == 0) moment0 -= weighted;
          if (i == 2) moment0 += weighted;
          moment1 += wi * with_offset1;
          if constexpr (Dim == 3) moment2 += wi * with_offset2;
        }
      }
      if constexpr (Value) lanes_at(out.value[c] + q) = value;
      if constexpr (Gradient) {
        lanes_at(out.gradient[c][0] + q) = slope0;
        lanes_at(out.gradient[c][1] + q) = slope1;
        if constexpr (Dim == 3) lanes_at(out.gradient[c][2] + q) = slope2;
      }
      if constexpr (Affine) {
        const T inverse = T(Quadratic::inverse_moment);
        lanes_at(out.affine[c][0] + q) = inverse * (moment0 - (lanes_at(position[0] + q) - T(0.5)) * value);
        lanes_at(out.affine[c][1] + q) = inverse * (moment1 - (lanes_at(position[1] + q) - T(0.5)) * value);
        if constexpr (Dim == 3)
          lanes_at(out.affine[c][2] + q) = inverse * (moment2 - (lanes_at(position[2] + q) - T(0.5)) * value);
      }
    }
  }
}

/// Interpolates the nodes' filling, the first number of the records at `arena_cell`, to the particles
/// [first, first + count) of one cell.
template <class T, int Dim, class Shape>
void gather_filling(const T* arena_cell, int node_stride, const Weights<T, Dim, Shape>& w, int first,
                    int count, T* filling) {
  constexpr int nodes = Shape::nodes;
  constexpr int lanes = static_cast<int>(sizeof(Lanes<T>) / sizeof(T));
  constexpr int last = Dim - 1;
  using L = Lanes<T>;
  for (int q = first; q < first + count; q += lanes) {
    L value = {};
#pragma GCC unroll 3
    for (int i = 0; i < nodes; ++i) {
      L plane = {};
#pragma GCC unroll 3
      for (int j = 0; j < (Dim == 3 ? nodes : 1); ++j) {
        const T* node = arena_cell + arena_index<Dim>(i, j, 0) * node_stride;
        L line = {};
#pragma GCC unroll 3
        for (int k = 0; k < nodes; ++k) line += lanes_at(w.weight[last][k] + q) * node[k * node_stride];
        if constexpr (Dim == 3) {
          plane += lanes_at(w.weight[1][j] + q) * line;
        } else {
          plane = line;
        }
      }
      value += lanes_at(w.weight[0][i] + q) * plane;
    }
    lanes_at(filling + q) = value;
  }
}

template <class T, int Dim>
Gathered<T, Dim> room_for_gathered(Tile<T, Dim>& tile, bool value, bool gradient, bool affine) {
  Gathered<T, Dim> g{};
  for (int c = 0; c < Dim; ++c) {
    if (value) g.value[c] = tile.fresh();
    for (int a = 0; a < Dim; ++a) {
      if (gradient) g.gradient[c][a] = tile.fresh();
      if (affine) g.affine[c][a] = tile.fresh();
    }
  }
  return g;
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
