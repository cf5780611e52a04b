#pragma once

#include "mpm/transfer/shape.h"
#include "mpm/transfer/tile.h"

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Where the gathered values go: per component the value, its gradient and APIC's affine part.
template <class T, int Dim>
struct Gathered {
  T* value[Dim];
  T* gradient[Dim][Dim];
  T* affine[Dim][Dim];
};

/// The node records of one cell, `Values` numbers of each, as differences along every axis. The weights of an
/// axis sum to one, so that quadratic nodes u0, u1, u2 give the value u1 + w0 (u0 - u1) + w2 (u2 - u1), and
/// their slope and offsets need the differences alone; linear nodes give u0 + x (u1 - u0). That takes half
/// the operations of sums over nodes, no weight is a difference of others, so that a node that is hardly seen
/// stays so to the last digit, and a velocity common to all leaves no round-off in the gradient.
template <class T, int Dim, class Shape, int Values>
struct CellField {
  static constexpr int nodes = Shape::nodes;
  static constexpr int rows = Dim == 3 ? nodes : 1;
  using R = Record<T, Values>;

  const T* line(int i, int j) const { return value + (i * rows + j) * nodes * Values; }

  FLOWREST_INLINE explicit CellField(const T* arena_cell) {
    R u[nodes][rows][nodes];
#pragma GCC unroll 3
    for (int i = 0; i < nodes; ++i)
#pragma GCC unroll 3
      for (int j = 0; j < rows; ++j) {
#pragma GCC unroll 3
        for (int k = 0; k < nodes; ++k)
          u[i][j][k] = record_at<Values>(arena_cell + arena_index<Dim>(i, j, k) * node_values);
        differ(u[i][j][0], u[i][j][1], u[i][j][nodes - 1]);
      }
    if constexpr (Dim == 3) {
#pragma GCC unroll 3
      for (int i = 0; i < nodes; ++i)
#pragma GCC unroll 3
        for (int k = 0; k < nodes; ++k) differ(u[i][0][k], u[i][1][k], u[i][rows - 1][k]);
    }
#pragma GCC unroll 3
    for (int j = 0; j < rows; ++j)
#pragma GCC unroll 3
      for (int k = 0; k < nodes; ++k) {
        differ(u[0][j][k], u[1][j][k], u[nodes - 1][j][k]);
#pragma GCC unroll 3
        for (int i = 0; i < nodes; ++i)
          record_at<Values>(value + ((i * rows + j) * nodes + k) * Values) = u[i][j][k];
      }
  }

 private:
  alignas(64) T value[nodes * rows * nodes * Values];

  static FLOWREST_INLINE void differ(R& first, R& second, R& last) {
    if constexpr (nodes == 3) {
      first -= second;
      last -= second;
    } else {
      second -= first;
    }
  }
};

/// What one axis brings to a register of particles: the factors of the differences above.
template <class T, int Bytes, class Shape>
struct AxisFactors {
  using L = Lanes<T, Bytes>;
  static constexpr bool quadratic = Shape::nodes == 3;
  L weight[2], slope[2], offset[2];  ///< of the first and the last difference; linear: weight[1] alone

  FLOWREST_INLINE explicit AxisFactors(const T* position) {
    const L x = lanes_at<Bytes>(position);
    if constexpr (quadratic) {
      const L below = T(1) - x, first = below * below, last = x * x;
      weight[0] = T(0.5) * first;
      weight[1] = T(0.5) * last;
      slope[0] = -below;
      slope[1] = x;
      // The weights times the nodes' offsets over their second moment.
      offset[0] = first * (T(-2) * x - T(1));
      offset[1] = last * (T(3) - T(2) * x);
    } else {
      weight[1] = x;
    }
  }
  /// Of the differences as they are stored, or as another axis has left them.
  FLOWREST_INLINE L value_of(T first, T second, T last) const {
    if constexpr (quadratic) return weight[1] * last + (weight[0] * first + second);
    return weight[1] * second + first;
  }
  FLOWREST_INLINE L value_of(const L& first, const L& second, const L& last) const {
    if constexpr (quadratic) return weight[1] * last + (weight[0] * first + second);
    return weight[1] * second + first;
  }
  FLOWREST_INLINE L slope_of(T first, T second, T last) const {
    if constexpr (quadratic) return slope[1] * last + slope[0] * first;
    return L{} + second;
  }
  FLOWREST_INLINE L slope_of(const L& first, const L& second, const L& last) const {
    if constexpr (quadratic) return slope[1] * last + slope[0] * first;
    return second;
  }
  FLOWREST_INLINE L offset_of(T first, T last) const { return offset[1] * last + offset[0] * first; }
  FLOWREST_INLINE L offset_of(const L& first, const L& last) const {
    return offset[1] * last + offset[0] * first;
  }
};

/// What is asked of a field at the particles.
struct Wanted {
  bool value = true, gradient = false, affine = false;
};

