#pragma once

#include "mpm/boundary/plane_walls.h"
#include "mpm/material/deviator.h"
#include "mpm/transfer/averages.h"
#include "mpm/transfer/full_cells.h"
#include "mpm/transfer/shape.h"
#include "mpm/transfer/tile.h"

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// One particle's contribution to the node records around it: the product of the axes' weights times
/// `value`, and for every axis `term`, which takes the place of that axis' weight in the product and `value`:
/// for its first and last node what the particle brings beyond the plain weight (weight and offset times the
/// affine part, slope times the stress). Over an axis' nodes terms sum to nothing, so that linear functions
/// need one side's, that of the last node; without sides there are none.
template <class T, int Dim, int Sides, int Values>
struct Source {
  T value[Values];
  T term[Dim][Sides][Values];
};
template <class T, int Dim, int Values>
struct Source<T, Dim, 0, Values> {
  T value[Values];
};
template <class Shape>
constexpr int term_sides = Shape::nodes - 1;

/// Adds an axis' term for the node on a side. The types are given, not deduced: a deduced record would lose
/// its alignment, that of a number, and be taken to lie where a whole register may be loaded.
template <class T, int Sides, int Values>
FLOWREST_INLINE void add_term(Record<T, Values>& sum, const Record<T, Values> (&term)[2], int side) {
  if (Sides == 2) {
    sum += term[side];
  } else if (side == 1) {
    sum += term[0];
  } else {
    sum -= term[0];
  }
}

/// A slab of a cell's nodes across the first axis, as sums over the particles: of the plain contribution, of
/// those with the first and the last node's weight along each axis.
template <class T, int Dim, class Shape, int Values>
struct Slab {
  static constexpr int nodes = Shape::nodes;
  static constexpr int rows = Dim == 3 ? nodes : 1;
  using R = Record<T, Values>;
  R sum[rows][nodes];
};

/// Which of an axis' two outer nodes a function belongs to; quadratic functions have a plain one in between.
template <class Shape>
constexpr bool is_plain(int function) {
  return Shape::nodes == 3 && function == 1;
}
template <class Shape>
constexpr int side_of(int function) {
  return function == 0 ? 0 : 1;
}

/// Sums one slab, that of function `I` of the first axis, over the particles [first, first + count) of a
/// cell. The sums stay in registers.
template <class T, int Dim, class Shape, int Sides, int Values, int I>
FLOWREST_INLINE void sum_slab(const Source<T, Dim, Sides, Values>* source, const Weights<T, Dim, Shape>& w,
                              int first, int count, Slab<T, Dim, Shape, Values>& slab) {
  constexpr int nodes = Shape::nodes, rows = slab.rows, last = Dim - 1;
  constexpr bool plain = is_plain<Shape>(I);
  using R = Record<T, Values>;
  R sum[rows][nodes];
#pragma GCC unroll 3
  for (int j = 0; j < rows; ++j)
#pragma GCC unroll 3
    for (int k = 0; k < nodes; ++k) sum[j][k] = R{};
  for (int q = first; q < first + count; ++q) {
    const auto& s = source[q];
    R here = record_at<Values>(s.value), row[2], along[2];
    if constexpr (!plain) here *= w.weight[0][side_of<Shape>(I)][q];
    if constexpr (Sides > 0) {
      if constexpr (!plain) {
        R across[2];
        for (int side = 0; side < Sides; ++side) across[side] = record_at<Values>(s.term[0][side]);
        add_term<T, Sides, Values>(here, across, side_of<Shape>(I));
      }
#pragma GCC unroll 2
      for (int side = 0; side < Sides; ++side) {
        if constexpr (Dim == 3) {
          row[side] = record_at<Values>(s.term[1][side]);
          if constexpr (!plain) row[side] *= w.weight[0][side_of<Shape>(I)][q];
        }
        along[side] = record_at<Values>(s.term[last][side]);
        if constexpr (!plain) along[side] *= w.weight[0][side_of<Shape>(I)][q];
      }
    }
#pragma GCC unroll 3
    for (int j = 0; j < rows; ++j) {
      R line = here, line_along[2];
      if constexpr (Sides > 0)
        for (int side = 0; side < Sides; ++side) line_along[side] = along[side];
      if (Dim == 3 && !is_plain<Shape>(j)) {
        const T wj = w.weight[1][side_of<Shape>(j)][q];
        line *= wj;
        if constexpr (Sides > 0) {
          add_term<T, Sides, Values>(line, row, side_of<Shape>(j));
          for (int side = 0; side < Sides; ++side) line_along[side] *= wj;
        }
      }
#pragma GCC unroll 3
      for (int k = 0; k < nodes; ++k) {
        if (is_plain<Shape>(k)) {
          sum[j][k] += line;
        } else {
          sum[j][k] += w.weight[last][side_of<Shape>(k)][q] * line;
          if constexpr (Sides > 0) add_term<T, Sides, Values>(sum[j][k], line_along, side_of<Shape>(k));
        }
      }
    }
  }
  // From the plain sums to those of the middle nodes.
  if constexpr (nodes == 3) {
#pragma GCC unroll 3
    for (int j = 0; j < rows; ++j) sum[j][1] -= sum[j][0] + sum[j][2];
    if constexpr (Dim == 3) {
#pragma GCC unroll 3
      for (int k = 0; k < nodes; ++k) sum[1][k] -= sum[0][k] + sum[2][k];
    }
  }
#pragma GCC unroll 3
  for (int j = 0; j < rows; ++j)
#pragma GCC unroll 3
    for (int k = 0; k < nodes; ++k) slab.sum[j][k] = sum[j][k];
}

