#include "mpm/boundary/nozzle.h"

#include <cmath>

namespace flowrest::mpm {

namespace {

constexpr double round_off = 1e-9;  ///< cells

}  // namespace

NozzleMotion::NozzleMotion(const Nozzle& nozzle, double time, double step, double cell)
    : bore_(nozzle.bore), wall_(nozzle.wall), cell_(cell), mouth_(nozzle.mouth(time)), tube_{}, column_{} {
  const Vector next = nozzle.mouth(time + step);
  for (std::size_t a = 0; a < 3; ++a) column_[a] = tube_[a] = (next[a] - mouth_[a]) / step;
  column_[2] -= (nozzle.extruded(time + step) - nozzle.extruded(time)) / step;
}

std::optional<Vector> NozzleMotion::at(const Vector& node) const {
  const double height = node[2] - mouth_[2];
  if (height < -round_off * cell_) return std::nullopt;
  const double radius = std::hypot(node[0] - mouth_[0], node[1] - mouth_[1]);
  if (radius > bore_ + wall_) return std::nullopt;
  const bool at_mouth = height < 0.5 * cell_;
  return radius <= (at_mouth ? bore_ : bore_ + 0.5 * wall_) ? column_ : tube_;
}

bool NozzleMotion::misses(const Vector& lower, const Vector& upper) const {
  const double outside = bore_ + wall_;
  for (std::size_t a = 0; a < 2; ++a)
    if (lower[a] > mouth_[a] + outside || upper[a] < mouth_[a] - outside) return true;
  return upper[2] < mouth_[2] - round_off * cell_;
}

template <class T>
double NozzleNodes<T>::hold(const SparseBlocks& blocks, double time, double step, T* nodes) {
  impulse_ = {};
  double work = 0.0;
  for (const Nozzle& nozzle : nozzles_)
    if (nozzle.is_there(time)) work += hold(NozzleMotion(nozzle, time, step, cell_), blocks, nodes);
  return work;
}

template <class T>
double NozzleNodes<T>::hold(const NozzleMotion& motion, const SparseBlocks& blocks, T* nodes) {
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
            const double change = (*held)[a] - static_cast<double>(node[1 + a]);
            node[1 + a] = static_cast<T>((*held)[a]);
            node[record + 1 + a] += static_cast<T>(change);
            impulse_[a] += mass * change;
            work += mass * change * (*held)[a];
          }
        }
  }
  return work;
}

template class NozzleNodes<float>;
template class NozzleNodes<double>;

}  // namespace flowrest::mpm
