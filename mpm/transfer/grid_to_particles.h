#pragma once

#include "mpm/boundary/keep_out.h"
#include "mpm/material/stress_update.h"
#include "mpm/transfer/filling.h"
#include "mpm/transfer/gather.h"
#include "mpm/transfer/nodes.h"
#include "mpm/transfer/particles_to_grid.h"

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Divergence at the cells' centres, given to all their particles: the published B-bar (Yu et al. 2026,
/// section 4).
template <class T, int Dim, bool Axisymmetric, class Shape>
void centroid_dilatation(const StepParameters<T>& step, const Tile<T, Dim>& tile, const T* arena,
                         const T* radial, T* dilatation) {
  const T half = T(0.5), per_cell = T(1) / step.cell;
  for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
    const int n = tile.cell_count(cell), first = tile.cell_first(cell);
    if (n == 0) continue;
    const T* base = arena + cell_base<T, Dim>(cell) * node_values + 1;
    T divergence = T(0), radial_velocity = T(0);
    for (int i = 0; i < Shape::nodes; ++i)
      for (int j = 0; j < (Dim == 3 ? Shape::nodes : 1); ++j)
        for (int k = 0; k < Shape::nodes; ++k) {
          const T* v = base + arena_index<Dim>(i, j, k) * node_values;
          const T wi = Shape::weight(i, half), wj = Dim == 3 ? Shape::weight(j, half) : T(1),
                  wk = Shape::weight(k, half);
          divergence += v[0] * Shape::slope(i, half) * wj * wk + v[Dim - 1] * wi * wj * Shape::slope(k, half);
          if constexpr (Dim == 3) divergence += v[1] * wi * Shape::slope(j, half) * wk;
          if constexpr (Axisymmetric) radial_velocity += v[0] * wi * wk;
        }
    divergence *= per_cell;
    if constexpr (Axisymmetric) divergence += radial_velocity * per_cell / (radial[first] + half);
    for (int q = first; q < first + n; ++q) dilatation[q] = divergence;
  }
}

/// Refers a step's velocity gradients to the body in the middle of the step, L (I + dt L / 2)^-1 to second
/// order: a motion x + dt v stretches by dt L and by half its square, which turns a spinning body into a
/// growing one unless the strain says so (Hughes and Winget 1980, Eq. 5).
template <class T, int Dim, bool Axisymmetric>
void refer_to_midpoint(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  const T half = T(0.5) * step.step;
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    const VelocityGradient<T, Dim> l = gradient_of(s, q, Axisymmetric);
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) {
        T square = T(0);
        for (int k = 0; k < Dim; ++k) square += l.g[i][k] * l.g[k][j];
        s.gradient[i][j][q] = l.g[i][j] - half * square;
      }
    if constexpr (Axisymmetric) s.hoop[q] = l.hoop - half * l.hoop * l.hoop;
  }
}

/// Gives a tile's rate of dilatation to the nodes, which average it, and leaves none for now: update_volumes
/// takes it up.
template <class T, int Dim>
void give_dilatation(Tile<T, Dim>& tile, const T* const* x, const T* volume, T* dilatation, T* plane) {
  T* growth = tile.fresh();
#pragma omp simd
  for (int q = 0; q < tile.count; ++q) {
    growth[q] = volume[q] * dilatation[q];
    dilatation[q] = T(0);
  }
  Weights<T, Dim, Quadratic> weights;
  weights.make(tile, x);
  const T* rows = weighted_rows<T, Dim, 1>(tile, weights, {growth});
  for (int cell = tile.first_cell; cell < tile.last_cell; ++cell)
    if (tile.cell_count(cell) > 0)
      scatter_scalars<T, Dim, 1>(plane, cell_base<T, Dim>(cell), rows, weights, tile.cell_first(cell),
                                 tile.cell_count(cell));
}