/// Adds the particles [first, first + count) of a tile, all of one cell, to that cell's nodes.
template <class T, int Dim, class Shape, int Sides, int Values>
void scatter(T* arena_cell, const Source<T, Dim, Sides, Values>* source, const Weights<T, Dim, Shape>& w,
             int first, int count) {
  constexpr int nodes = Shape::nodes;
  Slab<T, Dim, Shape, Values> slabs[nodes];
  sum_slab<T, Dim, Shape, Sides, Values, 0>(source, w, first, count, slabs[0]);
  sum_slab<T, Dim, Shape, Sides, Values, 1>(source, w, first, count, slabs[1]);
  if constexpr (nodes == 3) sum_slab<T, Dim, Shape, Sides, Values, 2>(source, w, first, count, slabs[2]);
#pragma GCC unroll 3
  for (int j = 0; j < slabs[0].rows; ++j)
#pragma GCC unroll 3
    for (int k = 0; k < nodes; ++k) {
      if constexpr (nodes == 3) slabs[1].sum[j][k] -= slabs[0].sum[j][k] + slabs[2].sum[j][k];
#pragma GCC unroll 3
      for (int i = 0; i < nodes; ++i)
        record_at<Values>(arena_cell + arena_index<Dim>(i, j, k) * node_values) += slabs[i].sum[j][k];
    }
}

template <class T>
FLOWREST_INLINE void set_rows(Record<T> (&rows)[4], const Record<T>& a, const Record<T>& b,
                              const Record<T>& c, const Record<T>& d) {
  rows[0] = a;
  rows[1] = b;
  rows[2] = c;
  rows[3] = d;
}

