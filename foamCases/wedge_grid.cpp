#include "foamCases/wedge_grid.h"

#include <numbers>

#include "scenes/pieces.h"

namespace flowrest::foam {

double WedgeGrid::ring_area(int ring) const {
  return std::numbers::pi * ring_width * ring_width * (2.0 * ring + 1.0);
}

WedgeGrid wedge_grid(const scenes::Scene& scene) {
  WedgeGrid grid;
  static_cast<SlumpRows&>(grid) =
      slump_rows(scene, scenes::pieces_of(scene).domain->radius / scene.foam.cell);
  grid.rings = cells_along_radius(scene);
  grid.ring_width = scenes::pieces_of(scene).domain->radius / grid.rings;
  return grid;
}

}  // namespace flowrest::foam