/// Strain and averaged dilatation of a tile from its velocity gradients. `holds` are those of walls of
/// friction (load_holds). `planes` of the block's arena, where not null, take the dilatation (smooth B-bar).
template <class T, int Dim, bool Axisymmetric, class Shape>
void make_strain(const StepParameters<T>& step, Tile<T, Dim>& tile, const T* arena, const T* holds,
                 const T* const* x, const Gathered<T, Dim>& gathered, const T* mass, const T* filling,
                 T* planes, Strain<T, Dim>& s) {
  const int count = tile.count;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) s.gradient[i][j] = gathered.gradient[i][j];
  s.dilatation = tile.fresh();
  s.hoop = nullptr;
  T* radial = nullptr;
  if constexpr (Axisymmetric) {
    s.hoop = tile.fresh();
    radial = tile.fresh();
    radial_cells(tile, radial);
    const T* radial_velocity = gathered.value[0];
#pragma omp simd
    for (int q = 0; q < count; ++q)
      s.hoop[q] = radial_velocity[q] / (step.cell * maximum(radial[q] + x[0][q], T(1e-6)));
  }
  if (step.stress_rate == StressRate::hughes_winget) refer_to_midpoint<T, Dim, Axisymmetric>(step, s, count);
  if (step.dilatation == Dilatation::centroid) {
    centroid_dilatation<T, Dim, Axisymmetric, Shape>(step, tile, arena, radial, s.dilatation);
    return;
  }
  T* volume = tile.fresh();
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    volume[q] = mass[q] * s.ratio[q];
    s.dilatation[q] = gradient_of(s, q, Axisymmetric).divergence();
  }
  if (filling)
    heed_filling<T, Dim>(step, s, filling, covered_beside_walls<T, Dim, Shape>(step, tile, arena, holds, x),
                         count);
  if (planes) {
    give_dilatation<T, Dim>(tile, x, volume, s.dilatation, planes);
  } else {
    average_over_cells(tile, volume, s.dilatation);
  }
}

/// Volume, stress and flocculation of a tile after the step, and the sums that go with them.
template <class T, int Dim, bool Axisymmetric>
void update_stress(const StepParameters<T>& step, const ParticleView<T>& particles, Tile<T, Dim>& tile,
                   const T* mass, Strain<T, Dim>& s) {
  constexpr int components = Deviator<T, Dim>::components;
  const int count = tile.count;
  for (int c = 0; c < components; ++c) s.deviator[c] = tile.open(particles.deviator[c]);
  s.pressure = tile.open(particles.pressure);
  s.lambda = particles.lambda ? tile.open(particles.lambda) : nullptr;
  s.shear = tile.fresh();
  s.trial = tile.fresh();
  s.stress = tile.fresh();
  if (step.explicit_fluid) {
    make_trial<T, Dim, Axisymmetric, StressRate::hughes_winget, true>(step, s, count);
  } else if (step.stress_rate == StressRate::hughes_winget) {
    make_trial<T, Dim, Axisymmetric, StressRate::hughes_winget, false>(step, s, count);
  } else {
    make_trial<T, Dim, Axisymmetric, StressRate::jaumann, false>(step, s, count);
  }
  relax(step, s, count);

  T dissipated = T(0), largest_pressure = T(0);
#pragma omp simd reduction(+ : dissipated) reduction(max : largest_pressure)
  for (int q = 0; q < count; ++q) {
    const T scale = s.stress[q] / maximum(s.trial[q], T(1e-30));
    for (int c = 0; c < components; ++c) s.deviator[c][q] *= scale;
    dissipated += mass[q] * s.ratio[q] * s.stress[q] * s.rate[q];
    largest_pressure = largest_pressure > s.pressure[q] ? largest_pressure : s.pressure[q];
  }
  BlockSums& sums = *tile.block.sums;
  sums.dissipated += static_cast<double>(dissipated) * static_cast<double>(step.step / step.density);
  sums.largest_pressure = maximum(sums.largest_pressure, static_cast<double>(largest_pressure));
}

