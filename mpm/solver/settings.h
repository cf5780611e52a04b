#pragma once

#include "mpm/solver/solver.h"
#include "scenes/scene.h"

namespace flowrest::mpm {

/// The solver's settings for a scene and the model it names.
SolverSettings settings_of(const scenes::Scene&);

/// What one simulated particle stands for of the whole body: 4 for a quarter, 2 for half a plane section,
/// else 1.
double whole_body_factor(const scenes::Scene&);

/// The axis gravity points down along (the last); a force along the flow acts along the first.
inline int vertical_axis(const scenes::Scene& scene) { return scene.spatial_dimension() - 1; }

/// Uniform acceleration at a time, m/s2 per axis.
std::array<double, 3> acceleration_at(const scenes::Scene&, double time);

/// The cell size in use. Where a height is a whole number of cells but for round-off, that is taken out here
/// so that the upper wall lies on a cell face exactly. m
double cell_size(const scenes::Scene&);

}  // namespace flowrest::mpm
