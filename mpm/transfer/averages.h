#pragma once

#include "mpm/boundary/plane_walls.h"
#include "mpm/transfer/gather.h"
#include "mpm/transfer/tile.h"

/// Averages through the nodes: what particles have is given to the nodes with the quadratic functions'
/// weights, divided by the volume that came with it, and given back with the same weights. This operator is
/// its own adjoint in the particles' volume and keeps what is the same everywhere, so that the averaged
/// divergence and the averaged pressure do the same work (the smooth B-bar).
namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// A scalar of every node of an arena. Rows are written four at a time, so that the last one needs room
/// behind.
template <int Dim>
constexpr int plane_values = nodes_per_arena<Dim> + record;

/// Scalars of a tile's particles times their weights along the last axis: four numbers a scalar, the last of
/// them nought.
template <class T, int Dim, int Scalars>
T* weighted_rows(Tile<T, Dim>& tile, const Weights<T, Dim, Quadratic>& weights,
                 const T* const (&scalar)[Scalars]) {
  T* const rows = tile.memory + tile.capacity * tile.used;
  tile.used += record * Scalars;
  for (int q = 0; q < tile.count; q += record)
    for (int s = 0; s < Scalars; ++s) {
      const Record<T> value = record_at(scalar[s] + q);
      const Record<T> below = value * record_at(weights.weight[Dim - 1][0] + q);
      const Record<T> above = value * record_at(weights.weight[Dim - 1][1] + q);
      Record<T> row[4] = {below, value - below - above, above, Record<T>{}};
      transpose<T>(row);
      for (int n = 0; n < record; ++n) record_at(rows + ((q + n) * Scalars + s) * record) = row[n];
    }
  return rows;
}

/// Adds the particles [first, first + count), all of one cell, to that cell's nodes in the planes of
/// `Together` scalars from `from` on.
template <class T, int Dim, int Scalars, int Together>
FLOWREST_INLINE void scatter_together(T* planes, int base, const T* rows,
                                      const Weights<T, Dim, Quadratic>& weights, int first, int count,
                                      int from) {
  constexpr int across = Dim == 3 ? 3 : 1, values = record * Together;
  using R = Record<T, values>;
  R sum[3][across];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
    for (int j = 0; j < across; ++j) sum[i][j] = R{};
  for (int q = first; q < first + count; ++q) {
    const R row = record_at<values>(rows + (q * Scalars + from) * record);
    const R along[3] = {weights.weight[0][0][q] * row, row, weights.weight[0][1][q] * row};
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      if constexpr (Dim == 3) {
        sum[i][0] += weights.weight[1][0][q] * along[i];
        sum[i][1] += along[i];
        sum[i][2] += weights.weight[1][1][q] * along[i];
      } else {
        sum[i][0] += along[i];
      }
    }
  }
  // From the plain sums to those of the middle nodes.
  if constexpr (Dim == 3) {
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) sum[i][1] -= sum[i][0] + sum[i][2];
  }
#pragma GCC unroll 3
  for (int j = 0; j < across; ++j) sum[1][j] -= sum[0][j] + sum[2][j];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
    for (int j = 0; j < across; ++j) {
      alignas(64) T out[values];
      record_at<values>(out) = sum[i][j];
      for (int s = 0; s < Together; ++s)
        record_at(planes + (from + s) * plane_values<Dim> + base + arena_index<Dim>(i, j, 0)) +=
            record_at(out + s * record);
    }
}

/// The same for all scalars: together where a register holds them, so that no sum leaves its register.
template <class T, int Dim, int Scalars>
void scatter_scalars(T* planes, int base, const T* rows, const Weights<T, Dim, Quadratic>& weights, int first,
                     int count) {
  constexpr int together = fits_register<T, record * Scalars> ? Scalars : 1;
  for (int s = 0; s < Scalars; s += together)
    scatter_together<T, Dim, Scalars, together>(planes, base, rows, weights, first, count, s);
}

