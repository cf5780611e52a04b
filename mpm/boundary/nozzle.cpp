#include "mpm/boundary/nozzle.h"

namespace flowrest::mpm {

NozzleMotion<double> motion_of(const Nozzle& nozzle, double time, double step, double cell) {
  const double came = nozzle.extruded(time + step) - nozzle.extruded(time);
  return {nozzle.bore, nozzle.wall, cell, nozzle.mouth(time), nozzle.mouth(time + step), came, step};
}

template <class T>
double NozzleNodes<T>::hold(const SparseBlocks& blocks, double time, double step, T* nodes) {
  impulse_ = {};
  double work = 0.0;
  for (const Nozzle& nozzle : nozzles_)
    if (nozzle.is_there(time)) work += hold(motion_of(nozzle, time, step, cell_), blocks, nodes);
  return work;
}

template <class T>
double NozzleNodes<T>::hold(const NozzleMotion<double>& motion, const SparseBlocks& blocks, T* nodes) {
  double work = 0.0;
  for (std::uint32_t slot = 0; slot < blocks.slot_count(); ++slot) {
    const auto& block = blocks.block(slot);
    // Node n lies in the middle of cell n - 1.
    const auto place = [&](int i, int j, int k) -> Vector {
      return {(block[0] * block_edge + i - 0.5) * cell_, (block[1] * block_edge + j - 0.5) * cell_,
              (block[2] * block_edge + k - 0.5) * cell_};
    };
    if (motion.misses(place(0, 0, 0), place(block_edge - 1, block_edge - 1, block_edge - 1))) continue;
    T* node = nodes + static_cast<std::size_t>(slot) * cells_per_block<3> * node_values;
    for (int i = 0; i < block_edge; ++i)
      for (int j = 0; j < block_edge; ++j)
        for (int k = 0; k < block_edge; ++k, node += node_values) {
          const auto mass = static_cast<double>(node[0]);
          if (!(mass > 0.0)) continue;
          const auto held = motion.at(place(i, j, k));
          if (!held) continue;
          for (std::size_t a = 0; a < 3; ++a) {
            const auto before = static_cast<double>(node[1 + a]);
            const double change = held->share * (held->velocity[a] - before);
            node[1 + a] = static_cast<T>(before + change);
            node[record + 1 + a] += static_cast<T>(change);
            impulse_[a] += mass * change;
            work += mass * change * (before + change);
          }
        }
  }
  return work;
}

template class NozzleNodes<float>;
template class NozzleNodes<double>;

}  // namespace flowrest::mpm
