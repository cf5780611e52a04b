#pragma once

#include "scenes/schema.h"
#include "scenes/value.h"

namespace flowrest::scenes {

/// Fills in what follows from other settings: moduli, critical shear rate, time step of `paper`, particles
/// along each axis, cell of the OpenFOAM mesh, what gauges are defined by, runs.
void resolve(const Given&, Draft&, Faults&);

}  // namespace flowrest::scenes