/// Notes a particle that left a cell, and puts it where it belongs in the next one.
template <class T, int Dim, class Shape>
void note_mover(Tile<T, Dim>& tile, int cell, T* const* x, int q) {
  BlockSums& sums = *tile.block.sums;
  constexpr T below_one = sizeof(T) == 8 ? T(1 - 0x1p-53) : T(1 - 0x1p-24f);
  Mover mover{static_cast<std::uint32_t>(tile.first + q), {0, 0, 0}, static_cast<std::uint8_t>(cell)};
  for (int a = 0; a < Dim; ++a) {
    T& to = x[a][q];
    if (to >= T(0) && to < T(1)) continue;
    const int shift = to < T(0) ? -1 : 1;
    const T inside = to - T(shift);
    if (!(inside >= T(0) && inside <= T(1))) ++sums.faults;  // further than a cell, or not finite
    to = minimum(maximum(inside, T(Shape::margin)), minimum(T(1.0 - Shape::margin), below_one));
    mover.shift[a] = static_cast<std::int8_t>(shift);
  }
  tile.block.movers[sums.movers++] = mover;
}

/// Moves a tile's particles with the velocities `advection`.
template <class T, int Dim, class Shape>
void move_particles(const StepParameters<T>& step, Tile<T, Dim>& tile, T* const* x, const T* const* advection,
                    const T* mass) {
  const int count = tile.count;
  // Counts axes along which a particle left its cell; a value that is not finite fails every comparison.
  T* left = tile.fresh();
  T momentum = T(0), largest_speed = T(0);
  const T per_step = step.step * (T(1) / step.cell);
#pragma omp simd reduction(max : largest_speed) reduction(+ : momentum)
  for (int q = 0; q < count; ++q) {
    T square = T(0), outside = T(0);
    for (int a = 0; a < Dim; ++a) {
      const T v = advection[a][q];
      const T to = x[a][q] + v * per_step;
      square += v * v;
      outside += (to >= T(0) && to < T(1)) ? T(0) : T(1);
      x[a][q] = to;
    }
    left[q] = outside;
    momentum += mass[q] * advection[0][q];
    largest_speed = largest_speed > square ? largest_speed : square;
  }
  if (tile.block.walls) keep_out_of_walls<T, Dim>(step, tile, largest_speed * per_step * per_step, x, left);
  int cell = tile.first_cell;
  for (int q = 0; q < count; ++q) {
    if (left[q] == T(0)) continue;
    while (tile.cell_first(cell + 1) <= q) ++cell;
    note_mover<T, Dim, Shape>(tile, cell, x, q);
  }
  BlockSums& sums = *tile.block.sums;
  sums.momentum += static_cast<double>(momentum);
  sums.largest_speed_squared = maximum(sums.largest_speed_squared, static_cast<double>(largest_speed));
}

/// Strain, stress and motion of a tile whose velocity gradients are gathered.
template <class T, int Dim, bool Axisymmetric, class Shape>
void deform_and_move(const StepParameters<T>& step, const ParticleView<T>& particles, Tile<T, Dim>& tile,
                     const T* arena, const T* holds, T* const* x, const Gathered<T, Dim>& gathered,
                     const T* const* advection, const T* filling, T* planes) {
  Strain<T, Dim> s;
  const T* mass = tile.open(particles.mass);
  s.ratio = tile.open(particles.volume_ratio);
  s.rate = tile.open(particles.rate);
  make_strain<T, Dim, Axisymmetric, Shape>(step, tile, arena, holds, x, gathered, mass, filling, planes, s);
  update_stress<T, Dim, Axisymmetric>(step, particles, tile, mass, s);
  move_particles<T, Dim, Shape>(step, tile, x, advection, mass);
}

/// Whether a step keeps anything of what particles brought, see relax.
enum class Own { forgotten, kept };

/// The particles' own velocities after the step, v <- keep (v + dv) + (1 - keep) v_grid, where
/// `increment` is gathered from v_grid - keep * (v_grid before the step's forces).
template <class T>
void relax(T keep, const T* increment, T* own, int count) {
#pragma omp simd
  for (int q = 0; q < count; ++q) own[q] = keep * own[q] + increment[q];
}

