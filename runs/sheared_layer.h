#pragma once

#include <cstddef>
#include <vector>

/// The layer along the walls in which a flow is sheared: what cells must resolve, defined once for every
/// solver.
namespace flowrest::runs {

/// A part of a body that is sheared.
struct ShearSample {
  double distance = 0.0;  ///< m, to the nearest wall that can hold it; infinite where none can: left out
  double extent = 0.0;    ///< m, that it takes up towards the wall
  double cell = 0.0;      ///< m, the size of the cells there
  double volume = 0.0;    ///< m3
  double rate = 0.0;      ///< 1/s, of shear
};

/// A sheared layer at one time.
struct ShearedLayer {
  double thickness = 0.0;  ///< m; 0 where nothing shears
  double cells = 0.0;      ///< over the thickness, from the wall on
  double mean_rate = 0.0;  ///< 1/s, of shear, the mean over the body
};

/// Measures the layer from samples of a body. In plane flow between walls the shear rate of a Bingham or a
/// Newtonian material falls linearly from the wall to the plug, or to the middle, so that 90 % of what
/// viscosity takes, which goes with the rate's square, are taken within 1 - 0.1^(1/3) = 0.536 of the layer.
/// The thickness is that of the layer with a linear rate that has its 90 % within the same distance: h/2 -
/// tau0/F in a duct, whatever the material. What the yield stress takes goes with the rate itself: counted
/// too, it would give each law a thickness of its own, and a plug that is slowly pulled apart the say that
/// the layer has.
class LayerMeter {
 public:
  /// Of the viscous dissipation, by which the layer is measured.
  static constexpr double share = 0.9;

  /// Distances are told apart to a quarter of the first sample's extent.
  void add(const ShearSample&);

  ShearedLayer layer() const;

 private:
  struct Bin {
    double weight = 0.0;           ///< m3/s2, volume times the rate's square
    double cells_per_metre = 0.0;  ///< times the weight
  };
  double cells_within(double thickness) const;

  double width_ = 0.0;        ///< m, of a bin
  double volume_ = 0.0;       ///< m3
  double volume_rate_ = 0.0;  ///< m3/s, volume times rate
  std::vector<Bin> bins_;
};

}  // namespace flowrest::runs
