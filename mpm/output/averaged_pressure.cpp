#include "mpm/output/averaged_pressure.h"

#include <cmath>

namespace flowrest::mpm {

std::size_t AveragedPressure::Hash::operator()(const Corner& c) const {
  std::uint64_t mixed = 0;
  for (const std::int32_t value : c)
    mixed = (mixed ^ static_cast<std::uint32_t>(value)) * 0x9e3779b97f4a7c15ull;
  return static_cast<std::size_t>(mixed ^ (mixed >> 32));
}

AveragedPressure::Corner AveragedPressure::cell_of(const ParticleBatch& batch, std::size_t particle) const {
  Corner cell{};
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension_); ++a)
    cell[a] = static_cast<std::int32_t>(std::floor(batch.position[a][particle] / cell_));
  return cell;
}

AveragedPressure::Corner AveragedPressure::corner_of(const Corner& cell, int corner) const {
  Corner at = cell;
  for (int a = 0; a < dimension_; ++a) at[static_cast<std::size_t>(a)] += corner >> a & 1;
  return at;
}

void AveragedPressure::add(const ParticleBatch& batch) {
  if (!batch.acting_pressure.empty()) return;
  // Particles come cell by cell: each cell's sum goes to its corners once.
  for (std::size_t i = 0; i < batch.count;) {
    const Corner cell = cell_of(batch, i);
    Sum sum;
    for (; i < batch.count && cell_of(batch, i) == cell; ++i) {
      sum.volume += batch.volume[i];
      sum.thrust += batch.volume[i] * batch.raw_pressure[i];
    }
    for (int corner = 0; corner < 1 << dimension_; ++corner) {
      Sum& to = corners_[corner_of(cell, corner)];
      to.volume += sum.volume;
      to.thrust += sum.thrust;
    }
  }
}

std::vector<double> AveragedPressure::at(const ParticleBatch& batch) const {
  if (!batch.acting_pressure.empty()) return batch.acting_pressure;
  std::vector<double> pressure(batch.count);
  Corner cell{};
  std::array<double, 8> corners{};
  for (std::size_t i = 0; i < batch.count; ++i) {
    const Corner here = cell_of(batch, i);
    if (i == 0 || here != cell) {
      cell = here;
      for (int corner = 0; corner < 1 << dimension_; ++corner) {
        const Sum& sum = corners_.at(corner_of(cell, corner));
        corners[static_cast<std::size_t>(corner)] = sum.thrust / sum.volume;
      }
    }
    for (int corner = 0; corner < 1 << dimension_; ++corner) {
      double weight = 1.0;
      for (int a = 0; a < dimension_; ++a) {
        const auto axis = static_cast<std::size_t>(a);
        const double within = batch.position[axis][i] / cell_ - cell[axis];
        weight *= (corner >> a & 1) ? within : 1.0 - within;
      }
      pressure[i] += weight * corners[static_cast<std::size_t>(corner)];
    }
  }
  return pressure;
}

}  // namespace flowrest::mpm
