#pragma once

#include <vector>

#include "mpm/solver/solver.h"
#include "runs/quantile.h"

namespace flowrest::mpm {

/// The value of particles (`value_of(batch, particle)`, of their motion) that `share` of the mass does not
/// exceed. Looked at alone, so that no more than one list of all particles is in memory at a time.
template <class ValueOf>
double quantile_of_motion(Solver& solver, double share, const ValueOf& value_of) {
  std::vector<runs::Weighted> values;
  values.reserve(solver.particle_count());
  solver.visit_motion([&](const ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) values.emplace_back(value_of(b, i), b.mass[i]);
  });
  return runs::quantile(values, share);
}

}  // namespace flowrest::mpm
