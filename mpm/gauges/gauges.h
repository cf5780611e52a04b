#pragma once

#include <string>
#include <vector>

#include "mpm/gauges/body_gauge.h"
#include "mpm/solver/solver.h"
#include "runs/columns.h"
#include "runs/held_walls.h"
#include "runs/rest.h"
#include "runs/sheared_layer.h"
#include "scenes/pieces.h"

namespace flowrest::mpm {

/// Energies of the whole body, J. `numerical` is what the discretisation has lost (positive) or made
/// (negative): the initial energy and the work of the driving force less all the others.
struct Energies {
  double kinetic = 0.0, potential = 0.0, elastic = 0.0, dissipated = 0.0, numerical = 0.0;
};

/// What is measured of the particles at one time. What has nothing to read is `runs::nothing`.
struct Measures {
  Energies energies;
  double volume = 0.0;          ///< m3
  double volume_at_rest = 0.0;  ///< m3, what the mass fills without pressure
  double shear_rate_p99 = 0.0;  ///< 1/s, exceeded by one per cent of the mass
  double overstress_p99 = 0.0;  ///< exceeded by one per cent of the mass (runs/rest.h)
  runs::ShearedLayer layer;     ///< along the walls
  double flocculation_mean = 0.0;
  double yield_stress_mean = 0.0;  ///< Pa, of what is thixotropic
  double highest = 0.0;            ///< m
  BodyReading body;                ///< what the apparatus is judged by
};

/// Measures a scene's particles and lays the results out as rows of history.csv.
class Gauges {
 public:
  Gauges(const scenes::Scene&, const scenes::Pieces&);
  /// Of the particles at a time, s.
  Measures measure(Solver&, double time) const;
  /// `layer`: what the row says of the sheared layer.
  runs::Row row(double time, double step, const Measures&, const runs::Row& layer) const;

 private:
  const scenes::Scene& scene_;
  const scenes::Pieces& pieces_;
  runs::Rest rest_;
  runs::HeldWalls held_walls_;
  double cell_;
};

}  // namespace flowrest::mpm
