#include "foamCases/wedge_gauge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "foamCases/concrete_rates.h"
#include "foamCases/test_scene.h"
#include "runs/depth.h"
#include "runs/rest.h"

namespace flowrest::foam {
namespace {

using testing::roussel_slump;

WedgeGrid grid_of_cells(double cell) {
  return wedge_grid(roussel_slump("papanastasiou", {"foam.cell=" + std::to_string(cell)}));
}

SlumpFields still_air(const WedgeGrid& grid) {
  return {std::vector<double>(grid.cells(), 0.0), std::vector<double>(3 * grid.cells(), 0.0)};
}

double row_centre(const WedgeGrid& grid, int row) {
  double below = 0.0;
  for (int k = 0; k < row; ++k) below += grid.row_height(k);
  return below + 0.5 * grid.row_height(row);
}

/// Fills the fields up to a depth that depends on the radius only.
SlumpFields filled_to(const WedgeGrid& grid, const std::function<double(double)>& depth) {
  auto fields = still_air(grid);
  for (int ring = 0; ring < grid.rings; ++ring) {
    double left = depth(grid.ring_centre(ring));
    for (int row = 0; row < grid.rows(); ++row) {
      const double share = std::clamp(left / grid.row_height(row), 0.0, 1.0);
      fields.fraction[grid.index(ring, row)] = share;
      left -= share * grid.row_height(row);
    }
  }
  return fields;
}

TEST(WedgeGrid, FitsTheDomainAndTheConeTopWithAnyCell) {
  for (const double cell : {0.02, 0.017, 0.01, 0.0033}) {
    const auto grid = grid_of_cells(cell);
    EXPECT_NEAR(grid.rings * grid.ring_width, 0.45, 1e-12);
    EXPECT_NEAR(grid.base_height() + grid.cone_rows * grid.cone_row_height, 0.30, 1e-12);
    EXPECT_NEAR(grid.air_rows * grid.air_row_height, 0.05, 1e-12);
    EXPECT_NEAR(grid.ring_width / cell, 1.0, 0.1);
    double volume = 0.0;
    for (int ring = 0; ring < grid.rings; ++ring)
      for (int row = 0; row < grid.rows(); ++row) volume += grid.cell_volume(ring, row);
    EXPECT_NEAR(volume, std::numbers::pi * 0.45 * 0.45 * 0.35, 1e-12);
  }
}

TEST(WedgeGauge, GivesVolumeDepthAndSpreadOfAKnownShape) {
  const auto grid = grid_of_cells(0.005);
  // A paraboloid 40 mm high that falls through 3 mm at 300 mm.
  const double edge = 0.3 * std::sqrt(0.040 / 0.037);
  const auto depth = [&](double r) { return std::max(0.0, 0.040 * (1.0 - r * r / (edge * edge))); };
  const auto gauges = gauge_slump(grid, filled_to(grid, depth), 2300.0, false);
  EXPECT_NEAR(gauges.volume, 0.5 * std::numbers::pi * edge * edge * 0.040, 1e-3 * gauges.volume);
  EXPECT_NEAR(runs::spread(gauges.profile(), 0.003), 0.600, 5e-4);
  EXPECT_NEAR(runs::centre_depth(gauges.profile(), 0.003), 0.040 * (1.0 + 0.3 / 16.0), 1e-4);
  for (std::size_t i = 0; i < gauges.radius.size(); ++i)
    ASSERT_NEAR(gauges.depth[i], depth(gauges.radius[i]), 1e-14) << "ring " << i;
  EXPECT_EQ(gauges.kinetic_energy, 0.0);
  EXPECT_EQ(gauges.shear_rate_p99, 0.0);
  EXPECT_NEAR(gauges.trapped_air, 0.0, 1e-15);
}

TEST(WedgeGauge, ACopyAHundredthAsLargeGivesTheSameNumbersScaled) {
  const auto small_scene = roussel_slump(
      "papanastasiou", {"geometry.cone_height=0.003", "geometry.cone_radius_top=0.0005",
                        "geometry.cone_radius_bottom=0.001", "geometry.domain_radius=0.0045",
                        "geometry.domain_height=0.0035", "foam.cell=0.0001", "mpm.cell=0.0001"});
  const auto large_scene = roussel_slump("papanastasiou", {"foam.cell=0.01"});
  const auto gauges_of = [](const scenes::Scene& scene, double size) {
    const auto grid = wedge_grid(scene);
    auto fields = filled_to(grid, [&](double r) { return std::max(0.0, 0.04 * size - 0.13 * r); });
    for (std::size_t cell = 0; cell < grid.cells(); ++cell)
      fields.velocity[3 * cell] = std::sqrt(size) * static_cast<double>(cell % 7);
    return gauge_slump(grid, fields, 2300.0, false);
  };
  const auto large = gauges_of(large_scene, 1.0), small = gauges_of(small_scene, 0.01);
  const auto same = [](double a, double b) { EXPECT_NEAR(a / b, 1.0, 1e-9); };
  for (const double times : {0.5, 1.0, 2.0})
    same(100.0 * runs::spread(small.profile(), times * small_scene.gauges.spread_depth),
         runs::spread(large.profile(), times * large_scene.gauges.spread_depth));
  same(100.0 * runs::centre_depth(small.profile(), small_scene.gauges.spread_depth),
       runs::centre_depth(large.profile(), large_scene.gauges.spread_depth));
  same(100.0 * small.front, large.front);
  same(1e6 * small.volume, large.volume);
  same(0.1 * small.shear_rate_p99, large.shear_rate_p99);
  same(0.1 * small.base_shear_rate_p99, large.base_shear_rate_p99);
}

/// Rest is the overstress K rate^n / ((1 + structure) tau0) of the place. With n it is that of a rate less by the
/// root of the structure, and not by the structure.
TEST(ConcreteRates, AreOverstressedByTheRootOfTheStructure) {
  for (const double n : {0.5, 1.0, 1.6}) {
    auto scene = roussel_slump("elasto-viscoplastic");
    scene.material.flow_index = n;
    const runs::Rest rest(scene);
    ConcreteRates rates(n);
    const std::vector<double> structure = {3.0, 0.2};
    rates.add(2.0, 1.0, structure, 0);
    EXPECT_EQ(rates.percentile(), 2.0);
    EXPECT_NEAR(rest.overstress(rates.overstressing_percentile()), rest.overstress(2.0, 3.0), 1e-13) << n;
    EXPECT_NEAR(rest.overstress(2.0, 3.0), std::pow(2.0, n) / 4.0, 1e-14);
  }
}

TEST(WedgeGauge, ReadsTheOverstressOfAPowerOfTheRate) {
  const auto grid = grid_of_cells(0.01);
  auto fields = filled_to(grid, [](double) { return 0.3; });
  fields.shear_rate.assign(grid.cells(), 2.0);
  fields.structure.assign(grid.cells(), 3.0);
  for (const double n : {0.5, 1.0, 1.6}) {
    fields.flow_index = n;
    const auto gauges = gauge_slump(grid, fields, 2300.0, false);
    EXPECT_EQ(gauges.shear_rate_p99, 2.0);
    EXPECT_NEAR(gauges.overstressing_rate_p99, 2.0 / std::pow(4.0, 1.0 / n), 1e-14) << n;
  }
}

TEST(WedgeGauge, WithoutConcreteItReadsNothingAndNotZero) {
  const auto grid = grid_of_cells(0.01);
  const auto gauges = gauge_slump(grid, still_air(grid), 2300.0, false);
  EXPECT_TRUE(std::isnan(gauges.front));
  EXPECT_TRUE(std::isnan(gauges.shear_rate_p99));
  EXPECT_TRUE(std::isnan(gauges.base_shear_rate_p99));
  EXPECT_TRUE(std::isnan(runs::spread(gauges.profile(), 0.003)));
}

TEST(WedgeGauge, CountsRowsOfUnequalHeight) {
  const auto grid = grid_of_cells(0.017);
  ASSERT_NE(grid.cone_row_height, grid.air_row_height);
  auto fields = still_air(grid);
  fields.fraction.assign(grid.cells(), 1.0);
  const auto gauges = gauge_slump(grid, fields, 2300.0, false);
  for (const double depth : gauges.depth) ASSERT_NEAR(depth, 0.35, 1e-14);
  EXPECT_NEAR(gauges.rim_depth, 0.35, 1e-14);
}

TEST(WedgeGauge, FindsAirUnderTheToe) {
  const auto grid = grid_of_cells(0.01);
  auto fields = filled_to(grid, [](double r) { return r < 0.2 ? 0.05 : 0.0; });
  const int ring = 10;
  fields.fraction[grid.index(ring, 0)] = 0.3;
  fields.fraction[grid.index(ring, 1)] = 0.9;
  EXPECT_NEAR(gauge_slump(grid, fields, 2300.0, false).trapped_air, 0.8 * grid.cell_volume(ring, 0), 1e-15);
}

TEST(WedgeGauge, AFlankThatLeansInwardsTrapsNoAir) {
  const auto grid = grid_of_cells(0.01);
  auto fields = still_air(grid);
  for (int row = 0; row < grid.cone_rows; ++row) fields.fraction[grid.index(7, row)] = 1.0 - 0.03 * row;
  EXPECT_EQ(gauge_slump(grid, fields, 2300.0, false).trapped_air, 0.0);
}

TEST(WedgeGauge, FindsTheFrontOfTheBaseRow) {
  const auto grid = grid_of_cells(0.01);
  auto fields = still_air(grid);
  for (int ring = 0; ring <= 20; ++ring) fields.fraction[grid.index(ring, 0)] = 1.0;
  fields.fraction[grid.index(20, 0)] = 0.75;
  fields.fraction[grid.index(21, 0)] = 0.25;
  EXPECT_NEAR(gauge_slump(grid, fields, 2300.0, false).front, 2.0 * 0.21, 1e-12);
}

TEST(WedgeGauge, KineticEnergyIsTheConcretesAlone) {
  const auto grid = grid_of_cells(0.01);
  auto fields = filled_to(grid, [](double r) { return r < 0.1 ? 0.1 : 0.0; });
  for (std::size_t cell = 0; cell < grid.cells(); ++cell) fields.velocity[3 * cell + 2] = -2.0;
  const double volume = std::numbers::pi * 0.1 * 0.1 * 0.1;
  EXPECT_NEAR(gauge_slump(grid, fields, 2300.0, false).kinetic_energy, 0.5 * 2300.0 * volume * 4.0, 1e-9);
}

TEST(ShearRate, IsExactForALinearFlow) {
  const auto grid = grid_of_cells(0.017);
  const double a = 0.7;
  const double s = 3.0;
  std::vector<double> velocity(3 * grid.cells());
  for (int row = 0; row < grid.rows(); ++row)
    for (int ring = 0; ring < grid.rings; ++ring) {
      const auto cell = 3 * grid.index(ring, row);
      velocity[cell] = a * grid.ring_centre(ring) + s * row_centre(grid, row);
      velocity[cell + 2] = -2.0 * a * row_centre(grid, row);
    }
  const auto rate = shear_rate(grid, velocity, false);
  const int ring = 7;
  for (int row = 1; row + 1 < grid.rows(); ++row) {
    // u / r is not a where the shear s z adds to it.
    const double hoop = a + s * row_centre(grid, row) / grid.ring_centre(ring);
    const double exact = std::sqrt(2.0 * (a * a + hoop * hoop + 4.0 * a * a) + s * s);
    ASSERT_NEAR(rate[grid.index(ring, row)], exact, 1e-9) << "row " << row;
  }
}

TEST(ShearRate, SeesTheWallOnlyWhereItHolds) {
  const auto grid = grid_of_cells(0.01);
  std::vector<double> velocity(3 * grid.cells(), 0.0);
  for (std::size_t cell = 0; cell < grid.cells(); ++cell) velocity[3 * cell] = 0.1;
  const auto hoop = 0.1 / grid.ring_centre(20);
  EXPECT_NEAR(shear_rate(grid, velocity, true)[grid.index(20, 0)], std::sqrt(2.0) * hoop, 1e-12);
  EXPECT_NEAR(shear_rate(grid, velocity, false)[grid.index(20, 0)], std::hypot(10.0, std::sqrt(2.0) * hoop),
              1e-9);
}

TEST(WedgeGauge, TheHighestHundredthOfTheVolumeIsLeftOutOfTheShearRate) {
  const auto grid = grid_of_cells(0.01);
  auto fields = filled_to(grid, [](double) { return 0.35; });
  // One ring in motion, the ones beside it sheared: next to the axis that is under 1 % of the volume.
  for (int row = 0; row < grid.rows(); ++row) fields.velocity[3 * grid.index(1, row)] = 1.0;
  EXPECT_EQ(gauge_slump(grid, fields, 2300.0, true).shear_rate_p99, 0.0);
  for (int row = 0; row < grid.rows(); ++row) fields.velocity[3 * grid.index(40, row)] = 1.0;
  EXPECT_GT(gauge_slump(grid, fields, 2300.0, true).shear_rate_p99, 40.0);
}

}  // namespace
}  // namespace flowrest::foam
