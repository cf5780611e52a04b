#pragma once

#include <vector>

#include "foamCases/block_mesh.h"
#include "runs/held_walls.h"
#include "runs/sheared_layer.h"
#include "scenes/pieces.h"
#include "scenes/scene.h"

/// What is measured of the fields in a vessel, by the definitions that all runs share (runs/depth.h), of the
/// whole body.
namespace flowrest::foam {

/// Fields at one time, a value to a cell.
struct VesselFields {
  std::vector<double> fraction;
  std::vector<double> velocity;    ///< x, y, z of each cell, m/s
  std::vector<double> shear_rate;  ///< 1/s; empty where nobody computes it
  std::vector<double> structure;   ///< by which part the yield stress passes tau0; empty where there is none
};

/// What has nothing to read is `runs::nothing`.
struct VesselGauges {
  std::vector<double> place, depth;  ///< m, of equal bins along x (a funnel's: over half its width)
  double volume = 0.0;               ///< m3
  double kinetic_energy = 0.0;       ///< J, of the concrete alone
  double potential_energy = 0.0;     ///< J, over the floor or the outlet
  double shear_rate_p99 = 0.0;       ///< 1/s, by volume over cells at least 90 % full
  /// 1/s, the same of runs::overstressing_rate: what overstresses the material.
  double overstressing_rate_p99 = 0.0;
  double base_shear_rate_p99 =
      0.0;                 ///< 1/s, velocity along the floor over half a cell, of cells at least 90 % full
  runs::LayerMeter layer;  ///< of cells at least 90 % full; empty where nobody computes the shear rate
  double front = 0.0;      ///< m, from the gate or the tank's corner
  double front_mass_995 = 0.0;  ///< m, the same of 99.5 % of the concrete
  double end_height = 0.0;      ///< m, depth at the far end
  double start_height = 0.0;    ///< m, depth at the back wall
  double over_outlet = 0.0;     ///< m3 that are still in a funnel
  double thinnest_over_outlet =
      0.0;  ///< m of concrete in the thinnest line of sight through a funnel's outlet
};

/// Gauges one vessel's fields, time after time.
class VesselGauge {
 public:
  VesselGauge(const scenes::Scene&, std::vector<MeshCell>);

  std::size_t cells() const { return cells_.size(); }
  VesselGauges measure(const VesselFields&) const;
  /// Whether there is a floor that shears what moves upon it; the floor under a funnel is not gauged.
  bool floor_holds() const;
  /// Mean of a cell field over the concrete, by its volume.
  double mean_over_concrete(const std::vector<double>& fraction, const std::vector<double>& field) const;

 private:
  void measure_channel(const VesselFields&, const scenes::ChannelGauge&, VesselGauges&) const;
  void measure_outlet(const VesselFields&, const scenes::OutletGauge&, VesselGauges&) const;

  const scenes::Scene& scene_;
  scenes::Pieces pieces_;
  runs::HeldWalls walls_;
  std::vector<MeshCell> cells_;
  double factor_;  ///< whole body over what the mesh holds
};

}  // namespace flowrest::foam
