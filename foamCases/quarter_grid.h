#pragma once

#include <cstddef>
#include <vector>

#include "foamCases/slump_rows.h"
#include "foamCases/wedge_gauge.h"

/// The mesh of a quarter of a slump between two planes of symmetry, its initial fraction and its gauges.
namespace flowrest::foam {

/// Boxes of cells; cell (i, j, row) has the index i + side * (j + side * row), i along x and j along y.
struct QuarterGrid : SlumpRows {
  int side = 0;        ///< cells along x, and along y
  double width = 0.0;  ///< m, of a cell along x and y

  std::size_t cells() const { return columns() * static_cast<std::size_t>(rows()); }
  std::size_t columns() const { return static_cast<std::size_t>(side) * static_cast<std::size_t>(side); }
  std::size_t index(int i, int j, int row) const {
    const auto n = static_cast<std::size_t>(side);
    return static_cast<std::size_t>(i) +
           n * (static_cast<std::size_t>(j) + n * static_cast<std::size_t>(row));
  }
  double centre(int i) const { return (i + 0.5) * width; }  ///< m
  /// Volume of a cell and its mirror images in the other quarters, m3.
  double cell_volume(int row) const { return 4.0 * width * width * row_height(row); }
};

/// @throws scenes::SceneError where the grid cannot be laid out, saying what is allowed.
QuarterGrid quarter_grid(const scenes::Scene& scene);

/// Area of a disc about the origin within the rectangle from (0, 0) to (x, y), m2.
double disc_in_rectangle(double radius, double x, double y);

/// As gauge_slump of a wedge. Depth counts by rings as wide as a cell; the front is that along x.
SlumpGauges gauge_slump(const QuarterGrid&, const SlumpFields&, double density, bool slip);

double mean_over_concrete(const QuarterGrid&, const std::vector<double>& fraction,
                          const std::vector<double>& field);

/// Shear rate sqrt(2 D:D) in every cell, with faces interpolated linearly. 1/s
std::vector<double> shear_rate(const QuarterGrid&, const std::vector<double>& velocity, bool slip);

}  // namespace flowrest::foam