/// Mass, momentum, volume and the impulse of the step's forces of one block's particles, into that block's
/// arena: per node (mass, momentum) and (filling, impulse).
template <class T, int Dim, bool Axisymmetric, class Shape>
void particles_to_grid(const StepParameters<T>& step, const ParticleView<T>& particles,
                       const BlockView& block, const Grid<T>& grid, const Workspace<T>& workspace) {
  constexpr bool affine = Shape::nodes == 3;  // the quadratic functions carry APIC's affine part
  constexpr int arena_values = nodes_per_arena<Dim> * node_values;
  constexpr int sides = term_sides<Shape>;
  using Sources = Source<T, Dim, sides, node_values>;
  T* arena = grid.arenas + static_cast<std::size_t>(block.arena) * arena_values;
  for (int i = 0; i < arena_values; ++i) arena[i] = T(0);

  const bool smooth = Shape::nodes == 3 && step.dilatation == Dilatation::smooth;
  alignas(64) T averaged[plane_values<Dim>];
  if (smooth) load_average<T, Dim>(step, block, grid.averages, Average::pressure, averaged);

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
    if (smooth) {
      gather_average<T, Dim>(tile, averaged, x, pressure);
    } else if (!centroid) {
      average_over_cells(tile, volume, pressure);
    }

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

    // What an axis' first and last node (linear: the last) take of a particle's affine part and of its
    // stress.
    const T dt = step.step, impulse_per_cell = dt / step.cell;
    T *slant[Dim][2], *push[Dim][2];
    for (int a = 0; a < Dim; ++a)
      for (int side = 0; side < sides; ++side) {
        const int node = outer_node<Shape>(side + 2 - sides);
        T* const to_push = push[a][side] = tile.fresh();
        T* const to_slant = slant[a][side] = affine ? tile.fresh() : nullptr;
#pragma omp simd
        for (int q = 0; q < count; ++q) {
          to_push[q] = -volume[q] * impulse_per_cell * Shape::slope(node, x[a][q]);
          if constexpr (affine)
            to_slant[q] = mass[q] * weights.weight[a][side][q] * Shape::offset(node, x[a][q]);
        }
      }

    const T *v[Dim], *deviator[Deviator<T, Dim>::components], *own[Dim][Dim];
    for (int c = 0; c < Dim; ++c) v[c] = tile.open(particles.velocity[c]);
    for (int c = 0; c < Deviator<T, Dim>::components; ++c) deviator[c] = tile.open(particles.deviator[c]);
    for (int c = 0; c < Dim; ++c)
      for (int a = 0; a < Dim; ++a) own[c][a] = affine ? tile.open(particles.affine[c * Dim + a]) : nullptr;
    const T cell_volume = (Dim == 3 ? step.cell : T(1)) * step.cell * step.cell;
    if (step.full_cells) weigh_in_full_cells<T, Dim>(step, tile, x, volume, cell_volume, deviator);

    // Sources are an array of structures: each is read whole, broadcast over a cell's nodes. They take the
    // workspace's rest.
    Sources* sources = reinterpret_cast<Sources*>(tile.memory + tile.capacity * tile.used);
    static_assert(static_cast<int>(sizeof(Sources) / sizeof(T)) + 40 <= workspace_arrays);
    const T circle = Axisymmetric ? T(6.283185307179586) : T(1);  // particles carry whole rings
    const T per_cell_volume = T(1) / (circle * cell_volume);
    using R = Record<T>;
    // Four particles at a time; those past the tile's end are rubbish that nothing reads.
    for (int q = 0; q < count; q += record) {
      const R none = {}, m = record_at(mass + q), volumes = record_at(volume + q);
      const R p = centroid ? none : record_at(pressure + q);
      const R xx = record_at(deviator[0] + q), yy = record_at(deviator[1] + q),
              xy = record_at(deviator[2] + q);
      R value[4] = {m, m * record_at(v[0] + q), m * record_at(v[1] + q), none};
      R forcing[4] = {volumes * per_cell_volume, none, none, none};
      R stress[Dim][4];
      if constexpr (Dim == 3) {
        const R xz = record_at(deviator[3] + q), yz = record_at(deviator[4] + q);
        value[3] = m * record_at(v[2] + q);
        set_rows<T>(stress[0], none, xx - p, xy, xz);
        set_rows<T>(stress[1], none, xy, yy - p, yz);
        set_rows<T>(stress[2], none, xz, yz, -(xx + yy) - p);
      } else {
        set_rows<T>(stress[0], none, xx - p, xy, none);
        set_rows<T>(stress[1], none, xy, yy - p, none);
      }
      if constexpr (Axisymmetric) {
        const R per_radii = record_at(per_radius + q);
        forcing[0] *= per_radii;
        forcing[1] = volumes * dt * (xx + yy + p) * per_radii;  // of the hoop stress
      }
      transpose<T>(value);
      transpose<T>(forcing);
      for (int n = 0; n < record; ++n) {
        record_at(sources[q + n].value) = value[n];
        record_at(sources[q + n].value + record) = forcing[n];
      }
#pragma GCC unroll 3
      for (int a = 0; a < Dim; ++a) {
        transpose<T>(stress[a]);
        R slants[4] = {none, none, none, none};
        if constexpr (affine) {
          slants[1] = record_at(own[0][a] + q);
          slants[2] = record_at(own[1][a] + q);
          if constexpr (Dim == 3) slants[3] = record_at(own[2][a] + q);
          transpose<T>(slants);
        }
#pragma GCC unroll 2
        for (int side = 0; side < sides; ++side)
#pragma GCC unroll 4
          for (int n = 0; n < record; ++n) {
            T* const term = sources[q + n].term[a][side];
            record_at(term + record) = push[a][side][q + n] * stress[a][n];
            record_at(term) = affine ? slant[a][side][q + n] * slants[n] : none;
          }
      }
    }

    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
      const int n = tile.cell_count(cell);
      if (n == 0) continue;
      const int first = tile.cell_first(cell);
      T* base = arena + cell_base<T, Dim>(cell) * node_values;
      scatter<T, Dim, Shape, sides>(base, sources, weights, first, n);
      if (centroid) {
        // B-bar at the centroid: the pressure's work is done by the divergence at the cell's centre alone.
        T thrust = T(0);
        for (int q = first; q < first + n; ++q) thrust += volume[q] * pressure[q];
        const T hoop = Axisymmetric ? thrust * dt / (step.cell * (radial[first] + T(0.5))) : T(0);
        const T along = thrust * impulse_per_cell;
        for (int i = 0; i < Shape::nodes; ++i)
          for (int j = 0; j < (Dim == 3 ? Shape::nodes : 1); ++j)
            for (int k = 0; k < Shape::nodes; ++k) {
              const T half = T(0.5);
              const T wi = Shape::weight(i, half), wj = Dim == 3 ? Shape::weight(j, half) : T(1),
                      wk = Shape::weight(k, half);
              T* to = base + arena_index<Dim>(i, j, k) * node_values + record + 1;
              to[0] += along * Shape::slope(i, half) * wj * wk + hoop * wi * wj * wk;
              if constexpr (Dim == 3) to[1] += along * wi * Shape::slope(j, half) * wk;
              to[Dim - 1] += along * wi * wj * Shape::slope(k, half);
            }
      }
    }
  }
  // Gravity: every node falls as its mass does.
  const Record<T> fall = {T(0), step.step * step.acceleration[0], step.step * step.acceleration[1],
                          step.step * step.acceleration[2]};
  for (int node = 0; node < arena_values; node += node_values)
    record_at(arena + node + record) += arena[node] * fall;
  if constexpr (Shape::nodes == 3) fold_ghosts<T, Dim>(arena, block, step.bounds);
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
