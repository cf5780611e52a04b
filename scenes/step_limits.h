#pragma once

#include "scenes/scene.h"

/// The time steps past which an explicit computation of a scene is unstable or silently wrong. A scene that asks
/// for more is refused as it is read, whichever solvers are there; steps that a solver chooses by itself, and
/// what a run costs, are known to its own room.
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