/// Folds what fell behind plane walls onto its mirror image: scalars are even across every wall.
template <class T, int Dim>
void fold_scalars(T* plane, const BlockView& block, const AxisBounds* bounds) {
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const PlaneWall wall = side == 0 ? bounds[a].lower : bounds[a].upper;
      const int cell = (side == 0 ? bounds[a].lower_cell : bounds[a].upper_cell - 1) - block.origin[a];
      if (wall == PlaneWall::none || cell < 0 || cell >= block_edge) continue;
      across_layers<Dim>(a, side == 0 ? cell : cell + 2, cell + 1, [&](int ghost, int image) {
        plane[image] += plane[ghost];
        plane[ghost] = T(0);
      });
    }
}

/// Copies a scalar of the nodes that a block's particles can see: `of_slot` says where those of a block of
/// nodes lie.
template <class T, int Dim, class OfSlot>
void load_scalar(const BlockView& block, OfSlot of_slot, T* plane) {
  for (int i = 0; i < arena_edge; ++i)
    for (int j = 0; j < (Dim == 3 ? arena_edge : 1); ++j)
      for (int half = 0; half < 2; ++half) {
        const int delta =
            Dim == 3 ? (i / block_edge) * 4 + (j / block_edge) * 2 + half : (i / block_edge) * 2 + half;
        const int local = Dim == 3 ? (i % block_edge * block_edge + j % block_edge) * block_edge
                                   : i % block_edge * block_edge;
        // What a row gets too much, the next one puts right.
        record_at(plane + arena_index<Dim>(i, j, half * block_edge)) =
            record_at(of_slot(block.plus[delta]) + local);
      }
}

/// Copies one average of the nodes that a block's particles can see, and mirrors it across plane walls.
template <class T, int Dim>
void load_average(const StepParameters<T>& step, const BlockView& block, const T* averages, Average which,
                  T* plane) {
  load_scalar<T, Dim>(
      block, [&](std::uint32_t slot) { return averages_of<Dim>(averages, slot, which); }, plane);
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const PlaneWall wall = side == 0 ? step.bounds[a].lower : step.bounds[a].upper;
      const int cell =
          (side == 0 ? step.bounds[a].lower_cell : step.bounds[a].upper_cell - 1) - block.origin[a];
      if (wall == PlaneWall::none || cell < 0 || cell >= block_edge) continue;
      across_layers<Dim>(a, side == 0 ? cell : cell + 2, cell + 1,
                         [&](int ghost, int image) { plane[ghost] = plane[image]; });
    }
}

/// How far plane walls of friction hold the nodes that a block's particles can see; null where no wall has
/// friction.
template <class T, int Dim>
const T* load_holds(const BlockView& block, const Grid<T>& grid, T* plane) {
  if (!grid.holds) return nullptr;
  load_scalar<T, Dim>(
      block,
      [&](std::uint32_t slot) { return grid.holds + static_cast<std::size_t>(slot) * cells_per_block<Dim>; },
      plane);
  return plane;
}

/// One scalar of a cell's nodes as differences along every axis, as CellField has records.
template <class T, int Dim>
struct CellScalar {
  static constexpr int rows = Dim == 3 ? 3 : 1;
  static_assert(record == 4);
  alignas(64) T value[3][rows][record];

  FLOWREST_INLINE explicit CellScalar(const T* plane) {
    Record<T> row[3][rows];
    constexpr Record<T> outer = {1, 0, 1, 0};
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
      for (int j = 0; j < rows; ++j) {
        const T* u = plane + arena_index<Dim>(i, j, 0);
        row[i][j] = record_at(u) - u[1] * outer;
      }
    if constexpr (Dim == 3) {
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        row[i][0] -= row[i][1];
        row[i][2] -= row[i][1];
      }
    }
#pragma GCC unroll 3
    for (int j = 0; j < rows; ++j) {
      row[0][j] -= row[1][j];
      row[2][j] -= row[1][j];
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
      for (int j = 0; j < rows; ++j) record_at(value[i][j]) = row[i][j];
  }

