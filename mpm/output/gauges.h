#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mpm/solver/solver.h"
#include "runs/run_directory.h"
#include "scenes/scene.h"

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
  double flocculation_mean = 0.0;
  double mean_velocity = 0.0;             ///< m/s along the first axis
  double farthest = 0.0;                  ///< m, largest radius (slump)
  double highest = 0.0;                   ///< m
  std::vector<double> coordinate, value;  ///< the profile: radius and depth, or height and velocity
  double spread_mass_995 = 0.0;           ///< m, twice the radius that holds 99.5 % of the mass (slump)
  double front = 0.0;                     ///< m, from the gate or the tank's corner (l-box, dam-break)
  double front_mass_995 = 0.0;            ///< m, the same of 99.5 % of the mass
  double end_height = 0.0;                ///< m, depth at the far end (l-box, dam-break)
  double start_height = 0.0;              ///< m, depth at the back wall (l-box, dam-break)
  double discharged = 0.0;                ///< share of the mass below the outlet (v-funnel)
  double thinnest_over_outlet = 0.0;      ///< m of material in the thinnest line of sight (v-funnel)
};

/// Measures a scene's particles and lays the results out as rows of history.csv.
class Gauges {
 public:
  explicit Gauges(const scenes::Scene&);
  Measures measure(Solver&) const;
  std::vector<std::string> columns() const;
  std::vector<double> row(double time, double step, const Measures&) const;
  /// The gauge to show while a run goes on, e.g. "spread 543.2 mm".
  std::string headline(const Measures&) const;
  double headline_value(const Measures&) const;

 private:
  Measures measure_slump(Solver&) const;
  Measures measure_duct(Solver&) const;
  Measures measure_channel(Solver&) const;
  Measures measure_v_funnel(Solver&) const;

  const scenes::Scene& scene_;
  double factor_;  ///< whole body over what is simulated
  double cell_;
};

}  // namespace flowrest::mpm
