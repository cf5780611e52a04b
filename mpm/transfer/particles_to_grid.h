#pragma once

#include "mpm/boundary/plane_walls.h"
#include "mpm/material/deviator.h"
#include "mpm/transfer/averages.h"
#include "mpm/transfer/full_cells.h"
#include "mpm/transfer/shape.h"
#include "mpm/transfer/tile.h"

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// What a tile's particles bring to the node records around them, `Values` numbers at a time: the product of
/// the axes' weights times `value`, and for every axis `term`, which takes the place of that axis' weight in
/// the product and `value`: for its first and last node what the particle brings beyond the plain weight
/// (weight and offset times the affine part, slope times the stress). Over an axis' nodes terms sum to
/// nothing, so that linear functions need one side's, that of the last node; without sides there are none.
template <class T, int Dim, int Sides, int Values>
struct Sources {
  static constexpr int arrays = 1 + Dim * Sides;
  T* memory;
  int capacity;  ///< particles

  FLOWREST_INLINE T* value(int q) const { return memory + q * Values; }
  /// Both sides of an axis lie side by side.
  FLOWREST_INLINE T* term(int axis, int side, int q) const {
    return memory + ((1 + axis * Sides) * capacity + q * Sides + side) * Values;
  }
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
FLOWREST_INLINE void sum_slab(const Sources<T, Dim, Sides, Values>& source, const Weights<T, Dim, Shape>& w,
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
    R here = record_at<Values>(source.value(q)), row[2], along[2];
    if constexpr (!plain) here *= w.weight[0][side_of<Shape>(I)][q];
    if constexpr (Sides > 0) {
      if constexpr (!plain) {
        R across[2];
        for (int side = 0; side < Sides; ++side) across[side] = record_at<Values>(source.term(0, side, q));
        add_term<T, Sides, Values>(here, across, side_of<Shape>(I));
      }
#pragma GCC unroll 2
      for (int side = 0; side < Sides; ++side) {
        if constexpr (Dim == 3) {
          row[side] = record_at<Values>(source.term(1, side, q));
          if constexpr (!plain) row[side] *= w.weight[0][side_of<Shape>(I)][q];
        }
        along[side] = record_at<Values>(source.term(last, side, q));
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

/// Adds the particles [first, first + count) of a tile, all of one cell, to that cell's nodes: all three
/// slabs of quadratic functions at once, where a register holds two records, those of the last axis' first
/// and last node: every source is read once, and all sums stay in registers.
template <class T, int Dim, int Values>
void scatter_in_pairs(T* arena_cell, const Sources<T, Dim, 2, Values>& source,
                      const Weights<T, Dim, Quadratic>& w, int first, int count) {
  constexpr int rows = Dim == 3 ? 3 : 1, last = Dim - 1;
  using Pair = Record<T, 2 * Values>;
  Pair plain[3][rows], outer[3][rows];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
    for (int j = 0; j < rows; ++j) plain[i][j] = outer[i][j] = Pair{};
  for (int q = first; q < first + count; ++q) {
    const Pair ends = pair_of<T>(w.weight[last][0][q], w.weight[last][1][q]);
    const Pair value = twice<T>(record_at<Values>(source.value(q)));
    const Pair along = record_at<2 * Values>(source.term(last, 0, q));
    Pair row[2] = {};
    if constexpr (Dim == 3)
      for (int side = 0; side < 2; ++side) row[side] = twice<T>(record_at<Values>(source.term(1, side, q)));
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      Pair here = value, here_row[2] = {row[0], row[1]}, here_along = along;
      if (!is_plain<Quadratic>(i)) {
        const T wi = w.weight[0][side_of<Quadratic>(i)][q];
        here *= wi;
        here += twice<T>(record_at<Values>(source.term(0, side_of<Quadratic>(i), q)));
        here_along *= wi;
        if constexpr (Dim == 3)
          for (int side = 0; side < 2; ++side) here_row[side] *= wi;
      }
#pragma GCC unroll 3
      for (int j = 0; j < rows; ++j) {
        Pair line = here, line_along = here_along;
        if (Dim == 3 && !is_plain<Quadratic>(j)) {
          const T wj = w.weight[1][side_of<Quadratic>(j)][q];
          line *= wj;
          line += here_row[side_of<Quadratic>(j)];
          line_along *= wj;
        }
        plain[i][j] += line;
        outer[i][j] += ends * line;
        outer[i][j] += line_along;
      }
    }
  }
  // From the plain sums to those of the middle nodes.
  if constexpr (Dim == 3) {
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      plain[i][1] -= plain[i][0] + plain[i][2];
      outer[i][1] -= outer[i][0] + outer[i][2];
    }
  }
#pragma GCC unroll 3
  for (int j = 0; j < rows; ++j) {
    plain[1][j] -= plain[0][j] + plain[2][j];
    outer[1][j] -= outer[0][j] + outer[2][j];
  }
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
    for (int j = 0; j < rows; ++j) {
      const auto low = half_of<T>(outer[i][j], 0), high = half_of<T>(outer[i][j], 1);
      T* to = arena_cell + arena_index<Dim>(i, j, 0) * node_values;
      record_at<Values>(to) += low;
      record_at<Values>(to + node_values) += half_of<T>(plain[i][j], 0) - (low + high);
      record_at<Values>(to + 2 * node_values) += high;
    }
}

/// The same slab by slab.
template <class T, int Dim, class Shape, int Sides, int Values>
void scatter_in_slabs(T* arena_cell, const Sources<T, Dim, Sides, Values>& source,
                      const Weights<T, Dim, Shape>& w, int first, int count) {
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

/// Adds the particles [first, first + count) of a tile, all of one cell, to that cell's nodes.
template <class T, int Dim, class Shape, int Sides, int Values>
void scatter(T* arena_cell, const Sources<T, Dim, Sides, Values>& source, const Weights<T, Dim, Shape>& w,
             int first, int count) {
  if constexpr (Sides == 2 && fits_register<T, 2 * Values>) {
    scatter_in_pairs<T, Dim, Values>(arena_cell, source, w, first, count);
  } else {
    scatter_in_slabs<T, Dim, Shape, Sides, Values>(arena_cell, source, w, first, count);
  }
}

/// Mass, momentum, volume and the impulse of the step's forces of one block's particles, into that block's
/// arena: per node (mass, momentum) and (filling, impulse).
template <class T, int Dim, bool Axisymmetric, class Shape>
void particles_to_grid(const StepParameters<T>& step, const ParticleView<T>& particles,
                       const BlockView& block, const Grid<T>& grid, const Workspace<T>& workspace) {
  constexpr bool affine = Shape::nodes == 3;  // the quadratic functions carry APIC's affine part
  constexpr int arena_values = nodes_per_arena<Dim> * node_values;
  constexpr int sides = term_sides<Shape>;
  using TileSources = Sources<T, Dim, sides, node_values>;
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
    Weights<T, Dim, Shape> weights;
    weights.make(tile, x);

    T* volume = tile.fresh();
    T* pressure = tile.fresh();
    const T per_density = T(1) / step.density;
#pragma omp simd
    for (int q = 0; q < count; ++q) volume[q] = mass[q] * ratio[q] * per_density;
    const bool centroid = step.dilatation == Dilatation::centroid;
    if (smooth) {
      gather_average<T, Dim>(tile, averaged, x, pressure);
    } else {
      const T* raw_pressure = tile.open(particles.pressure);
      for (int q = 0; q < count; ++q) pressure[q] = raw_pressure[q];
      if (!centroid) average_over_cells(tile, volume, pressure);
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

    // Each is read whole, broadcast over a cell's nodes. They take the workspace's rest.
    const TileSources sources{tile.memory + tile.capacity * tile.used, tile.capacity};
    static_assert(TileSources::arrays * node_values + 40 <= workspace_arrays);
    const T circle = Axisymmetric ? T(6.283185307179586) : T(1);  // particles carry whole rings
    const T per_cell_volume = T(1) / (circle * cell_volume);
    using R = Record<T>;
    // Four particles at a time; those past the tile's end are rubbish that nothing reads.
    for (int q = 0; q < count; q += record) {
      const R none = {}, m = record_at(mass + q), volumes = record_at(volume + q);
      const R p = centroid ? none : record_at(pressure + q);
      const R xx = record_at(deviator[0] + q), yy = record_at(deviator[1] + q),
              xy = record_at(deviator[2] + q);
      R filling = volumes * per_cell_volume, hoop = none;
      if constexpr (Axisymmetric) {
        const R per_radii = record_at(per_radius + q);
        filling *= per_radii;
        hoop = volumes * dt * (xx + yy + p) * per_radii;
      }
      using Four = FourRecords<T>;
      const Four value(m, m * record_at(v[0] + q), m * record_at(v[1] + q),
                       Dim == 3 ? m * record_at(v[Dim - 1] + q) : none);
      Four::write_pairs(sources.value(q), node_values, value, Four(filling, hoop, none, none));
      R stress[Dim][Dim];
      stress[0][0] = xx - p;
      stress[1][1] = yy - p;
      stress[0][1] = stress[1][0] = xy;
      if constexpr (Dim == 3) {
        stress[0][2] = stress[2][0] = record_at(deviator[3] + q);
        stress[1][2] = stress[2][1] = record_at(deviator[4] + q);
        stress[2][2] = -(xx + yy) - p;
      }
#pragma GCC unroll 3
      for (int a = 0; a < Dim; ++a) {
        const Four stresses(none, stress[a][0], stress[a][1], Dim == 3 ? stress[a][Dim - 1] : none);
        const auto own_of = [&](int c) { return affine ? record_at(own[c][a] + q) : none; };
        const Four slants(none, own_of(0), own_of(1), Dim == 3 ? own_of(Dim - 1) : none);
#pragma GCC unroll 2
        for (int side = 0; side < sides; ++side)
          Four::write_pairs(sources.term(a, side, q), sides * node_values,
                            affine ? slants.times(slant[a][side] + q) : slants,
                            stresses.times(push[a][side] + q));
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
