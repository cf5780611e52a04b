#pragma once

#include "scenes/scene.h"

/// The time steps past which an explicit computation of a scene is unstable or silently wrong.
namespace flowrest::scenes {

struct StepLimits {
  double acoustic =
      0.0;  ///< s, cell / c at the stiffest pressure the scene can have at rest (its own weight)
  double viscous =
      0.0;  ///< s, density cell^2 / (6 eta_max) of the explicit fluid; infinite for every other update
  double largest_cfl = 1.0;  ///< the largest stable Courant number measured, of cell / (c + |v|)
  /// The largest step that is stable: min(largest_cfl * acoustic, viscous).
  double largest() const;
};

StepLimits step_limits(const Scene&);

/// The largest step of an OpenFOAM run, before a slump's grows: foam.max_time_step; else, for a fluid, cell^2
/// density / plastic_viscosity, above which creeping material turns to noise with few pressure correctors,
/// and for the elasto-viscoplastic law one and a half cells at the speed of its shear waves, which are
/// implicit: what it bounds is how late they answer. The cells are the smallest there are. At most the time
/// between two samples. s
double largest_foam_step(const Scene&);
/// foam.cell, but between the bars of an L-box, where cells are half a radius wide. m
double smallest_foam_cell(const Scene&);

/// The part of the time passed to which a slump's step may grow beyond largest_foam_step. What it leaves
/// undone is of its own size: the speed of a slump that slows falls as a power of the time.
inline constexpr double foam_step_of_time = 0.004;

/// What that step may grow to at most: foam.step_growth times largest_foam_step, and two fifths of the time
/// between two samples; where foam.max_time_step is given, with OpenFOAM's own laws and for all else than
/// slumps largest_foam_step. s
double grown_foam_step(const Scene&);

/// Speed of a fall from the body's height, and a funnel's above what it falls on; none in a duct. m/s
double free_fall_speed(const Scene&);

/// Largest pressure at rest: density gravity height of a slump's cone, none in a duct. Pa
double pressure_at_rest(const Scene&);

/// Part of its volume that the material keeps under pressure_at_rest (Yu et al. 2026, Eq. 6).
double volume_under_weight(const Scene&);

/// Steps, particles and cells a run will take, and its expected cost.
struct MpmEstimate {
  double particles = 0.0;
  double cells = 0.0;  ///< occupied at the start
  double steps = 0.0;  ///< to time.end
  double step = 0.0;   ///< s, the expected typical step
};
MpmEstimate estimate_mpm(const Scene&);

}  // namespace flowrest::scenes