  template <int Bytes>
  FLOWREST_INLINE void at(const T* const* position, int q, T* out) const {
    using Factors = AxisFactors<T, Bytes, Quadratic>;
    using L = Lanes<T, Bytes>;
    const Factors x(position[0] + q), z(position[Dim - 1] + q);
    L plain[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      if constexpr (Dim == 3) {
        const Factors y(position[1] + q);
        L along[3];
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) along[j] = z.value_of(value[i][j][0], value[i][j][1], value[i][j][2]);
        plain[i] = y.value_of(along[0], along[1], along[2]);
      } else {
        plain[i] = z.value_of(value[i][0][0], value[i][0][1], value[i][0][2]);
      }
    }
    lanes_at<Bytes>(out + q) = x.value_of(plain[0], plain[1], plain[2]);
  }
};

/// Gives an average back to a tile's particles.
template <class T, int Dim>
void gather_average(const Tile<T, Dim>& tile, const T* plane, const T* const* position, T* out) {
  constexpr int lanes = lane_bytes / static_cast<int>(sizeof(T));
  constexpr int narrow = narrow_lane_bytes / static_cast<int>(sizeof(T));
  for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
    const int first = tile.cell_first(cell), end = first + tile.cell_count(cell);
    if (first == end) continue;
    const CellScalar<T, Dim> field(plane + cell_base<T, Dim>(cell));
    int q = first;
    for (; q + narrow < end; q += lanes) field.template at<lane_bytes>(position, q, out);
    if (q < end) field.template at<narrow_lane_bytes>(position, q, out);
  }
}

/// Sums one scalar of the arenas that share a block of nodes, in a fixed order.
template <class T, int Dim>
void sum_plane(const NodeView& view, const T* arenas, int scalar, T* sum) {
  constexpr int edge_j = Dim == 3 ? block_edge : 1;
  constexpr std::size_t arena_values = static_cast<std::size_t>(nodes_per_arena<Dim>) * node_values;
  for (int node = 0; node < cells_per_block<Dim>; ++node) sum[node] = T(0);
  for (int delta = 0; delta < (1 << Dim); ++delta) {
    const std::uint32_t arena = view.minus[delta];
    if (arena == no_slot) continue;
    const int di = delta >> (Dim - 1) & 1, dj = Dim == 3 ? delta >> 1 & 1 : 0, dk = delta & 1;
    const T* plane = arenas + arena * arena_values + scalar * plane_values<Dim>;
    constexpr int behind = arena_edge - block_edge;
    static_assert(behind == 2 && block_edge == record);
    const T last = dk ? T(0) : T(1);  // behind the block an arena's row has two nodes of its own
    const Record<T> own = {T(1), T(1), last, last};
    for (int i = 0; i < (di ? behind : block_edge); ++i)
      for (int j = 0; j < (dj ? behind : edge_j); ++j)
        record_at(sum + (Dim == 3 ? (i * block_edge + j) * block_edge : i * block_edge)) +=
            own *
            record_at(plane + arena_index<Dim>(i + di * block_edge, j + dj * block_edge, dk * block_edge));
  }
}

/// Volume that the nodes see, and the pressure averaged over it, from two planes of the arenas.
template <class T, int Dim>
void average_pressure(const StepParameters<T>&, const NodeView& view, const Grid<T>& grid) {
  T* volume = averages_of<Dim>(grid.averages, view.slot, Average::volume);
  T* pressure = averages_of<Dim>(grid.averages, view.slot, Average::pressure);
  sum_plane<T, Dim>(view, grid.arenas, 0, volume);
  sum_plane<T, Dim>(view, grid.arenas, 1, pressure);
  for (int node = 0; node < cells_per_block<Dim>; ++node)
    pressure[node] = volume[node] > T(0) ? pressure[node] / volume[node] : T(0);
}

