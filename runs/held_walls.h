#pragma once

#include <array>
#include <vector>

#include "scenes/pieces.h"

/// The walls of an apparatus that can hold the material, as distances: one definition for every solver.
namespace flowrest::runs {

/// Those that stand and neither slip nor move: plates, floors, sides, slopes, bars; neither a mould nor a
/// gate that is lifted. What has run out of an outlet is held by nothing, and what lies under an outlet holds
/// nothing that is still over it.
class HeldWalls {
 public:
  /// `dimension` is that of the computation, 2 or 3.
  HeldWalls(const scenes::Pieces&, int dimension);

  /// Whether there are any: along walls that slip nothing is held.
  bool any() const { return !walls_.empty(); }
  /// Distance to the nearest of them, m; infinite where nothing can hold. `x` runs along the first axis
  /// (about an axis: the radius), `across` along the second of three, of no meaning in two dimensions;
  /// `height` is that along the vertical.
  double distance(double x, double across, double height) const;

 private:
  std::vector<scenes::WallPiece> walls_;
  bool space_;
  bool runs_out_;
};

}  // namespace flowrest::runs
