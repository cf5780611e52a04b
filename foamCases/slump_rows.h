#pragma once

#include <algorithm>

#include "scenes/scene.h"

/// The rows of cells of a slump's mesh, whatever its plan: their height changes over the base layer and at
/// the cone's top.
namespace flowrest::foam {

struct SlumpRows {
  int base_rows = 0;             ///< of the base layer, which replaces rows of the cone
  int cone_rows = 0;             ///< from there to the cone's top
  int air_rows = 0;              ///< above it
  double base_row_height = 0.0;  ///< m
  double cone_row_height = 0.0;  ///< m
  double air_row_height = 0.0;   ///< m

  int rows() const { return base_rows + cone_rows + air_rows; }
  double row_height(int row) const {
    if (row < base_rows) return base_row_height;
    return row < base_rows + cone_rows ? cone_row_height : air_row_height;
  }
  /// m, over the base
  double row_centre(int row) const {
    const int base = std::min(row, base_rows), cone = std::clamp(row - base_rows, 0, cone_rows);
    return base * base_row_height + cone * cone_row_height + (row - base - cone) * air_row_height +
           0.5 * row_height(row);
  }
  double base_height() const { return base_rows * base_row_height; }  ///< m, of the base layer
};

/// Rows of about foam.cell, fitted to the cone's top and the domain's top; each of them up to
/// foam.base_height is cut into foam.base_rows.
/// @throws scenes::SceneError where they cannot be laid out, or the whole mesh has too many cells (columns:
/// of cells side by side).
SlumpRows slump_rows(const scenes::Scene&, double columns);

/// How many cells of about foam.cell lie along the domain's radius.
int cells_along_radius(const scenes::Scene&);

}  // namespace flowrest::foam
