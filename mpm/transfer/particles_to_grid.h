#pragma once

#include "mpm/boundary/plane_walls.h"
#include "mpm/material/deviator.h"
#include "mpm/transfer/shape.h"
#include "mpm/transfer/tile.h"

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// One particle's contribution to the node records around it, the product of the axes' weights times
/// value + sum over the axes of term / weight: `term[a][n]` holds what axis a's node n brings beyond the
/// plain weight (its offset times the affine part, its slope times the stress).
template <class T, int Dim, class Shape, bool Terms, int Values>
struct Source {
  T value[Values];
  T term[Terms ? Dim : 1][Terms ? Shape::nodes : 1][Values];
};

/// Adds the particles [first, first + count) of a tile, all of one cell, to that cell's nodes. The
/// accumulators of a slab of nodes stay in registers over the particles.
template <class T, int Dim, class Shape, bool Terms, int Values>
void scatter(T* arena_cell, int node_stride, const Source<T, Dim, Shape, Terms, Values>* source,
             const Weights<T, Dim, Shape>& w, int first, int count) {
  constexpr int nodes = Shape::nodes;
  constexpr int rows = Dim == 3 ? nodes : 1;
  constexpr int last = Dim - 1;
  using R = Record<T, Values>;
  const R zero = {};
  for (int i = 0; i < nodes; ++i) {
    R sum[rows][nodes];
#pragma GCC unroll 9
    for (int j = 0; j < rows; ++j)
#pragma GCC unroll 9
      for (int k = 0; k < nodes; ++k) sum[j][k] = zero;
    for (int q = first; q < first + count; ++q) {
      const auto& s = source[q];
      const T wi = w.weight[0][i][q];
#pragma GCC unroll 9
      for (int j = 0; j < rows; ++j) {
        T wij = wi;
        R plane;
        if constexpr (Dim == 3) {
          const T wj = w.weight[1][j][q];
          wij = wi * wj;
          plane = wij * record_at<Values>(s.value);
          if constexpr (Terms)
            plane += wj * record_at<Values>(s.term[0][i]) + wi * record_at<Values>(s.term[1][j]);
        } else {
          plane = wij * record_at<Values>(s.value);
          if constexpr (Terms) plane += record_at<Values>(s.term[0][i]);
        }
#pragma GCC unroll 9
        for (int k = 0; k < nodes; ++k) {
          sum[j][k] += w.weight[last][k][q] * plane;
          if constexpr (Terms) sum[j][k] += wij * record_at<Values>(s.term[last][k]);
        }
      }
    }
#pragma GCC unroll 9
    for (int j = 0; j < rows; ++j)
#pragma GCC unroll 9
      for (int k = 0; k < nodes; ++k)
        record_at<Values>(arena_cell + arena_index<Dim>(i, j, k) * node_stride) += sum[j][k];
  }
}