/// APIC whose transfer acts at a rate: velocities and affine parts both keep the share `keep` of their own,
/// so that what the transfer smooths a second does not depend on the step. Zero keeps nothing: APIC as
/// published (Jiang et al. 2015). Then one field gives the motion and what particles carry on.
template <class T, int Dim, bool Axisymmetric, Own Kept>
void apic_tiles(const StepParameters<T>& step, const ParticleView<T>& particles, const BlockView& block,
                const T* arena, const T* holds, T* planes, const Workspace<T>& workspace) {
  constexpr bool kept = Kept == Own::kept;
  constexpr Wanted motion_wanted{true, true, !kept}, increment_wanted{true, false, true};
  const T per_cell = T(1) / step.cell;
  Tile<T, Dim> tile(block, workspace);
  while (tile.next()) {
    T* x[Dim];
    for (int a = 0; a < Dim; ++a) x[a] = tile.open(particles.position[a]);
    const Gathered<T, Dim> motion = room_for_gathered<T, Dim>(tile, motion_wanted);
    const Gathered<T, Dim> increment = kept ? room_for_gathered<T, Dim>(tile, increment_wanted) : motion;
    T* filling = step.filling_matters ? tile.fresh() : nullptr;
    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
      const int n = tile.cell_count(cell), first = tile.cell_first(cell);
      if (n == 0) continue;
      const T* base = arena + cell_base<T, Dim>(cell) * node_values;
      if constexpr (kept) {
        const CellField<T, Dim, Quadratic, node_values> field(base);
        gather<T, Dim, Quadratic, node_values, motion_wanted>(field, 1, x, per_cell, first, n, motion,
                                                              nullptr);
        gather<T, Dim, Quadratic, node_values, increment_wanted>(field, record + 1, x, per_cell, first, n,
                                                                 increment, filling);
      } else {
        const CellField<T, Dim, Quadratic, record> field(base + record);
        gather<T, Dim, Quadratic, record, motion_wanted>(field, 1, x, per_cell, first, n, motion, filling);
      }
    }
    const auto carry_on = [&](T* own, T* gathered) {
      if constexpr (kept) {
        relax(step.keep, gathered, tile.open(own), tile.count);
      } else {
        tile.write(own, gathered);
      }
    };
    for (int c = 0; c < Dim; ++c) {
      carry_on(particles.velocity[c], increment.value[c]);
      for (int a = 0; a < Dim; ++a) carry_on(particles.affine[c * Dim + a], increment.affine[c][a]);
    }
    deform_and_move<T, Dim, Axisymmetric, Quadratic>(step, particles, tile, arena, holds, x, motion,
                                                     motion.value, filling, planes);
  }
}

template <class T, int Dim, bool Axisymmetric>
void apic_to_particles(const StepParameters<T>& step, const ParticleView<T>& particles,
                       const BlockView& block, const Grid<T>& grid, const Workspace<T>& workspace) {
  alignas(64) T arena[nodes_per_arena<Dim> * node_values];
  load_arena<T, Dim, Quadratic>(step, block, grid.nodes, arena);
  alignas(64) T plane_of_holds[plane_values<Dim>];
  const T* const holds = load_holds<T, Dim>(block, grid, plane_of_holds);
  T* planes = nullptr;
  if (step.dilatation == Dilatation::smooth) {
    planes = grid.arenas + static_cast<std::size_t>(block.arena) * nodes_per_arena<Dim> * node_values;
    for (int n = 0; n < plane_values<Dim>; ++n) planes[n] = T(0);
  }
  if (step.keep > T(0)) {
    apic_tiles<T, Dim, Axisymmetric, Own::kept>(step, particles, block, arena, holds, planes, workspace);
  } else {
    apic_tiles<T, Dim, Axisymmetric, Own::forgotten>(step, particles, block, arena, holds, planes, workspace);
  }
  if (planes) fold_scalars<T, Dim>(planes, block, step.bounds);
}

