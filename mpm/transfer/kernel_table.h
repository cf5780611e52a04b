#pragma once

#include "mpm/boundary/contact_sweeps.h"
#include "mpm/transfer/grid_to_particles.h"
#include "mpm/transfer/nodes.h"
#include "mpm/transfer/particles_to_grid.h"

/// The stages put together, one table for each dimension and transfer.
namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

template <class T, int Dim, bool Axisymmetric>
Kernels<T> make_kernels(Transfer transfer) {
  if (transfer == Transfer::quadratic_apic)
    return {Dim,
            particles_to_grid<T, Dim, Axisymmetric, Quadratic>,
            update_nodes<T, Dim, false>,
            apic_to_particles<T, Dim, Axisymmetric>,
            nullptr,
            nullptr,
            average_dilatation<T, Dim>,
            update_volumes<T, Dim>,
            average_pressure<T, Dim>,
            acting_pressure<T, Dim>,
            contact_kernels<T>()};
  return {Dim,
          particles_to_grid<T, Dim, Axisymmetric, Linear>,
          update_nodes<T, Dim, false>,
          flip_to_particles<T, Dim>,
          update_nodes<T, Dim, true>,
          remapped_to_particles<T, Dim, Axisymmetric>,
          nullptr,
          nullptr,
          nullptr,
          nullptr,
          contact_kernels<T>()};
}

template <class T>
Kernels<T> select_kernels(int dimension, bool axisymmetric, Transfer transfer) {
  if (dimension == 3) return make_kernels<T, 3, false>(transfer);
  return axisymmetric ? make_kernels<T, 2, true>(transfer) : make_kernels<T, 2, false>(transfer);
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