/// Mass, momentum, volume and the impulse of the step's forces of one block's particles, into that block's
/// arena: per node (mass, momentum) and (filling, impulse).
template <class T, int Dim, bool Axisymmetric, class Shape>
void particles_to_grid(const StepParameters<T>& step, const ParticleView<T>& particles,
                       const BlockView& block, T* arenas, const T* /*nodes*/, const Workspace<T>& workspace) {
  constexpr bool affine = Shape::nodes == 3;  // the quadratic functions carry APIC's affine part
  constexpr int arena_values = nodes_per_arena<Dim> * node_values;
  using Sources = Source<T, Dim, Shape, true, node_values>;
  T* arena = arenas + static_cast<std::size_t>(block.slot) * arena_values;
  for (int i = 0; i < arena_values; ++i) arena[i] = T(0);

  Tile<T, Dim> tile(block, workspace);
  while (tile.next()) {
    const int count = tile.count;
    T* x[Dim];
    for (int a = 0; a < Dim; ++a) x[a] = tile.open(particles.position[a]);
    const T* mass = tile.open(particles.mass);
    const T* ratio = tile.open(particles.volume_ratio);
    const T* raw_pressure = tile.open(particles.pressure);
    Weights<T, Dim, Shape> weights;
    weights.make(tile, x);

    T* volume = tile.fresh();
    T* pressure = tile.fresh();
    const T per_density = T(1) / step.density;
#pragma omp simd
    for (int q = 0; q < count; ++q) {
      volume[q] = mass[q] * ratio[q] * per_density;
      pressure[q] = raw_pressure[q];
    }
    const bool centroid = step.dilatation == Dilatation::centroid;
    if (!centroid) average_over_cells(tile, volume, pressure);

    T* per_radius = nullptr;
    T* radial = nullptr;
    if constexpr (Axisymmetric) {
      radial = tile.fresh();
      per_radius = tile.fresh();
      radial_cells(tile, radial);
#pragma omp simd
      for (int q = 0; q < count; ++q)
        per_radius[q] = T(1) / (step.cell * maximum(radial[q] + x[0][q], T(1e-6)));
    }

    // Sources are an array of structures: each is read whole, broadcast over a cell's nodes. They take the
    // workspace's rest, and what only they need is read from the particles' arrays straight away.
    Sources* sources = reinterpret_cast<Sources*>(tile.memory + tile.capacity * tile.used);
    static_assert(static_cast<int>(sizeof(Sources) / sizeof(T)) + 30 <= workspace_arrays);
    const T dt = step.step, impulse_per_cell = dt / step.cell;
    const T circle = Axisymmetric ? T(6.283185307179586) : T(1);  // particles carry whole rings
    const T per_cell_volume = T(1) / (circle * (Dim == 3 ? step.cell : T(1)) * step.cell * step.cell);
    const std::uint32_t* list = block.list + tile.first;
    for (int q = 0; q < count; ++q) {
      const std::uint32_t id = list[q];
      Deviator<T, Dim> dev;
      if constexpr (Dim == 2) {
        dev = {particles.deviator[0][id], particles.deviator[1][id], particles.deviator[2][id]};
      } else {
        dev = {particles.deviator[0][id], particles.deviator[1][id], particles.deviator[2][id],
               particles.deviator[3][id], particles.deviator[4][id]};
      }
      const T p = centroid ? T(0) : pressure[q];
      const T m = mass[q], scale = -volume[q] * impulse_per_cell;
      Record<T> forcing = {volume[q] * per_cell_volume, m * dt * step.acceleration[0],
                           m * dt * step.acceleration[1], Dim == 3 ? m * dt * step.acceleration[2] : T(0)};
      if constexpr (Axisymmetric) {
        forcing[0] *= per_radius[q];
        forcing[1] -= volume[q] * dt * (dev.zz() - p) * per_radius[q];
      }
      Sources& source = sources[q];
      record_at(source.value) = Record<T>{m, m * particles.velocity[0][id], m * particles.velocity[1][id],
                                          Dim == 3 ? m * particles.velocity[Dim - 1][id] : T(0)};
      record_at(source.value + record) = forcing;
      Record<T> stress[Dim];
      if constexpr (Dim == 3) {
        stress[0] = Record<T>{T(0), scale * (dev.xx - p), scale * dev.xy, scale * dev.xz};
        stress[1] = Record<T>{T(0), scale * dev.xy, scale * (dev.yy - p), scale * dev.yz};
        stress[2] = Record<T>{T(0), scale * dev.xz, scale * dev.yz, scale * (dev.zz() - p)};
      } else {
        stress[0] = Record<T>{T(0), scale * (dev.xx - p), scale * dev.xy, T(0)};
        stress[1] = Record<T>{T(0), scale * dev.xy, scale * (dev.yy - p), T(0)};
      }
      for (int a = 0; a < Dim; ++a) {
        for (int n = 0; n < Shape::nodes; ++n)
          record_at(source.term[a][n] + record) = weights.slope[a][n][q] * stress[a];
        if constexpr (affine) {
          const Record<T> slant = {T(0), m * particles.affine[a][id], m * particles.affine[Dim + a][id],
                                   Dim == 3 ? m * particles.affine[(Dim - 1) * Dim + a][id] : T(0)};
          for (int n = 0; n < Shape::nodes; ++n)
            record_at(source.term[a][n]) = (weights.weight[a][n][q] * Shape::offset(n, x[a][q])) * slant;
        } else {
          for (int n = 0; n < Shape::nodes; ++n) record_at(source.term[a][n]) = Record<T>{};
        }
      }
    }

    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
      const int n = tile.cell_count(cell);
      if (n == 0) continue;
      const int first = tile.cell_first(cell);
      T* base = arena + cell_base<T, Dim>(cell) * node_values;
      scatter<T, Dim, Shape, true>(base, node_values, sources, weights, first, n);
      if (centroid) {
        // B-bar at the centroid: the pressure's work is done by the divergence at the cell's centre alone.
        T thrust = T(0);
        for (int q = first; q < first + n; ++q) thrust += volume[q] * pressure[q];
        const T hoop = Axisymmetric ? thrust * dt / (step.cell * (radial[first] + T(0.5))) : T(0);
        const T push = thrust * impulse_per_cell;
        for (int i = 0; i < Shape::nodes; ++i)
          for (int j = 0; j < (Dim == 3 ? Shape::nodes : 1); ++j)
            for (int k = 0; k < Shape::nodes; ++k) {
              const T half = T(0.5);
              const T wi = Shape::weight(i, half), wj = Dim == 3 ? Shape::weight(j, half) : T(1),
                      wk = Shape::weight(k, half);
              T* to = base + arena_index<Dim>(i, j, k) * node_values + record + 1;
              to[0] += push * Shape::slope(i, half) * wj * wk + hoop * wi * wj * wk;
              if constexpr (Dim == 3) to[1] += push * wi * Shape::slope(j, half) * wk;
              to[Dim - 1] += push * wi * wj * Shape::slope(k, half);
            }
      }
    }
  }
  if constexpr (Shape::nodes == 3) fold_ghosts<T, Dim>(arena, block, step.bounds);
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