/// The rate of dilatation averaged over the nodes' volume, from one plane of the arenas.
template <class T, int Dim>
void average_dilatation(const StepParameters<T>&, const NodeView& view, const Grid<T>& grid) {
  const T* volume = averages_of<Dim>(grid.averages, view.slot, Average::volume);
  T* dilatation = averages_of<Dim>(grid.averages, view.slot, Average::dilatation);
  sum_plane<T, Dim>(view, grid.arenas, 0, dilatation);
  for (int node = 0; node < cells_per_block<Dim>; ++node)
    dilatation[node] = volume[node] > T(0) ? dilatation[node] / volume[node] : T(0);
}

/// Takes up the step's averaged dilatation, and gives volume and pressure to the arena's planes. Particles
/// are in their new cells already: the nodes that one sees for the first time have no dilatation to give, and
/// a weight that grows with the square of how far it came.
template <class T, int Dim>
void update_volumes(const StepParameters<T>& step, const ParticleView<T>& particles, const BlockView& block,
                    const Grid<T>& grid, const Workspace<T>& workspace) {
  alignas(64) T dilatation[plane_values<Dim>];
  load_average<T, Dim>(step, block, grid.averages, Average::dilatation, dilatation);
  T* planes = grid.arenas + static_cast<std::size_t>(block.arena) * nodes_per_arena<Dim> * node_values;
  static_assert(2 * plane_values<Dim> <= nodes_per_arena<Dim> * node_values);
  for (int n = 0; n < 2 * plane_values<Dim>; ++n) planes[n] = T(0);
  Tile<T, Dim> tile(block, workspace);
  while (tile.next()) {
    const T* x[Dim];
    for (int a = 0; a < Dim; ++a) x[a] = tile.open(particles.position[a]);
    const T* mass = tile.open(particles.mass);
    T* ratio = tile.open(particles.volume_ratio);
    T* pressure = tile.open(particles.pressure);
    T* rate = tile.fresh();
    gather_average<T, Dim>(tile, dilatation, x, rate);
    T* volume = tile.fresh();
    T* thrust = tile.fresh();
#pragma omp simd
    for (int q = 0; q < tile.count; ++q) {
      // Yu et al. 2026, Eq. 30, to second order.
      const T d = step.step * rate[q];
      ratio[q] *= T(1) + d + T(0.5) * d * d;
      pressure[q] = step.state.at(ratio[q]).pressure;
      volume[q] = mass[q] * ratio[q];
      thrust[q] = volume[q] * pressure[q];
    }
    Weights<T, Dim, Quadratic> weights;
    weights.make(tile, x);
    const T* rows = weighted_rows<T, Dim, 2>(tile, weights, {volume, thrust});
    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell)
      if (tile.cell_count(cell) > 0)
        scatter_scalars<T, Dim, 2>(planes, cell_base<T, Dim>(cell), rows, weights, tile.cell_first(cell),
                                   tile.cell_count(cell));
  }
  for (int s = 0; s < 2; ++s) fold_scalars<T, Dim>(planes + s * plane_values<Dim>, block, step.bounds);
}

/// The pressure that acts on a block's particles, Pa.
template <class T, int Dim>
void acting_pressure(const StepParameters<T>& step, const ParticleView<T>& particles, const BlockView& block,
                     const Grid<T>& grid, const Workspace<T>& workspace, T* out) {
  alignas(64) T averaged[plane_values<Dim>];
  load_average<T, Dim>(step, block, grid.averages, Average::pressure, averaged);
  Tile<T, Dim> tile(block, workspace);
  while (tile.next()) {
    const T* x[Dim];
    for (int a = 0; a < Dim; ++a) x[a] = tile.open(particles.position[a]);
    T* pressure = tile.fresh();
    gather_average<T, Dim>(tile, averaged, x, pressure);
    for (int q = 0; q < tile.count; ++q) out[tile.first + q] = pressure[q];
  }
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
