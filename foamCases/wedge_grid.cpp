#include "foamCases/wedge_grid.h"

#include <numbers>

namespace flowrest::foam {

double WedgeGrid::ring_area(int ring) const {
  return std::numbers::pi * ring_width * ring_width * (2.0 * ring + 1.0);
}

WedgeGrid wedge_grid(const scenes::Scene& scene) {
  WedgeGrid grid;
  static_cast<SlumpRows&>(grid) = slump_rows(scene, scene.slump().domain_radius / scene.foam.cell);
  grid.rings = cells_along_radius(scene);
  grid.ring_width = scene.slump().domain_radius / grid.rings;
  return grid;
}

}  // namespace flowrest::foam
