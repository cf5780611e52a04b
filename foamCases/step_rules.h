#pragma once

#include "foamCases/apparatus/apparatus.h"

/// How long the steps of an OpenFOAM run may be.
namespace flowrest::foam {

/// The largest step of a run, before it grows: foam.max_time_step; else, for a fluid, cell^2 density /
/// plastic_viscosity, above which creeping material turns to noise with few pressure correctors, and for the
/// elasto-viscoplastic law one and a half cells at the speed of its shear waves, which are implicit: what it
/// bounds is how late they answer. The cells are the smallest there are. At most the time between two samples.
/// s
double largest_step(const ApparatusCase&);

/// The part of the time passed to which a step may grow beyond largest_step. What it leaves undone is of its
/// own size: the speed of a slump that slows falls as a power of the time.
inline constexpr double step_of_time = 0.004;

/// What that step may grow to at most: foam.step_growth times largest_step, and two fifths of the time between
/// two samples; where foam.max_time_step is given, with OpenFOAM's own laws and where steps do not grow
/// largest_step. s
double grown_step(const ApparatusCase&);

}  // namespace flowrest::foam