/// FLIP's velocities, then their momentum mapped back for the strain (MUSL).
template <class T, int Dim>
void flip_to_particles(const StepParameters<T>& step, const ParticleView<T>& particles,
                       const BlockView& block, const Grid<T>& grid, const Workspace<T>& workspace) {
  alignas(64) T arena[nodes_per_arena<Dim> * node_values];
  load_arena<T, Dim, Linear>(step, block, grid.nodes, arena);
  T* remapped = grid.arenas + static_cast<std::size_t>(block.arena) * nodes_per_arena<Dim> * node_values;
  for (int i = 0; i < nodes_per_arena<Dim> * node_values; ++i) remapped[i] = T(0);
  using Momentum = Sources<T, Dim, 0, record>;
  Tile<T, Dim> tile(block, workspace);
  while (tile.next()) {
    T *x[Dim], *v[Dim];
    for (int a = 0; a < Dim; ++a) x[a] = tile.open(particles.position[a]);
    for (int a = 0; a < Dim; ++a) v[a] = tile.open(particles.velocity[a]);
    const T* mass = tile.open(particles.mass);
    Weights<T, Dim, Linear> weights;
    weights.make(tile, x);
    const Gathered<T, Dim> motion = room_for_gathered<T, Dim>(tile, Wanted{});
    const Gathered<T, Dim> increment = room_for_gathered<T, Dim>(tile, Wanted{});
    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
      const int n = tile.cell_count(cell), first = tile.cell_first(cell);
      if (n == 0) continue;
      const CellField<T, Dim, Linear, node_values> field(arena + cell_base<T, Dim>(cell) * node_values);
      gather<T, Dim, Linear, node_values, Wanted{}>(field, 1, x, T(1), first, n, motion, nullptr);
      gather<T, Dim, Linear, node_values, Wanted{}>(field, record + 1, x, T(1), first, n, increment, nullptr);
    }
    const Momentum momentum{tile.memory + tile.capacity * tile.used, tile.capacity};
    for (int c = 0; c < Dim; ++c) {
      relax(step.keep, increment.value[c], v[c], tile.count);
      tile.write(particles.advection[c], motion.value[c]);
    }
    // Four particles at a time; those past the tile's end are rubbish that nothing reads.
    for (int q = 0; q < tile.count; q += record) {
      const Record<T> m = record_at(mass + q);
      Record<T> value[4] = {m, m * record_at(v[0] + q), m * record_at(v[1] + q), Record<T>{}};
      if constexpr (Dim == 3) value[3] = m * record_at(v[2] + q);
      transpose<T>(value);
      for (int n = 0; n < record; ++n) record_at(momentum.value(q + n)) = value[n];
    }
    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell)
      if (tile.cell_count(cell) > 0)
        scatter<T, Dim, Linear, 0>(remapped + cell_base<T, Dim>(cell) * node_values, momentum, weights,
                                   tile.cell_first(cell), tile.cell_count(cell));
  }
}

template <class T, int Dim, bool Axisymmetric>
void remapped_to_particles(const StepParameters<T>& step, const ParticleView<T>& particles,
                           const BlockView& block, const Grid<T>& grid, const Workspace<T>& workspace) {
  alignas(64) T arena[nodes_per_arena<Dim> * node_values];
  load_arena<T, Dim, Linear>(step, block, grid.nodes, arena);
  alignas(64) T plane_of_holds[plane_values<Dim>];
  const T* const holds = load_holds<T, Dim>(block, grid, plane_of_holds);
  constexpr Wanted wanted{Axisymmetric, true, false};
  const T per_cell = T(1) / step.cell;
  Tile<T, Dim> tile(block, workspace);
  while (tile.next()) {
    T *x[Dim], *advection[Dim];
    for (int a = 0; a < Dim; ++a) x[a] = tile.open(particles.position[a]);
    for (int a = 0; a < Dim; ++a) advection[a] = tile.open(particles.advection[a]);
    const Gathered<T, Dim> g = room_for_gathered<T, Dim>(tile, wanted);
    T* filling = step.filling_matters ? tile.fresh() : nullptr;
    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
      const int n = tile.cell_count(cell), first = tile.cell_first(cell);
      if (n == 0) continue;
      const CellField<T, Dim, Linear, node_values> field(arena + cell_base<T, Dim>(cell) * node_values);
      gather<T, Dim, Linear, node_values, wanted>(field, 1, x, per_cell, first, n, g, filling);
    }
    deform_and_move<T, Dim, Axisymmetric, Linear>(step, particles, tile, arena, holds, x, g, advection,
                                                  filling, nullptr);
  }
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
