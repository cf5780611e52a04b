#include "foamCases/quarter_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "foamCases/apparatus/slump.h"
#include "foamCases/test_scene.h"
#include "runs/depth.h"

namespace flowrest::foam {
namespace {

using testing::roussel_slump;

scenes::Scene quarter(const std::string& cell) {
  return roussel_slump("papanastasiou",
                       {"geometry.dimension=quarter", "foam.cell=" + cell, "foam.base_rows=3"});
}

TEST(QuarterGrid, AreasOfADiscAreExact) {
  constexpr double pi = std::numbers::pi;
  EXPECT_DOUBLE_EQ(disc_in_rectangle(2.0, 1.0, 1.0), 1.0);
  EXPECT_DOUBLE_EQ(disc_in_rectangle(2.0, 5.0, 5.0), pi);
  EXPECT_DOUBLE_EQ(disc_in_rectangle(2.0, 5.0, 1.0), pi / 3.0 + 0.5 * std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(disc_in_rectangle(2.0, 1.0, 5.0), disc_in_rectangle(2.0, 5.0, 1.0));
  EXPECT_EQ(disc_in_rectangle(0.0, 1.0, 1.0), 0.0);
  // A corner just outside the circle: what is missing of the square, by trapezia.
  double area = 0.0;
  constexpr int panels = 200000;
  for (int k = 0; k < panels; ++k) {
    const double x = (k + 0.5) / panels;
    area += std::min(1.0, std::sqrt(1.3 * 1.3 - x * x)) / panels;
  }
  EXPECT_NEAR(disc_in_rectangle(1.3, 1.0, 1.0), area, 1e-9);
}

TEST(QuarterGrid, TheConesVolumeIsExactOnAnyGrid) {
  for (const char* cell : {"0.03", "0.023", "0.01"}) {
    const auto scene = quarter(cell);
    const auto grid = quarter_grid(scene);
    const auto fraction = cone_fraction(scene.slump(), grid);
    double volume = 0.0;
    for (int row = 0; row < grid.rows(); ++row)
      for (int j = 0; j < grid.side; ++j)
        for (int i = 0; i < grid.side; ++i) {
          const double f = fraction[grid.index(i, j, row)];
          EXPECT_TRUE(f >= 0.0 && f <= 1.0);
          EXPECT_NEAR(f, fraction[grid.index(j, i, row)], 1e-12);
          volume += f * grid.cell_volume(row);
        }
    EXPECT_NEAR(volume, scene.slump().volume(), 1e-10 * volume) << cell;
  }
}

TEST(QuarterGauge, SeesTheShapeAndTheEnergyOfAKnownBody) {
  const auto scene = quarter("0.01");
  const auto grid = quarter_grid(scene);
  // A paraboloid 40 mm high that ends at 0.3 m and spreads with u = x, y.
  SlumpFields fields{std::vector<double>(grid.cells(), 0.0), std::vector<double>(3 * grid.cells(), 0.0)};
  for (int j = 0; j < grid.side; ++j)
    for (int i = 0; i < grid.side; ++i) {
      const double x = grid.centre(i), y = grid.centre(j);
      double left = std::max(0.0, 0.040 * (1.0 - (x * x + y * y) / 0.09));
      for (int row = 0; row < grid.rows(); ++row) {
        const auto cell = grid.index(i, j, row);
        fields.fraction[cell] = std::clamp(left / grid.row_height(row), 0.0, 1.0);
        left -= fields.fraction[cell] * grid.row_height(row);
        fields.velocity[3 * cell] = x;
        fields.velocity[3 * cell + 1] = y;
      }
    }
  const auto gauges = gauge_slump(grid, fields, 2300.0, true);
  const double volume = 0.5 * std::numbers::pi * 0.09 * 0.040;
  EXPECT_NEAR(gauges.volume, volume, 2e-3 * volume);
  EXPECT_NEAR(gauges.kinetic_energy, 0.5 * 2300.0 * volume * 0.09 / 3.0, 5e-3 * gauges.kinetic_energy);
  EXPECT_NEAR(runs::spread(gauges.profile(), 0.003), 0.6 * std::sqrt(37.0 / 40.0), 2e-3);
  EXPECT_NEAR(gauges.trapped_air, 0.0, 1e-15);
  EXPECT_EQ(gauges.base_shear_rate_p99, 0.0);
  // Away from edges: D = diag(1, 1, 0), so 2 D:D = 4.
  EXPECT_NEAR(shear_rate(grid, fields.velocity, true)[grid.index(5, 7, 0)], 2.0, 1e-9);
  EXPECT_EQ(gauges.rim_depth, 0.0);
}

TEST(QuarterGauge, TheBaseHoldsAndTheMirrorsDoNot) {
  const auto grid = quarter_grid(quarter("0.03"));
  std::vector<double> velocity(3 * grid.cells(), 0.0);
  // u = z along x, but on the outermost cells of y nothing changes either.
  double below = 0.0;
  for (int row = 0; row < grid.rows(); ++row) {
    for (int j = 0; j < grid.side; ++j)
      for (int i = 0; i < grid.side; ++i)
        velocity[3 * grid.index(i, j, row) + 1] = below + 0.5 * grid.row_height(row);
    below += grid.row_height(row);
  }
  const auto rate = shear_rate(grid, velocity, false);
  EXPECT_NEAR(rate[grid.index(4, 4, 0)], 1.0, 1e-12);
  EXPECT_NEAR(rate[grid.index(0, 4, 2)], 1.0, 1e-12);
  EXPECT_GT(rate[grid.index(4, 0, 2)], 1.0);  // flow along y must stop at the mirror y = 0
}

}  // namespace
}  // namespace flowrest::foam
