#pragma once

#include "mpm/material/deviator.h"
#include "mpm/transfer/tile.h"

/// Quadrature over cells that are known to be full: a duct's, which has no free surface.
///
/// A cell's particles are the points at which its stress is summed. Once they lie in disorder their volumes
/// add up to more or less than the cell and lie to one side of it: a shear stress that is the same everywhere
/// then pushes nodes, which moves the particles across the flow, and disorder grows by itself
/// (docs/measured/2026-11-28-disorder-in-ducts.md). Only shear stress is summed this way: an overlap of particles under pressure has to
/// push them apart as it always did.
namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Factors of the particles' shear stress, 1 + c0 + c . (x - 1/2) in each cell, with which their volumes sum
/// over the cell what is constant exactly. Of what they miss in what is linear along an axis, kept / (kept +
/// spread) is left, `spread` being a twelfth where they lie evenly, and nought where they share a coordinate
/// and nothing can be summed. Across the flow that is a tenth. Along it rows of particles stream past each
/// other, out of step with the cells: theirs sum well across cells' borders and are off within each, so that
/// all the weight on the cell would disturb them; half is left.
template <class T, int Dim>
void factors_of_full_cells(const StepParameters<T>& step, const Tile<T, Dim>& tile, const T* const* x,
                           const T* volume, T cell_volume, T* factor) {
  constexpr int terms = Dim + 1;
  T kept[Dim];
  for (int a = 0; a < Dim; ++a) kept[a] = step.bounds[a].periodic ? T(0.1) : T(0.01);
  for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
    const int first = tile.cell_first(cell), end = first + tile.cell_count(cell);
    if (first == end) continue;
    const auto basis = [&](int term, int q) { return term == 0 ? T(1) : x[term - 1][q] - T(0.5); };
    T moment[terms][terms] = {}, c[terms];
    for (int q = first; q < end; ++q)
      for (int i = 0; i < terms; ++i)
        for (int j = i; j < terms; ++j) moment[i][j] += volume[q] * basis(i, q) * basis(j, q);
    for (int i = 0; i < terms; ++i) c[i] = (i == 0 ? cell_volume : T(0)) - moment[0][i];
    for (int i = 1; i < terms; ++i) moment[i][i] += kept[i - 1] * moment[0][0];
    // Symmetric and positive: elimination without pivots.
    for (int i = 0; i < terms; ++i)
      for (int j = i + 1; j < terms; ++j) {
        const T share = moment[i][j] / moment[i][i];
        for (int k = j; k < terms; ++k) moment[j][k] -= share * moment[i][k];
        c[j] -= share * c[i];
      }
    for (int i = terms - 1; i >= 0; --i) {
      for (int j = i + 1; j < terms; ++j) c[i] -= moment[i][j] * c[j];
      c[i] /= moment[i][i];
    }
    for (int q = first; q < end; ++q) {
      factor[q] = T(1);
      for (int i = 0; i < terms; ++i) factor[q] += c[i] * basis(i, q);
    }
  }
}

/// The particles' deviators times those factors, in the workspace.
template <class T, int Dim>
void weigh_in_full_cells(const StepParameters<T>& step, Tile<T, Dim>& tile, const T* const* x,
                         const T* volume, T cell_volume, const T* (&deviator)[Deviator<T, Dim>::components]) {
  T* const factor = tile.fresh();
  factors_of_full_cells(step, tile, x, volume, cell_volume, factor);
  for (const T*& of_particles : deviator) {
    T* const weighed = tile.fresh();
    for (int q = 0; q < tile.count; ++q) weighed[q] = factor[q] * of_particles[q];
    of_particles = weighed;
  }
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