/// Evaluates component `c` of a cell's field at the particles of one register.
template <class T, int Dim, class Shape, int Values, Wanted Want, int Bytes>
FLOWREST_INLINE void evaluate(const CellField<T, Dim, Shape, Values>& field, int c,
                              const AxisFactors<T, Bytes, Shape> (&axis)[Dim], T per_cell, int q, T* value,
                              T* const* gradient, T* const* affine) {
  using L = Lanes<T, Bytes>;
  constexpr int nodes = Shape::nodes, rows = field.rows, last = nodes - 1;
  const auto& z = axis[Dim - 1];
  // Over the last axis, then the second, then the first; `by_` says along which axis a slope or offset was
  // taken.
  L plain[nodes], slope_1[nodes], slope_2[nodes], offset_1[nodes], offset_2[nodes];
#pragma GCC unroll 3
  for (int i = 0; i < nodes; ++i) {
    L v[rows], g[rows], h[rows];
#pragma GCC unroll 3
    for (int j = 0; j < rows; ++j) {
      const T* u = field.line(i, j) + c;
      const T first = u[0], second = u[Values], third = u[last * Values];
      v[j] = z.value_of(first, second, third);
      if constexpr (Want.gradient) g[j] = z.slope_of(first, second, third);
      if constexpr (Want.affine) h[j] = z.offset_of(first, third);
    }
    if constexpr (Dim == 3) {
      const auto& y = axis[1];
      plain[i] = y.value_of(v[0], v[1], v[last]);
      if constexpr (Want.gradient) {
        slope_1[i] = y.slope_of(v[0], v[1], v[last]);
        slope_2[i] = y.value_of(g[0], g[1], g[last]);
      }
      if constexpr (Want.affine) {
        offset_1[i] = y.offset_of(v[0], v[last]);
        offset_2[i] = y.value_of(h[0], h[1], h[last]);
      }
    } else {
      plain[i] = v[0];
      if constexpr (Want.gradient) slope_1[i] = g[0];
      if constexpr (Want.affine) offset_1[i] = h[0];
    }
  }
  const auto& x = axis[0];
  const auto over_first = [&](const L(&u)[nodes]) { return x.value_of(u[0], u[1], u[last]); };
  if constexpr (Want.value) lanes_at<Bytes>(value + q) = over_first(plain);
  if constexpr (Want.gradient) {
    lanes_at<Bytes>(gradient[0] + q) = per_cell * x.slope_of(plain[0], plain[1], plain[last]);
    lanes_at<Bytes>(gradient[1] + q) = per_cell * over_first(slope_1);
    if constexpr (Dim == 3) lanes_at<Bytes>(gradient[2] + q) = per_cell * over_first(slope_2);
  }
  if constexpr (Want.affine) {
    lanes_at<Bytes>(affine[0] + q) = x.offset_of(plain[0], plain[last]);
    lanes_at<Bytes>(affine[1] + q) = over_first(offset_1);
    if constexpr (Dim == 3) lanes_at<Bytes>(affine[2] + q) = over_first(offset_2);
  }
}

/// One register of particles: velocities are the field's components from `component` on; `filling`, where not
/// null, takes the filling, the first number of a node's second record.
template <class T, int Dim, class Shape, int Values, Wanted Want, int Bytes>
FLOWREST_INLINE void gather_register(const CellField<T, Dim, Shape, Values>& field, int component,
                                     const T* const* position, T per_cell, int q, const Gathered<T, Dim>& out,
                                     T* filling) {
  using Factors = AxisFactors<T, Bytes, Shape>;
  const auto all = [&](const Factors(&axis)[Dim]) __attribute__((always_inline)) {
    for (int c = 0; c < Dim; ++c)
      evaluate<T, Dim, Shape, Values, Want, Bytes>(field, component + c, axis, per_cell, q, out.value[c],
                                                   out.gradient[c], out.affine[c]);
    if (filling)
      evaluate<T, Dim, Shape, Values, Wanted{}, Bytes>(field, Values - record, axis, per_cell, q, filling,
                                                       nullptr, nullptr);
  };
  if constexpr (Dim == 3) {
    const Factors axis[3] = {Factors(position[0] + q), Factors(position[1] + q), Factors(position[2] + q)};
    all(axis);
  } else {
    const Factors axis[2] = {Factors(position[0] + q), Factors(position[1] + q)};
    all(axis);
  }
}

/// Interpolates a field to the particles [first, first + count) of its cell, a register of particles at a
/// time, a narrow one where that is enough. Lanes past the cell's end hold rubbish that the next cell, or the
/// padding, takes. Gradients are per metre where `per_cell` is cells per metre.
template <class T, int Dim, class Shape, int Values, Wanted Want>
void gather(const CellField<T, Dim, Shape, Values>& field, int component, const T* const* position,
            T per_cell, int first, int count, const Gathered<T, Dim>& out, T* filling) {
  constexpr int lanes = lane_bytes / static_cast<int>(sizeof(T));
  constexpr int narrow = narrow_lane_bytes / static_cast<int>(sizeof(T));
  const int end = first + count;
  int q = first;
  for (; q + narrow < end; q += lanes)
    gather_register<T, Dim, Shape, Values, Want, lane_bytes>(field, component, position, per_cell, q, out,
                                                             filling);
  if (q < end)
    gather_register<T, Dim, Shape, Values, Want, narrow_lane_bytes>(field, component, position, per_cell, q,
                                                                    out, filling);
}

template <class T, int Dim>
Gathered<T, Dim> room_for_gathered(Tile<T, Dim>& tile, Wanted want) {
  Gathered<T, Dim> g{};
  for (int c = 0; c < Dim; ++c) {
    if (want.value) g.value[c] = tile.fresh();
    for (int a = 0; a < Dim; ++a) {
      if (want.gradient) g.gradient[c][a] = tile.fresh();
      if (want.affine) g.affine[c][a] = tile.fresh();
    }
  }
  return g;
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
