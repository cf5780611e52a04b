#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

/// Air below concrete in one column of cells, without OpenFOAM.
namespace flowrest::rheology {

/// Concrete over a cell that is at least this full holds down the air in it; less is a lip, which falls by
/// itself.
constexpr double holds_air_down = 0.9;

/// What a column of cells holds, from below upwards.
struct Column {
  std::vector<double> fraction;  ///< of concrete
  std::vector<double> volume;    ///< m3
};

/// Air that has concrete over it, cell by cell: as much as a cell is less full than the fullest above it. m3
inline std::vector<double> trapped_air(const Column& column) {
  std::vector<double> air(column.fraction.size(), 0.0);
  double fullest = 0.0;
  for (std::size_t i = column.fraction.size(); i-- > 0;) {
    if (fullest >= holds_air_down)
      air[i] = std::max(0.0, std::min(fullest, 1.0) - column.fraction[i]) * column.volume[i];
    fullest = std::max(fullest, column.fraction[i]);
  }
  return air;
}

/// Lets the part `share` of the trapped air rise: concrete comes down into its place from the column's
/// surface. The column's concrete stays the same to round-off. Returns the volume that changed places, m3.
inline double let_air_rise(Column& column, double share) {
  const auto air = trapped_air(column);
  double moved = 0.0;
  for (std::size_t i = 0; i < air.size(); ++i) {
    column.fraction[i] += share * air[i] / column.volume[i];
    moved += share * air[i];
  }
  double owed = moved;
  for (std::size_t i = column.fraction.size(); i-- > 0 && owed > 0.0;) {
    const double taken = std::min(owed, std::max(0.0, column.fraction[i]) * column.volume[i]);
    column.fraction[i] -= taken / column.volume[i];
    owed -= taken;
  }
  return moved;
}

}  // namespace flowrest::rheology
