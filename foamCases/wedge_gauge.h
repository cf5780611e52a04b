#pragma once

#include <utility>
#include <vector>

#include "foamCases/wedge_grid.h"
#include "runs/depth.h"
#include "runs/sheared_layer.h"

/// What is measured of a slump's fields on the wedge grid, scaled to the full circle.
namespace flowrest::foam {

/// Fields at one time, a value to a cell; the velocity is x (radial), y, z (upwards). The structure is the part
/// by which the yield stress passes tau0, empty where there is none.
struct SlumpFields {
  std::vector<double> fraction;
  std::vector<double> velocity;
  std::vector<double> structure = {};
  /// 1/s, as the plug-in has it, which knows how far a wall with friction holds; where it is empty it is
  /// computed as `shear_rate` does.
  std::vector<double> shear_rate = {};
  double flow_index = 1.0;  ///< of the concrete
};

/// What has nothing to read is `runs::nothing`.
struct SlumpGauges {
  std::vector<double> radius;             ///< m, ring centres
  std::vector<double> depth;              ///< m, concrete volume per plan area of each ring
  double volume = 0.0;                    ///< m3, of concrete
  double kinetic_energy = 0.0;            ///< J, of the concrete alone
  double shear_rate_p99 = runs::nothing;  ///< 1/s, the 99th percentile by volume over cells at least 90 %
                                          ///< full; nothing without any
  /// 1/s, the same of runs::overstressing_rate: what overstresses the material.
  double overstressing_rate_p99 = runs::nothing;
  double base_shear_rate_p99 =
      runs::nothing;  ///< 1/s, at the base, the same by area under cells at least 90 % full; 0 where it slips
  double front =
      runs::nothing;  ///< m, twice the radius at which the base row is half full; nothing where it nowhere is
  double trapped_air = 0.0;  ///< m3, of air with fuller cells above it
  double rim_depth = 0.0;    ///< m, depth in the outermost ring
  runs::LayerMeter layer;    ///< of cells at least 90 % full

  runs::DepthView profile() const { return {radius, depth, runs::About::axis}; }
};

/// `slip` says that the base does not hold the concrete back, which the shear rate in the lowest row needs.
SlumpGauges gauge_slump(const WedgeGrid&, const SlumpFields&, double density, bool slip);

/// Mean of a cell field over the concrete, by its volume.
double mean_over_concrete(const WedgeGrid&, const std::vector<double>& fraction,
                          const std::vector<double>& field);

/// Shear rate sqrt(2 D:D) in every cell, with faces interpolated linearly as the case's schemes do. 1/s
std::vector<double> shear_rate(const WedgeGrid&, const std::vector<double>& velocity, bool slip);

}  // namespace flowrest::foam
