#pragma once

#include <utility>
#include <vector>

#include "mpm/solver/solver.h"

namespace flowrest::mpm {

/// A value and the mass that has it.
using Weighted = std::pair<double, double>;

/// The value that `share` of the mass does not exceed; `runs::nothing` without mass. Reorders the values.
double quantile(std::vector<Weighted>& values, double share);

/// The value of particles (`value_of(batch, particle)`, of their motion) that `share` of the mass does not
/// exceed. Looked at alone, so that no more than one list of all particles is in memory at a time.
template <class ValueOf>
double quantile_of_motion(Solver& solver, double share, const ValueOf& value_of) {
  std::vector<Weighted> values;
  values.reserve(solver.particle_count());
  solver.visit_motion([&](const ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) values.emplace_back(value_of(b, i), b.mass[i]);
  });
  return quantile(values, share);
}

}  // namespace flowrest::mpm
