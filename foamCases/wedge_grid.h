#pragma once

#include <cstddef>

#include "foamCases/slump_rows.h"

/// The slump case's mesh as the gauges see it: equal rings and rows of cells.
namespace flowrest::foam {

/// Cells of a wedge about the vertical axis; cell (ring, row) has the index ring + rings * row.
struct WedgeGrid : SlumpRows {
  int rings = 0;
  double ring_width = 0.0;  ///< m

  std::size_t cells() const { return static_cast<std::size_t>(rings) * static_cast<std::size_t>(rows()); }
  std::size_t index(int ring, int row) const {
    return static_cast<std::size_t>(ring) + static_cast<std::size_t>(rings) * static_cast<std::size_t>(row);
  }
  double ring_centre(int ring) const { return (ring + 0.5) * ring_width; }
  /// Plan area of the whole ring, m2.
  double ring_area(int ring) const;
  /// Volume of the whole ring of cells, m3.
  double cell_volume(int ring, int row) const { return ring_area(ring) * row_height(row); }
};

/// The grid of a slump: cells of about foam.cell, fitted to the domain's radius, the cone's top and the
/// domain's top; the lowest row is cut into foam.base_rows thinner ones.
/// @throws scenes::SceneError where the grid cannot be laid out, saying what is allowed.
WedgeGrid wedge_grid(const scenes::Scene& scene);

}  // namespace flowrest::foam
