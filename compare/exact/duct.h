#pragma once

#include <functional>

#include "compare/exact/solutions.h"
#include "runs/run_directory.h"

/// Flow between plates beside what a run made of it.
namespace flowrest::compare::exact {

/// Relative L2 difference of a run's profile from a velocity, y from the middle of plates `height` apart.
double profile_error(const runs::Profile&, double height, const std::function<double(double)>& velocity);

/// When a material without regularisation stops whose force is stepped down at zero from that of a steady flow to `driving`
/// (N/m3): the time at which its middle falls below `slow` (m/s), by finite differences over half the height,
/// velocities and stresses staggered. A stiff elasticity holds the plug together; every step's stress is
/// relaxed to the flow law. s
double duct_stopping_time(const DuctFlow& before, double driving, double slow);

}  // namespace flowrest::compare::exact
