#include "runs/sheared_layer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "runs/held_walls.h"
#include "runs/resolution.h"
#include "runs/verdict.h"

namespace flowrest::runs {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A layer measured from samples of equal extent over [0, height] between plates.
ShearedLayer between_plates(double height, int samples, double cell,
                            const std::function<double(double)>& rate) {
  LayerMeter meter;
  const double extent = height / samples;
  for (int i = 0; i < samples; ++i) {
    const double y = (i + 0.5) * extent;
    meter.add({std::min(y, height - y), extent, cell, extent, rate(std::min(y, height - y))});
  }
  return meter.layer();
}

TEST(ShearedLayer, OfAPlugBetweenParabolasIsWhatTheClosedFormSays) {
  // 1000 Pa and 10 Pa s under 30 kN/m3 in 0.1 m: h/2 - tau0/F = 16.667 mm.
  const double layer = 0.05 - 1000.0 / 30000.0;
  const auto rate = [&](double y) { return std::max(0.0, 30000.0 * (layer - y) / 10.0); };
  const ShearedLayer fine = between_plates(0.1, 1000, 0.005, rate);
  EXPECT_NEAR(fine.thickness, layer, 0.005 * layer);
  EXPECT_NEAR(fine.cells, layer / 0.005, 0.02);
  // Mean over both layers and the plug between.
  EXPECT_NEAR(fine.mean_rate, 2.0 * 30000.0 * layer * layer / 2.0 / 10.0 / 0.1, 0.01 * fine.mean_rate);
  // A few samples tell it to a part of their extent.
  for (const int samples : {20, 40, 80})
    EXPECT_NEAR(between_plates(0.1, samples, 0.005, rate).thickness, layer, 0.2 * 0.1 / samples) << samples;
}

TEST(ShearedLayer, OfANewtonianParabolaIsHalfTheHeight) {
  EXPECT_NEAR(between_plates(0.1, 1000, 0.01, [](double y) { return 0.05 - y; }).thickness, 0.05, 3e-4);
}

TEST(ShearedLayer, HoldsTheShareOfTheDissipationThatItIsNamedFor) {
  // Sheared evenly up to d: 90 % lie within 0.9 d, and a linear layer has them within 1 - 0.1^(1/3) of its
  // own.
  const auto even = [](double y) { return y < 0.01 ? 3.0 : 0.0; };
  EXPECT_NEAR(between_plates(0.1, 2000, 0.01, even).thickness, 0.009 / (1.0 - std::cbrt(0.1)), 5e-5);
}

TEST(ShearedLayer, IsNotThickerForAPlugThatIsSlowlyPulledApart) {
  const double layer = 0.005, rate = 10.0;
  const auto slow_plug = [&](double y) { return std::max(rate * (1.0 - y / layer), 0.02 * rate); };
  EXPECT_NEAR(between_plates(0.08, 4000, 0.01, slow_plug).thickness, layer, 0.06 * layer);
}

TEST(ShearedLayer, IsCountedInTheCellsThatLieInIt) {
  // Four rows of 2.5 mm on the floor, rows of 10 mm over them, a layer of 20 mm: 4 + 1 cells.
  LayerMeter meter;
  double low = 0.0;
  for (const double row : {0.0025, 0.0025, 0.0025, 0.0025, 0.01, 0.01, 0.01})
    for (int part = 0; part < 10; ++part) {
      const double extent = row / 10, y = low + 0.5 * extent;
      meter.add({y, extent, row, extent, std::max(0.0, 0.02 - y)});
      low += extent;
    }
  EXPECT_NEAR(meter.layer().thickness, 0.02, 2e-4);
  EXPECT_NEAR(meter.layer().cells, 5.0, 0.05);
}

TEST(ShearedLayer, IsNoneWhereNothingShearsOrNoWallHolds) {
  EXPECT_EQ(between_plates(0.1, 10, 0.01, [](double) { return 0.0; }).thickness, 0.0);
  LayerMeter meter;
  meter.add({std::numeric_limits<double>::infinity(), 0.01, 0.01, 1.0, 5.0});
  EXPECT_EQ(meter.layer().thickness, 0.0);
  EXPECT_EQ(meter.layer().mean_rate, 0.0);
}

TEST(HeldWalls, AreAsFarAwayAsTheSceneHasThem) {
  const auto at = [](const char* name, const std::vector<std::string>& set, double x, double y, double z) {
    const auto scene = scenes::load_scene(name, {set, {}});
    return HeldWalls(scenes::pieces_of(scene), scene.spatial_dimension()).distance(x, y, z);
  };
  EXPECT_DOUBLE_EQ(at("roussel-slump", {}, 0.1, 0.0, 0.02), 0.02);
  EXPECT_DOUBLE_EQ(at("poiseuille-100", {}, 0.0, 0.0, 0.4), 0.1);
  EXPECT_EQ(at("poiseuille-100", {"walls.base=slip"}, 0.0, 0.0, 0.4),
            std::numeric_limits<double>::infinity());
  // An L-box, 100 mm of reservoir, a channel 600 mm long and 150 mm high under its front wall, half of 200
  // mm.
  const std::vector<std::string> half = {"geometry.dimension=half"};
  EXPECT_NEAR(at("mix-a-lbox-sf0", half, 0.4, 0.02, 0.03), 0.03, 1e-12);
  EXPECT_NEAR(at("mix-a-lbox-sf0", half, 0.4, 0.09, 0.03), 0.01, 1e-12);
  EXPECT_NEAR(at("mix-a-lbox-sf0", half, 0.69, 0.02, 0.05), 0.01, 1e-12);
  EXPECT_NEAR(at("mix-a-lbox-sf0", half, 0.07, 0.02, 0.4), 0.03, 1e-12);
  EXPECT_NEAR(at("mix-a-lbox-sf0", half, 0.12, 0.02, 0.14), 0.01, 1e-12);
  EXPECT_NEAR(at("mix-a-lbox-sf0", half, 0.106, 0.009, 0.05), 0.003, 1e-12);  // from the bar in the middle
  // A funnel's slope leans by atan(225 / 450); its neck is 65 mm wide; under its outlet nothing holds.
  const std::vector<std::string> quarter = {"geometry.dimension=quarter"};
  EXPECT_NEAR(at("mix-a-vfunnel-sf0", quarter, 0.02, 0.0, 0.1), 0.0125, 1e-12);
  EXPECT_NEAR(at("mix-a-vfunnel-sf0", quarter, 0.1, 0.03, 0.5), 0.0075, 1e-12);
  EXPECT_NEAR(at("mix-a-vfunnel-sf0", quarter, 0.2, 0.0, 0.5),
              (0.5 * (0.065 + 0.45 * 0.35 / 0.45) - 0.2) / std::hypot(1.0, 0.5), 1e-3);
  EXPECT_EQ(at("mix-a-vfunnel-sf0", quarter, 0.02, 0.0, -0.1), std::numeric_limits<double>::infinity());
}

/// A layer of so many mm and cells, and the mean shear rate.
ShearedLayer layer_of(const std::array<double, 3>& row) { return {1e-3 * row[0], row[1], row[2]}; }

Resolution of_moments(const std::vector<std::array<double, 3>>& rows) {
  Resolution resolution;
  for (std::size_t i = 0; i < rows.size(); ++i)
    resolution.add(0.1 * static_cast<double>(i + 1), layer_of(rows[i]));
  return resolution;
}

TEST(Resolution, IsJudgedWhereHalfOfTheStrainIsDoneWithFewerCells) {
  // Falls fast with a thick layer, creeps long with a thin one.
  const auto slump = of_moments({{60, 6, 10}, {58, 5.8, 10}, {20, 2, 1}, {10, 1, 0.1}, {5, 0.5, 0.1}});
  ASSERT_TRUE(slump.judged());
  EXPECT_EQ(slump.judged()->layer.cells, 5.8);
  EXPECT_NEAR(slump.judged()->time, 0.2, 1e-12);
  constexpr double open = std::numeric_limits<double>::infinity();
  EXPECT_EQ(slump.fault(open, 4.0), "");
  EXPECT_EQ(slump.fault(2.9, 4.0), "2.9 cells across the narrowest passage");
  EXPECT_THAT(slump.fault(open, 2.9), StartsWith("2.9 cells over the depth"));
  EXPECT_NEAR(slump.json()["sheared_layer_m"].get<double>(), 0.058, 1e-15);
  EXPECT_EQ(slump.json()["cells_at_end"].get<double>(), 0.5);
  EXPECT_EQ(slump.limit_of_rest(), "limited by the cell: the sheared layer of 5 mm is 0.5 cells thick");
  const auto creep = of_moments({{60, 6, 10}, {40, 4, 30}});
  EXPECT_EQ(creep.fault(open, std::nullopt),
            "4.0 cells over the sheared layer of 40 mm at 0.2 s, where 5 are wanted");
  EXPECT_EQ(creep.limit_of_rest(), "") << "its last layer has four cells";
  EXPECT_FALSE(of_moments({{0, 0, 0}, {0, 0, 0}}).judged());
  EXPECT_TRUE(Resolution().json().is_null());
}

TEST(Resolution, GoesOnFromTheRowsOfAHistory) {
  const std::vector<std::array<double, 3>> rows = {{60, 6, 10}, {58.1, 5.81, 9}, {20, 2, 30}};
  Table history{{"time_s", "sheared_layer_mm", "sheared_layer_cells", "shear_rate_mean_1_s"},
                {{0.1, 0.2}, {60, 58.1}, {6, 5.81}, {10, 9}},
                {}};
  Resolution resumed;
  resumed.continue_from(history);
  resumed.add(0.3, layer_of(rows[2]));
  EXPECT_NEAR(of_moments(rows).judged()->layer.cells, resumed.judged()->layer.cells, 0.0);
}

TEST(Verdict, SaysTheWorseFirstAndReadsBack) {
  EXPECT_EQ(with_resolution("sound", ""), "sound");
  EXPECT_EQ(with_resolution("noisy: it chatters", ""), "noisy: it chatters");
  const std::string few = "3.3 cells", coarse = with_resolution("sound", few),
                    both = with_resolution("noisy: it chatters", few);
  EXPECT_EQ(coarse, "under-resolved: 3.3 cells");
  EXPECT_EQ(both, "noisy: it chatters; under-resolved: 3.3 cells");
  EXPECT_EQ(with_resolution("unjudged: it is short", few),
            "under-resolved: 3.3 cells; unjudged: it is short");
  EXPECT_FALSE(doubt_of("sound").any());
  EXPECT_FALSE(doubt_of("unjudged: it is short").any());
  EXPECT_EQ(doubt_of("noisy: it chatters").word(), "noisy");
  EXPECT_EQ(doubt_of(coarse).word(), "under-resolved");
  EXPECT_EQ(doubt_of(coarse).why, few);
  EXPECT_EQ(doubt_of(both).word(), "noisy, under-resolved");
  EXPECT_EQ(doubt_of(both).why, "it chatters; under-resolved: 3.3 cells");
  // Runs of earlier versions.
  EXPECT_EQ(doubt_of("noisy: under-resolved, 1.0 cells across the narrowest passage").word(),
            "under-resolved");
}

}  // namespace
}  // namespace flowrest::runs
